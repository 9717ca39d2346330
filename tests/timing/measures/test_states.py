"""Times in a state, on hand-made records, compared with a count of ticks, and in a run."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.records import Kind, Record
from periph_sim.core.time import NO_TIME
from periph_sim.timing.language.scope import BadEvent
from periph_sim.timing.measures.factory import measure_named
from periph_sim.timing.measures.measure import Measure
from tests.scene.runs import run_file
from tests.scene.small import sentence_of
from tests.timing.events_by_hand import BARE, NO_BUS, played, summary

SCL = "10 edge SCL level 0\n16 edge SCL level 1\n20 edge SCL level 0\n23 edge SCL level 1\n40 edge SCL level 0"


def measured(text: str, of: str | list[Record], now: int = 50, **there: object) -> Measure:
    """The measure of a text after these records, in a run from tick 4 to `now`."""
    return played(text, of, now, began=4, **there)


def test_a_wire():
    assert summary(measured("each time in wire SCL low", SCL)) == (6, 10, 3, 2)
    assert summary(measured("each time in wire SCL high", SCL)) == (17, 23, 4, 2)
    assert summary(measured("time in wire SCL low", SCL)) == (6 + 3 + 10, 10, 19, 3)
    assert summary(measured("time in wire SCL high", SCL)) == (6 + 4 + 17, 4, 27, 3)  # high from the begin of the run


def test_an_unfinished_time_counts_if_it_is_the_longest():
    low = measured("each time in wire SCL low", SCL)
    assert (low.close(50), summary(low)) == ("'wire SCL low' still lasted when the run ended", (10, 40, 3, 3))
    low = measured("each time in wire SCL low", SCL)
    assert (low.close(45), summary(low)) == ("", (6, 10, 3, 2))
    high = measured("each time in wire SCL high", SCL)
    assert (high.close(99), summary(high)) == ("", (17, 23, 4, 2))
    always = measured("each time in wire SCL high", "")
    assert always.close(50) and summary(always) == (46, 4, 46, 1)


FIFO = "10 flag dsp.SCI-A SCIFFRX.RXFFST 1\n20 flag dsp.SCI-A SCIFFRX.RXFFST 2\n23 flag dsp.SCI-A SCIFFRX.RXFFST 1"


def test_a_field_of_several_bits_is_in_the_state_while_it_has_the_value():
    assert summary(measured("each time in flag SCI-A.SCIFFRX.RXFFST = 1", FIFO)) == (10, 10, 10, 1)
    assert summary(measured("time in flag SCI-A.SCIFFRX.RXFFST = 1", FIFO)) == (10 + 27, 10, 37, 2)
    assert summary(measured("time in flag SCI-A.SCIFFRX.RXFFST = 0", FIFO)) == (6, 4, 6, 1)


BUS = (
    "10 bus controller START 0\n15 bus controller repeated_START 0\n30 bus controller STOP 0\n41 bus controller START 0"
)


def test_the_bus_is_busy_from_start_to_stop():
    assert summary(measured("each time in bus busy", BUS)) == (20, 10, 20, 1)
    assert summary(measured("time in bus busy", BUS)) == (29, 10, 29, 2)
    assert summary(measured("each time in bus free", BUS)) == (11, 30, 11, 1)
    assert summary(measured("time in bus free", BUS)) == (6 + 11, 4, 17, 2)


def test_a_service_routine():
    of = "10 irq dsp SCIRXINTA 1\n30 irq dsp SCIRXINTA 0\n31 irq dsp XINT1 1\n35 irq dsp XINT1 0"
    assert summary(measured("each time in interrupt SCIRXINTA", of)) == (20, 10, 20, 1)


def test_a_sum_of_zero_is_a_value_only_if_the_name_was_checked():
    never = measured("time in flag I2C-A.I2CSTR.RSFULL = 1", "")
    assert (summary(never), never.silent) == ((0, NO_TIME, 0, 0), False)
    each = measured("each time in flag I2C-A.I2CSTR.RSFULL = 1", "")
    assert each.silent and each.missing() == "'flag I2C-A.I2CSTR.RSFULL = 1' was never entered and left"
    assert measured("time in modle", "").silent
    assert measured("each time in modle", "1 span dsp model 1").missing().endswith("did you mean model?")


@given(st.lists(st.tuples(st.integers(1, 5), st.integers(0, 3)), max_size=30), st.integers(0, 3), st.integers(0, 3))
def test_a_sum_agrees_with_a_count_of_ticks(drawn: list[tuple[int, int]], first: int, wanted: int):
    tick, of = 4, []
    for step, value in drawn:
        tick += step
        of.append(Record(len(of) + 1, tick, Kind.FLAG, "dsp.SCI-A", "SCIFFRX.RXFFST", value, "", 0))
    measure = measured(f"time in flag SCI-A.SCIFFRX.RXFFST = {wanted}", of, tick + 7, value=first)
    value_at = {record.tick: record.value for record in of}
    value, count = first, 0
    for now in range(4, tick + 7):
        value = value_at.get(now, value)
        count += value == wanted
    assert measure.worst == count


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("time in wire SLC low", "there is no wire 'SLC'; did you mean SCL"),
        ("time in flag I2C-A.I2CSTR.AAZ = 1", "I2CSTR has no field 'AAZ'; did you mean AAS"),
        ("time in flag I2C-A.I2CSTR.AAS = 2", "AAS has 1 bits and so is never 0x2"),
    ],
)
def test_an_impossible_state_is_rejected(text: str, sentence: str):
    assert sentence in sentence_of(BadEvent, lambda: measure_named(text, BARE))


def test_states_of_a_bus_are_rejected_without_a_bus():
    with pytest.raises(BadEvent, match="'bus START' needs SCL and SDA in the scene, which has none"):
        measure_named("each time in bus busy", NO_BUS)
    assert summary(measured("time in bus busy", BUS, scope=BARE)) == (29, 10, 29, 2)


def test_times_in_a_state_and_in_its_opposite_add_up_to_the_run():
    texts = ["time in wire SCL high", "time in wire SCL low", "time in bus busy", "time in bus free"]
    texts += ["each time in wire MODEL high", "each time in flag I2C-A.I2CSTR.AAS = 1"]
    budgets = ", ".join(f"{{name = '{text}', measure = '{text}', max = '1 s'}}" for text in texts)
    ran = run_file("imu_hil_published", "0.03", f"budget = [{budgets}]")
    found = {verdict.name: verdict for verdict in ran.result.budgets}
    assert not ran.broken()
    assert found[texts[0]].worst + found[texts[1]].worst == pytest.approx(30_000)
    assert found[texts[2]].worst + found[texts[3]].worst == pytest.approx(30_000)
    assert found[texts[4]].count == 3 and found[texts[4]].worst == pytest.approx(250.0067, abs=1e-3)
    assert "dsp.i2c.clock_gate_access" not in ran.result.unknowns  # measuring does not depend on it
    assert found[texts[5]].count == 12  # two rounds of three chips, each addressed to write and to read
