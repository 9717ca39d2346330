"""SYSCLKOUT as a recording shows it, of a program that begins at the reset's clock."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.core.records import Kind
from periph_sim.records.clock_history import ClockHistory, history
from tests.records.test_run import access, by_hand

SECOND = Fraction(3_000_000_000)
SET_UP = [
    (8400, "PLLSTS.PLLLOCKS", 0),
    (8400, "PLLCR.DIV", 10),
    (50_400, "PLLSTS.PLLLOCKS", 1),
    (50_480, "PLLSTS.DIVSEL", 2),
]
CLOCKS = ClockHistory((0, 50_400, 50_480), (Fraction(400), Fraction(40), Fraction(20)))


def test_each_setting_has_its_clock():
    """OSCCLK / 4, also while the PLL locks; then 75 MHz; then 150 MHz."""
    assert history(SECOND, SET_UP, [400, 8400, 50_400, 50_440, 50_480, 50_500]) == CLOCKS


@pytest.mark.parametrize("tick", [600, 50_430, 50_490])
def test_accesses_off_the_grid_are_of_another_clock(tick: int):
    assert history(SECOND, SET_UP, [400, 50_400, 50_480, tick]) is None


def test_who_shows_no_setting_began_at_full_speed():
    assert history(SECOND, [], [0, 20]) is None


def test_a_boot_rom_leaves_divsel():
    found = history(SECOND, [(400, "PLLSTS.DIVSEL", 0), (2000, "WDCR.WDDIS", 1)], [])
    assert found == ClockHistory((0, 400), (Fraction(200), Fraction(400)))


@pytest.mark.parametrize(
    ("begin", "end", "cycles"),
    [(0, 4000, 10), (50_000, 50_480, 3), (50_480, 50_680, 10), (50_400, 50_680, 12), (50_680, 50_400, -12)],
)
def test_cycles_between_two_ticks(begin: int, end: int, cycles: int):
    assert CLOCKS.cycles(begin, end) == cycles


def test_a_distance_is_said_in_cycles_of_its_time():
    flags = [(tick // 20, Kind.FLAG, "dsp.SYS", what, value, "", 0) for tick, what, value in SET_UP]
    run = by_hand(access(20), *flags, access(2524))
    assert run.length(4000, 400) == "1.333 us (10 cycles)"
    assert run.length(4000, 60_000) == "1.333 us (200 cycles)"
    slow = by_hand(access(20), (20, Kind.FLAG, "dsp.SYS", "WDCR.WDDIS", 1, "", 0), access(60))
    assert slow.cycles.how == "SYSCLKOUT 7.5 MHz, the reset's, which the program never changed"
