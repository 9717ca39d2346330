"""The history of SYSCLKOUT in a recording of a program that begins with the clock after reset."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from periph_sim.core.records import Kind
from periph_sim.records.cause_trace.why import text, why
from periph_sim.records.clock_history import ClockHistory
from periph_sim.records.run import Run
from tests.records.test_run import access, by_hand


def test_the_clocks_of_a_recording_are_used():
    clocks = {"dsp": [(0, Fraction(7_500_000)), (50_400, Fraction(150_004_500))]}
    run = Run(replace(by_hand(access(20), access(2524)).table, clocks=clocks))
    assert run.cycles.how == "SYSCLKOUT 7.5 MHz, from 0.017 ms on 150.0045 MHz"
    assert run.length(4000, 400, "dsp") == run.length(4000, 400) == "1.333 us (10 cycles)"
    assert run.length(4000, 60_000) == "1.333 us (200 cycles)"
    assert run.length(50_400, 50_000) == "16.8 us (2501 cycles)"
    given = Run(run.table, sysclk=Fraction(75_000_000))
    assert given.length(4000, 400) == "1.333 us (100 cycles)"


def test_why_counts_cycles_in_the_clock_of_the_unit_in_the_question():
    run = by_hand(
        (30, Kind.FLAG, "left.I2C-A", "I2CSTR.RRDY", 1, "", 0),
        (30, Kind.FLAG, "right.I2C-A", "I2CSTR.RRDY", 1, "", 0),
        (30, Kind.EDGE, "SCL", "level", 0, "controller", 0),
    )
    clocks = {unit: [(0, Fraction(hz))] for unit, hz in (("left", 100_000_000), ("right", 150_000_000))}
    modules = dict.fromkeys(clocks, ("I2C-A",))
    both = Run(replace(run.table, modules=modules, clocks=clocks))
    answers = [text(why(both, f"{name}@2.2us")) for name in ("left.I2CA.I2CSTR.RRDY", "right.I2CA.I2CSTR.RRDY", "SCL")]
    assert ["2 us (200 cycles) before" in answers[0], "2 us (300 cycles) before" in answers[1]] == [True, True]
    assert "2 us before" in answers[2] and "cycle" not in answers[2]


THREE = ClockHistory((0, 100, 400), (Fraction(10), Fraction(20), Fraction(5)))


def test_cycles_are_numbered_continuously_over_changes_of_the_clock():
    """Ten cycles have 10 ticks, the next fifteen 20 ticks, and the rest 5 ticks."""
    begins = [*range(0, 100, 10), *range(100, 400, 20), *range(400, 450, 5)]
    assert [THREE.tick(number) for number in range(len(begins))] == begins
    assert THREE.numbers(np.array(begins)).tolist() == [*range(len(begins))]
    near = THREE.numbers(np.array([4, 5, 109, 110, 391, 402, 403])).tolist()
    assert near == [0, 1, 10, 11, 25, 25, 26]
    assert THREE.of_distances(np.array([14, 15, 29, 30, 12, 13]), np.array([0, 99, 100, 399, 400, 999])).tolist() == [
        1, 2, 1, 2, 2, 3
    ]  # fmt: skip
    assert THREE.ticks_of(3, np.array([0, 99, 100, 399, 400])).tolist() == [30, 30, 60, 60, 15]
    assert [THREE.at(tick) for tick in (-1, 0, 99, 100, 399, 400)] == [10, 10, 10, 20, 20, 5]
    assert [THREE.cycles(*ends) for ends in ((0, 400), (400, 0), (90, 120), (100, 100), (399, 405))] == [
        25,
        -25,
        2,
        0,
        1,
    ]


@pytest.mark.parametrize(
    ("clocks", "said"),
    [
        (1, "100 MHz"),
        (2, "100 MHz, from 0.000 ms on 50 MHz"),
        (3, "100 MHz, from 0.000 ms on 50 MHz, from 0.000 ms on 200 MHz"),
        (4, "40 MHz at last, changed 3 times"),
    ],
)
def test_up_to_three_clocks_are_listed(clocks: int, said: str):
    periods = (*THREE.periods, Fraction(25))[:clocks]
    found = ClockHistory((0, 100, 400, 500)[:clocks], periods)
    assert found.in_words(Fraction(1_000_000_000)) == said
