"""Looks into windows made by hand."""

from __future__ import annotations

from dataclasses import replace

from periph_sim.core.records import Kind, Record
from periph_sim.explain.device_evidence import answering
from periph_sim.explain.evidence import Evidence, RecordedPhase
from tests.explain.made import drawn
from tests.scene.small import case

UNIT = {"firmware": "given", "modules": ["I2C-A"]}
BOTH = case(unit={"head": UNIT, "dsp": UNIT})


def test_it_is_about_the_first_unit_whose_firmware_did_something_else_about_the_first():
    assert Evidence(drawn("wait AAS 0 100"), BOTH).unit == "dsp"
    assert Evidence(drawn(), BOTH).unit == "head"
    assert Evidence(drawn("wait AAS 0 100"), BOTH, "head").unit == "head"
    assert Evidence(drawn(), case()).unit == ""


def test_a_read_is_told_of_the_unit_that_has_its_address_unless_a_device_has():
    wrote = Record(9, 5, Kind.ACCESS, "dsp", "W I2C-A.I2COAR", 0x50, "f:1", 0)
    window = drawn("wait AAS 0 100")
    window = replace(window, records=(*window.records, wrote))
    read = RecordedPhase("", 10, 90, 0x50, True, True, 20, "START", ())
    assert answering(Evidence(window, BOTH, "head"), read).unit == "dsp"
    memory = BOTH.model_copy(update={"device": case(device={"memory": {"model": "24lc64"}}, rounds=None).device})
    assert answering(Evidence(window, memory, "head"), read).unit == "head"
