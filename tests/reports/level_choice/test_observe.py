"""A run observed: flags, interrupts and bytes with their times; two levels compared."""

from __future__ import annotations

from fractions import Fraction
from math import inf
from pathlib import Path

import pytest

from periph_sim.core.records import Kind
from periph_sim.reports.level_choice.errors import CYCLES, Errors
from periph_sim.reports.level_choice.moments import KINDS, Label
from periph_sim.reports.level_choice.observe import DIFFER, Observed, compare, observe
from periph_sim.scene.case.load import load

TIMING = Path(__file__).resolve().parents[3] / "timing"
LENGTH = Fraction(3, 100)


def observed(case: str, *changes: str) -> Observed:
    return observe(load(TIMING / f"{case}.toml", list(changes)), LENGTH)


def errors(case: str, *changes: str) -> dict[str, Errors]:
    return {each.name: each for each in compare(observed(case), observed(case, *changes))}


def test_edges_are_not_recorded():
    assert not {Kind.EDGE, Kind.HOLD} & set(KINDS)


def test_flags_interrupts_bytes_and_values_are_observed():
    found = observed("imu_hil")
    assert found.cycle == 20
    assert len(found.moments[Label("controller bus", "START")]) == 6
    assert len(found.moments[Label("dsp irq", "SCIRXINTA entered")]) == 2
    assert len(found.moments[Label("dsp.I2C-A flag", "I2CSTR.AAS", 1)]) == 6 * 2
    assert len(found.data["controller bytes"]) == 2 * 27
    assert {"response", "stretch", "round", "age", "margin of I2CDXR", "missed rounds"} <= set(found.values)


def test_a_level_that_is_adaptive_is_exact_while_it_is_observed():
    found = compare(observed("imu_hil"), observed("imu_hil", "fidelity=adaptive"))
    assert sum(each.exact for each in found) > 50 and all(each.exact for each in found if each.measured)


def test_a_longer_pass_of_a_poll_is_seen_in_cycles():
    found = errors("responder", "unit.dsp.code.poll_pass=110")
    assert 50 < found["dsp.I2C-A.I2CSTR.XRDY clear"].worst <= 110 + 20
    assert found["controller bytes"].exact


def test_bytes_that_differ_are_counted_and_no_time():
    found = errors("responder", 'unit.dsp.settings.replies=["01 02 ff"]')
    assert found["controller bytes"].unit == DIFFER and found["controller bytes"].worst == 1
    assert found["controller byte"].exact and found["controller byte"].unit == CYCLES


def test_a_device_that_does_not_answer_lacks_what_it_would_have_done():
    found = errors("responder", "unit.dsp.settings.address=0x51")
    missing, added = found["dsp.I2C-A.I2CSTR.AAS set"], found["controller NACK"]
    assert (missing.count, missing.worst) == (6 * 2, inf) and (added.count, added.worst) == (6, inf)
    assert not found["nacked"].exact


@pytest.mark.parametrize("case", ["uart_logger", "two_dsps", "imu_chips"])
def test_scenes_without_host_controller_or_bus_are_observed(case: str):
    found = compare(observed(case), observed(case))
    assert sum(each.exact for each in found) > 5 and all(each.exact for each in found if each.measured)


def test_a_measure_without_an_occasion_is_unmeasured_and_a_count_of_zero_is_a_value():
    found = observe(load(TIMING / "responder.toml"), Fraction(1, 2000))  # the first round is due at 5 ms
    none = {name for name, (_, values) in found.values.items() if not len(values)}
    assert {"wrong bytes", "missed rounds", "nacked rounds", "response", "stretch", "round"} <= none
    assert found.values["nacked"][1].tolist() == [0]
    assert all(len(values) for _, values in observed("imu_hil").values.values())
