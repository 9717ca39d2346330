"""Attributes that refuse None: which they are goes in as sources; setters in C, and those of the compiled core."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim import form
from periph_sim.core.agent import Agent
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.wire import Wire
from periph_sim.form.setters import never_none, with_none_refused
from periph_sim.form.sources import Source, Sources

SOURCE = """
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


def test_attributes_that_the_source_sets_to_none_may_be_none(tmp_path: Path):
    assert never_none(Source(Sources(tmp_path), "room", SOURCE)) == [("Party", "wire"), ("Party", "_spare")]


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


@pytest.mark.skipif(form.running == form.INTERPRETED, reason="setters are of the compiled core")
@pytest.mark.parametrize("name", ["kernel", "recorder"])
def test_a_wire_of_the_compiled_core_keeps_its_kernel(name: str):
    wire = Wire(Kernel(), "SDA", Recorder())
    before = getattr(wire, name)
    with pytest.raises(TypeError, match=f"Wire.{name} cannot be None"):
        setattr(wire, name, None)
    with pytest.raises(TypeError, match=f"Wire.{name} cannot be None"):
        delattr(wire, name)
    assert getattr(wire, name) is before
    wire.cause = 0


@pytest.mark.skipif(form.running == form.INTERPRETED, reason="setters are of the compiled core")
def test_an_event_of_the_compiled_core_keeps_its_agent():
    event = Kernel().event(Agent())
    with pytest.raises(TypeError, match=r"Event.agent cannot be None"):
        event.agent = None  # type: ignore[assignment]
