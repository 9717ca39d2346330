import pytest

import periph_sim
from periph_sim.traces.compliance import check
from periph_sim.traces.formats.psr import read_table


def test_the_bus_keeps_the_specification(scene):
    run = scene("bench/thermometer.toml")
    check(run.edges()).assert_compliant()
    assert len(run.transfers) == 10


@pytest.mark.case("bench/tilt.toml", seconds=0.01)
def test_the_board_answers_in_time(case_run):
    case_run.assert_budgets("work", "reply")


def test_a_recording_of_an_earlier_run_can_be_read():
    table = read_table("thermometer.psr")
    assert len(table.tick) > 100 and periph_sim.why("thermometer.psr", "I2C-A.I2CSTR.XRDY@1.5ms").value is not None
