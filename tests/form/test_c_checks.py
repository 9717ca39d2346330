"""Checks added to the C code: an index outside of its array ends the process, and setters refuse None."""

# core: compiled

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from shutil import which

import pytest

from periph_sim import form
from periph_sim.core.agent import Agent
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.wire import Wire
from periph_sim.form import build
from periph_sim.form.c_checks import CHECK, arrays_of, never_none, with_index_checks, with_none_refused
from periph_sim.form.sources import Source, Sources
from tests.form.package import every_declaration, written

PXD = """
cdef class Ring:
    cdef public long long[8] low
    cdef public long long[8] high
    cdef unsigned char[4] seen
    cdef long long _at
"""


def test_arrays_are_read_from_a_pxd_file():
    assert arrays_of([PXD]) == {"low": 8, "high": 8, "seen": 4}


def test_arrays_of_one_name_and_two_lengths_are_refused():
    with pytest.raises(ValueError, match="two arrays are called 'seen', of different lengths; rename one of them"):
        arrays_of([PXD, "    cdef unsigned char[5] seen\n"])


def test_every_array_declaration_of_the_package_is_read():
    lines = [
        line
        for text in every_declaration()
        for line in text.split("\n")
        if line.startswith("    cdef ") and "]" in line and "(" not in line and "::" not in line
    ]
    assert len(lines) == sum(bool(arrays_of([line])) for line in lines) > 10


def test_all_indices_but_literal_numbers_are_checked():
    text = "/* Module declarations from */\na->low[3] = p->seen[p->_at] + q->low[(r->seen[i] & 7)];\n"
    made = with_index_checks(text, arrays_of([PXD])).replace(CHECK, "")
    assert made.split("\n")[1] == (
        'a->low[3] = p->seen[PERIPH_SIM_INDEX(p->_at, 4, "seen")]'
        ' + q->low[PERIPH_SIM_INDEX((r->seen[PERIPH_SIM_INDEX(i, 4, "seen")] & 7), 8, "low")];'
    )


SOURCE = """
# core: compiled
class Ring:
    low: "Annotated[list[int], 8]"
    def __init__(self):
        self.low = [0] * 8
    def put(self, at: int, value: int) -> None:
        self.low[at] = value
    def get(self, at: int) -> int:
        return self.low[at]
"""
CALL = """
import sys
from periph_sim import form
from pathlib import Path
built = Path("built")
sys.path_hooks.insert(0, form.finders(Path("arrayed").resolve(), built, ["ring"]))
sys.path_importer_cache.clear()
sys.path.insert(0, "")
from arrayed.ring import Ring
ring = Ring()
ring.put(7, 42)
print(ring.get(7), flush=True)
ring.put(int(sys.argv[1]), 1)
"""


@pytest.mark.skipif(find_spec("Cython") is None or which("cc") is None, reason="Cython or a C compiler is missing")
def test_an_index_outside_of_its_array_ends_the_process_with_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    package = written(tmp_path, "arrayed", ring=SOURCE)
    monkeypatch.syspath_prepend(tmp_path)
    build.build(package, tmp_path / "built", 1)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(form.PACKAGE.parent), *sys.path])}
    for index in ("8", "-1"):
        done = subprocess.run(
            [sys.executable, "-c", CALL, index],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode < 0 and done.stdout == "42\n"
        assert f"index {index} is outside of the C array low[8] of the compiled core" in done.stderr


PARTY = """
# core: compiled
class Wire:
    pass

class Party:
    found: Party | None
    notes: list
    level: int

    def __init__(self, wire: Wire, last: Party | None) -> None:
        self.wire = wire
        self._spare = wire
        self.following: Party | None = None
        self.level, self.notes = 0, []
        self.last = last
"""
SETTER = "static int __pyx_setprop_4room_5Party_{}(PyObject *o, PyObject *v, CYTHON_UNUSED void *x) {{\n  if (v) {{\n"


def test_only_attributes_whose_type_includes_none_may_be_none(tmp_path: Path):
    assert never_none(Source(Sources(tmp_path), "room", PARTY)) == [("Party", "wire"), ("Party", "_spare")]


def test_a_setter_refuses_none_and_removal_before_anything_else():
    before = SETTER.format("wire") + SETTER.format("following")
    after = with_none_refused(before, [("Party", "wire")])
    refused, rest = after.split("  if (v) {\n", 1)
    assert "if (unlikely(!v || v == Py_None)) {" in refused and "Party.wire cannot be None" in refused
    assert rest == SETTER.format("following")


@pytest.mark.parametrize("c_text", ["", SETTER.format("wire") * 2, SETTER.format("wires")])
def test_an_attribute_without_one_setter_fails_the_build(c_text: str):
    with pytest.raises(ValueError, match=r"Party\.wire has \d setters in C; expected one"):
        with_none_refused(c_text, [("Party", "wire")])


@pytest.mark.skipif(form.running == form.INTERPRETED, reason="only the compiled core has setters")
@pytest.mark.parametrize("name", ["kernel", "recorder"])
def test_a_compiled_wire_keeps_its_kernel_and_recorder(name: str):
    wire = Wire(Kernel(), "SDA", Recorder())
    before = getattr(wire, name)
    with pytest.raises(TypeError, match=f"Wire.{name} cannot be None"):
        setattr(wire, name, None)
    with pytest.raises(TypeError, match=f"Wire.{name} cannot be None"):
        delattr(wire, name)
    assert getattr(wire, name) is before
    wire.cause = 0


@pytest.mark.skipif(form.running == form.INTERPRETED, reason="only the compiled core has setters")
def test_a_compiled_event_keeps_its_agent():
    event = Kernel().event(Agent())
    with pytest.raises(TypeError, match=r"Event.agent cannot be None"):
        event.agent = None  # type: ignore[assignment]
