"""Sources as Cython compiles them: what is Cython's is in place, and lines keep their numbers."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from periph_sim.form.source_copy import prepared
from periph_sim.form.sources import Sources
from tests.form.package import classes

REGISTERS = """\
# core: compiled
SIZE = 16

class Cpu:
    ovc: int

def half(cpu: Cpu) -> int:
    return 8

def whole(cpu: Cpu) -> int:
    return 16
"""
HEAD = '''"""A module."""
# core: compiled
from __future__ import annotations

'''


def copied(tmp_path: Path, source: str) -> str:
    (tmp_path / "registers.py").write_text(REGISTERS)
    (tmp_path / "one.py").write_text(HEAD + source)
    text = prepared(Sources(tmp_path)["one"])
    assert text.count("\n") == (HEAD + source).count("\n")
    return text.removeprefix(HEAD)


def test_a_free_list_is_above_its_class_where_cython_obeys_it(tmp_path: Path):
    text = copied(tmp_path, "ONE = 1\n\n\nclass Kept:  # core: freelist 4\n    pass\n")
    assert text.startswith('"""A module."""\n# core: compiled\nfrom __future__ import annotations; import cython\n')
    assert text.endswith("ONE = 1\n@cython.freelist(4)\n@cython.cclass\nclass Kept:  # core: freelist 4\n    pass\n")
    text = copied(tmp_path, "ONE = 1\n\n\n@final\nclass Kept:  # core: freelist 4\n    pass\n")
    assert text.endswith("ONE = 1\n\n@cython.freelist(4)\n@cython.cclass\nclass Kept:  # core: freelist 4\n    pass\n")


def test_every_free_list_of_the_package_reaches_its_class():
    kept = [kind for kind in classes() if kind.marks]
    assert len(kept) > 1
    for kind in kept:
        assert re.search(rf"\n@cython\.freelist\(\d+\)\n@cython\.cclass\nclass {kind.name}\b", prepared(kind.source))


def test_decorators_and_types_without_values_are_left_out(tmp_path: Path):
    source = """\
@final
class One:
    count: int
    def f(self) -> None:
        for one in self:
            place: int
            place = 1
class Plain(NamedTuple):
    count: int
"""
    expected = source.replace("@final", "").replace("count: int", "pass", 1).replace("place: int", "pass")
    assert copied(tmp_path, source) == expected


def test_bare_returns_of_functions_without_a_result_have_one(tmp_path: Path):
    source = """\
class Box:
    def act(self, tag: int) -> None:
        if tag:
            return  # nothing to do
    def weigh(self) -> int | None:
        return
    def stay(self) -> None:  # core: python
        return
    def _hold(self) -> None:
        def wait() -> None:
            return
"""
    assert copied(tmp_path, source) == source.replace("return  # nothing", "return False  # nothing")


def test_c_functions_are_not_imported(tmp_path: Path):
    source = """\
from .registers import (
    SIZE,
    Cpu,
    half,
)
from .registers import whole
def helper(cpu: Cpu) -> int:
    return half(cpu) + whole(cpu) + SIZE
"""
    lines = copied(tmp_path, source).splitlines()
    assert lines[:7] == ["from .registers import SIZE, Cpu", "", "", "", "", "", "def helper(cpu: Cpu) -> int:"]


def test_a_c_function_that_is_used_as_a_value_is_imported(tmp_path: Path):
    source = "from .registers import half\ndef f(cpu: object) -> int:\n    return half(cpu)\nx = sorted([], key=half)\n"
    assert copied(tmp_path, source) == source


def test_a_look_up_by_name_is_spelled_out(tmp_path: Path):
    source = """\
__all__ = ("NOP", "bind")
def NOP(cpu: object) -> None:
    pass
def ADD(cpu: object) -> None:
    pass
def SUB(cpu: object) -> None:
    pass
def helper(cpu: object) -> None:
    pass
def bind(cpu: object, name: str) -> None:
    cpu.does = globals()[name]
"""
    (tmp_path / "one.py").write_text(HEAD + source)
    text = prepared(Sources(tmp_path)["one"])
    names: dict[str, object] = {}
    exec(text, names)

    class Box:
        does: object = 0

    box, bind = Box(), names["bind"]
    assert callable(bind)
    bind(box, "SUB")
    assert box.does is names["SUB"]
    for none in ("helper", "NOP"):
        with pytest.raises(KeyError, match=none):
            bind(box, none)
    assert "globals" not in text


def test_what_the_declarations_define_is_not_defined_again(tmp_path: Path):
    source = 'I = TypeVar("I", int, "Ints")\nRun = CFunction[[int], None]\nx = 1\n'
    assert copied(tmp_path, source) == "\n\nx = 1\n"


def test_a_source_without_any_of_this_stays(tmp_path: Path):
    source = "def f(x: int) -> int:\n    y: int = x\n    return y\n"
    assert copied(tmp_path, source) == source
