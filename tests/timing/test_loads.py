"""Loads of the run and of its busiest window, compared with a count of ticks."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.records import Kind, Record
from periph_sim.timing.measures.measure import MILLIONTHS, Measure
from tests.scene.runs import run_file
from tests.timing.events_by_hand import played, summary


def load(text: str, of: str | list[Record], now: int) -> Measure:
    """The measure after these records, in a run from tick 1000 to `now` with 1000 ticks per second."""
    return played(text, of, now, began=1000, ticks_per_second=1000)


STARTS = "1000 bus c START 0\n1050 bus c repeated_START 0\n1100 bus c STOP 0\n1400 bus c START 0"


def test_the_bus_is_busy_from_start_to_stop():
    assert summary(load("bus load", STARTS, 1500)) == (400_000, 1500, 400_000, 1)


def test_the_busiest_window_can_begin_at_any_tick():
    assert summary(load("bus load per 200 ms", STARTS, 1500)) == (500_000, 1000, 500_000, 1)
    assert summary(load("bus load per 100 ms", STARTS, 1500)) == (MILLIONTHS, 1000, MILLIONTHS, 1)
    assert summary(load("bus load per 400 ms", STARTS, 1500)) == (500_000 / 2, 1000, 250_000, 1)


def test_a_share_of_a_span_that_never_occurred_is_not_judged():
    text = "share of any 200 ms in model"
    assert summary(load(text, "1000 span dsp model 1\n1100 span dsp model 0", 1500)) == (500_000, 1000, 500_000, 1)
    for other in (text, "share of time in model"):
        never = load(other, "1000 span dsp modle 1", 1500)
        assert never.silent and never.missing() == "no event matched 'span model begin'; did you mean modle?"


def test_a_window_longer_than_the_run_is_not_judged():
    short = load("bus load per 600 ms", STARTS, 1500)
    assert short.silent and short.missing() == "the run is shorter than its window"


CPU = """
    1010 wait dsp I2CSTR.AAS 1
    1050 irq  dsp SCIRXINTA  1
    1060 wait dsp SCIFFRX    1
    1070 wait dsp SCIFFRX    0
    1080 irq  dsp SCIRXINTA  0
    1090 wait dsp I2CSTR.AAS 0
    1100 wait other I2CSTR   1
"""


def test_a_cpu_is_busy_unless_the_running_routine_waits():
    """The CPU is busy until 1010, in the service routine except during its own wait, and from 1090."""
    measure = load("cpu load of dsp", CPU, 1200)
    assert summary(measure) == ((10 + 10 + 10 + 110) * MILLIONTHS // 200, 1200, 700_000, 1)
    assert summary(load("share of time in cpu idle", CPU, 1200)) == (300_000, 1200, 300_000, 1)
    assert summary(load("time in cpu idle of dsp", CPU, 1200)) == (60, 1010, 60, 3)
    assert summary(load("each time in cpu busy", CPU, 1200)) == (10, 1050, 10, 2)


@given(st.lists(st.integers(1, 9), max_size=20), st.integers(1, 30), st.integers(0, 9))
def test_the_busiest_window_agrees_with_a_count_of_ticks(lengths: list[int], window: int, tail: int):
    now, of, busy = 1000, [], []
    for number, length in enumerate(lengths):
        what = "STOP" if number % 2 else "START"
        of.append(Record(number + 1, now, Kind.BUS, "c", what, 0, "", 0))
        busy += [not number % 2] * length
        now += length
    busy += [len(lengths) % 2 == 1] * tail
    now += tail
    measure = load(f"bus load per {window} ms", of, now)
    sums = [sum(busy[i : i + window]) for i in range(len(busy) - window + 1)]
    assert measure.silent == (not sums)
    if sums:
        assert measure.worst == (2 * max(sums) * MILLIONTHS + window) // (2 * window)
        assert sum(busy[measure.worst_at - 1000 :][:window]) == max(sums)


@pytest.mark.parametrize(("text", "least", "most"), [("cpu load", 1.25, 1.5), ("cpu load per 1 ms", 25, 40)])
def test_the_cpu_load_of_the_emulator(text: str, least: float, most: float):
    """The load is a model of 250 us every 20 ms, and the service of reads."""
    ran = run_file("imu_hil_published", "0.2", f'budget=[{{name="b", measure="{text}", max="99 %"}}]')
    (verdict,) = ran.result.budgets
    assert least < verdict.worst < most
