"""Lengths of the host's clock in ticks."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.core.time import Timebase
from periph_sim.explain.bound.service_routine import in_ticks


@pytest.mark.parametrize(("ppm", "told", "passed"), [(0, 7, 7), (100, 10_001, 10_000), (-100, 9_999, 10_000)])
def test_a_fast_clock_counts_more_seconds_than_pass(ppm: int, told: int, passed: int):
    timebase = Timebase(150_000_000)
    assert in_ticks(Fraction(told), Fraction(ppm), timebase) == passed * timebase.per_second
