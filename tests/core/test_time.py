"""Times are converted exactly or refused; a clock whose period is no whole number of ticks does not drift."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.chip import NEVER
from periph_sim.core.time import LAST_TICK, Clock, Timebase, TimeError, round_ratio, seconds

THIRTY_DAYS = 30 * 86_400


def test_at_150_mhz_a_tick_is_a_third_of_a_nanosecond():
    timebase = Timebase(150_000_000)
    assert timebase.per_second == 3_000_000_000
    assert timebase.ticks("1 ns") == 3
    assert Clock(timebase, 150_000_000).tick(1) == 20


@pytest.mark.parametrize("mhz", [30, 60, 75, 100, 120, 150])
def test_the_period_of_each_usual_clock_is_a_whole_number_of_ticks(mhz):
    timebase = Timebase(mhz * 1_000_000)
    clock = Clock(timebase, mhz * 1_000_000)
    assert clock.tick(mhz * 1_000_000) == timebase.per_second


def test_a_time_off_the_grid_is_refused_unless_a_rounding_is_named():
    timebase = Timebase(150_000_000)
    with pytest.raises(TimeError, match="choose a rounding"):
        timebase.ticks(Fraction(1, 7))
    assert [timebase.ticks(Fraction(1, 7), r) for r in ("down", "nearest", "up")] == [428571428, 428571429, 428571429]


def test_rounding_of_negative_ratios():
    half = Fraction(-7, 2)
    assert [round_ratio(half, r) for r in ("down", "nearest", "up")] == [-4, -3, -3]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("250 us", Fraction(1, 4000)),
        ("1.5 ms", Fraction(3, 2000)),
        ("30 d", Fraction(THIRTY_DAYS)),
        ("20ns", Fraction(1, 50_000_000)),
    ],
)
def test_texts_are_converted_exactly(text, value):
    assert seconds(text) == value


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("20", "has no unit; write for instance 20 ms"),
        ("20 parsec", "unit 'parsec' is none of ns, us"),
        ("x ms", "'x' is not a number"),
        ("1/0 ms", "is not a number"),
    ],
)
def test_the_error_of_a_bad_text_says_what_is_wrong(text, message):
    with pytest.raises(TimeError, match=message):
        seconds(text)


@given(ppm=st.integers(-500, 500), cycle=st.integers(0, 150_000_000 * THIRTY_DAYS))
def test_a_clock_with_a_fractional_period_is_less_than_a_tick_off_after_thirty_days(ppm, cycle):
    timebase = Timebase(150_000_000)
    hz = Fraction(150_000_000) * (1_000_000 + ppm) / 1_000_000
    clock = Clock(timebase, hz)
    exact = cycle * timebase.per_second / hz
    assert 0 <= exact - clock.tick(cycle) < 1
    assert clock.cycle_at(clock.tick(cycle)) == cycle


@given(hz=st.fractions(Fraction(1000), Fraction(10**9)), tick=st.integers(0, 10**16))
def test_cycle_at_is_the_first_cycle_that_begins_at_or_after_a_tick(hz, tick):
    clock = Clock(Timebase(), hz)
    cycle = clock.cycle_at(tick)
    assert clock.tick(cycle) >= tick > clock.tick(cycle - 1)
    assert clock.tick(clock.cycle_after(tick)) > tick


def test_retuning_keeps_the_start_of_the_present_cycle():
    timebase = Timebase(150_000_000)
    clock = Clock(timebase, 15_000_000)
    clock.retune(100, 150_000_000)
    assert (
        clock.tick(99) == clock.tick(100) - 20
    )  # cycles before the change are converted with the new length, too; the product never asks for them
    assert clock.tick(100) == 100 * 200
    assert clock.tick(101) == 100 * 200 + 20
    with pytest.raises(TimeError, match="a clock cannot have"):
        clock.retune(200, 0)


def test_times_are_shown_in_a_fitting_unit():
    timebase = Timebase(150_000_000)
    assert [timebase.show(timebase.ticks(t)) for t in ("250 us", "20 ms", "30 d")] == [
        "250.000 us",
        "20.000 ms",
        "2592000.000000 s",
    ]


def test_a_run_that_ends_with_the_last_tick_is_the_longest():
    base = Timebase(150_000_000)
    longest = base.seconds(LAST_TICK)
    assert base.end_of_run(0, longest) == LAST_TICK == NEVER - 1
    with pytest.raises(TimeError) as refused:
        base.end_of_run(0, longest + Fraction(1, 3_000_000_000))
    assert str(refused.value).endswith("with ticks of 1/3000000000 s the longest is 17791.9 d")
    base.end_of_run(10, longest - base.seconds(10))
    with pytest.raises(TimeError):
        base.end_of_run(11, longest - base.seconds(10))


def test_the_error_of_a_run_too_long_for_its_ticks_suggests_a_round_crystal_frequency():
    base = Timebase(149_999_999)
    with pytest.raises(TimeError, match=r"a run of 60 s ends .* is 30\.7 s; a crystal of a round frequency, its"):
        base.end_of_run(0, Fraction(60))
    assert base.end_of_run(0, Fraction(30)) == 30 * base.per_second


@given(st.integers(-200_000, 200_000), st.integers(1, 10**14), st.integers(1, 10**6))
def test_edges_of_a_clock_with_ppm_are_counted_exactly_however_late(ppm, cycle, span):
    hertz = 150_000_000 * (1 + Fraction(ppm, 1_000_000))
    clock = Clock(Timebase(150_000_000), hertz)
    period = Fraction(3_000_000_000) / hertz
    assert 0 <= cycle * period - clock.tick(cycle) < 1
    assert clock.cycle_at(clock.tick(cycle)) == cycle
    assert clock.cycle_at(clock.tick(cycle + span)) - clock.cycle_at(clock.tick(cycle)) == span
