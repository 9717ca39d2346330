"""A recorded run: lengths in units and in cycles, and where the length of a cycle is known from."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.core.records import Kind
from tests.records.scenes import by_hand


@pytest.mark.parametrize(
    ("cycles", "said"),
    [
        (0, "0 ns (0 cycles)"),
        (1, "6.667 ns (1 cycle)"),
        (149, "993.333 ns (149 cycles)"),
        (150, "1 us (150 cycles)"),
        (149_999, "999.993 us (149999 cycles)"),
        (150_000, "1 ms (150000 cycles)"),
        (149_999_999, "1000 ms (149999999 cycles)"),
        (150_000_000, "1 s (150000000 cycles)"),
        (-150, "-1 us (-150 cycles)"),
        (-1, "-6.667 ns (-1 cycles)"),
        (45_000, "300 us (45000 cycles)"),
    ],
)
def test_a_distance_is_said_in_the_unit_that_suits_it(cycles: int, said: str):
    assert by_hand().length(cycles * 20) == said


@pytest.mark.parametrize(("ticks", "cycles"), [(9, 0), (10, 0), (11, 1), (29, 1), (30, 2), (31, 2), (-11, -1)])
def test_cycles_are_rounded_to_nearest(ticks: int, cycles: int):
    assert by_hand().cycles.of(ticks) == cycles


def access(cycle: int) -> tuple[Any, ...]:
    return cycle, Kind.ACCESS, "dsp", "R I2C-A.I2CSTR", 0, "f:1", 0


def test_the_cycle_is_said_with_where_it_is_known_from():
    assert by_hand(access(1), access(4)).cycles.how == "SYSCLKOUT 150 MHz, which all accesses fall on"
    one = "SYSCLKOUT taken as 150 MHz; the accesses fall on no one grid (an error of the crystal, or several)"
    assert by_hand(access(1)).cycles.how == by_hand().cycles.how == one
    slower = by_hand(access(0), access(3), access(6), access(10))
    slower.table.columns["tick"] = slower.table.tick * 3 // 2
    assert slower.cycles.how == "SYSCLKOUT 100 MHz, the grid that all accesses fall on"
    finer = by_hand(access(0), access(3), access(4))
    finer.table.columns["tick"] = finer.table.tick - 1 * (finer.table.tick > 70)  # 0, 60, 79: no grid of cycles
    assert finer.cycles.how == one and finer.cycles.ticks == 20
