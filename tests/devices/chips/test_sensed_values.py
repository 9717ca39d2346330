"""Sources of sensed values: tables, arrays and rules as functions of time."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from periph_sim.devices.chips.adxl345 import Adxl345
from periph_sim.devices.chips.sensed_values import held, numbered, scaled
from tests.devices.bench import TIMEBASE


def test_a_row_is_valid_until_the_next():
    source = held([10, 20], [(1, 0, 0), (2, 0, 0)])
    assert [source(tick)[0] for tick in (-5, 10, 19, 20, 1000)] == [1, 1, 1, 2, 2]


def test_arrays_are_accepted_and_can_feed_a_chip():
    source = held(np.array([0, 10_000_000], np.int64), np.array([[0.25, 0.5, 1], [-0.25, -0.5, -1]]))
    chip = Adxl345(TIMEBASE, source)
    assert chip.formatted(source(0)).hex() == "400080000001"
    assert chip.formatted(source(10_000_000)).hex() == "c0ff80ff00ff"


@pytest.mark.parametrize(("ticks", "number"), [([1, 1], 2), ([2, 1], 2), ([1], 2), ([], 0)])
def test_times_that_do_not_rise_or_do_not_match_the_rows_are_rejected(ticks: list[int], number: int):
    with pytest.raises(ValueError, match=r"must rise|each row needs one"):
        held(ticks, [(0, 0, 0)] * number)


def test_numbers_change_every_period_and_are_zero_before_the_first():
    source = numbered(100, 10, lambda n: (n, -n, 7))
    assert [source(tick) for tick in (99, 100, 109, 110, 135)] == [
        (0, 0, 0),
        (0, 0, 7),
        (0, 0, 7),
        (1, -1, 7),
        (3, -3, 7),
    ]


def test_lsb_are_converted_to_units_exactly():
    source = scaled(lambda tick: (115, -1, 0), Fraction(115, 8))
    assert source(0) == (8, Fraction(-8, 115), 0)


def test_a_frame_is_computed_once_for_consecutive_samples():
    asked: list[int] = []
    source = scaled(numbered(0, 10, lambda n: (asked.append(n), (n, 0, 2 * n))[1]), Fraction(2))
    ticks = (0, 4, 9, 10, 11, 5, 19)
    assert [source(tick) for tick in ticks] == [(Fraction(n, 2), 0, n) for n in (0, 0, 0, 1, 1, 0, 1)]
    assert asked == [0, 1, 0, 1]
