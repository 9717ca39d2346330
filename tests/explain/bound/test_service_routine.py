"""Lengths of the host's clock in ticks."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.core.time import Timebase
from periph_sim.explain.bound.service_routine import ServiceRoutines, in_ticks, observe_handlers
from periph_sim.explain.bound.terms import Term, reasons
from tests.explain.bound.cases import imu_hil


@pytest.mark.parametrize(("ppm", "told", "passed"), [(0, 7, 7), (100, 10_001, 10_000), (-100, 9_999, 10_000)])
def test_a_fast_clock_counts_more_seconds_than_pass(ppm: int, told: int, passed: int):
    timebase = Timebase(150_000_000)
    assert in_ticks(Fraction(told), Fraction(ppm), timebase) == passed * timebase.per_second


def test_requests_of_two_frames_are_a_period_less_the_jitter_apart():
    one = ServiceRoutines((Term("routine", 40, ""),), per_frame=1, period=1000, jitter=70, bit=5)
    assert one.apart == 930


def test_routines_that_meet_some_work_are_counted_until_one_more_look_finds_no_more():
    looks: list[int] = []

    class Counted(ServiceRoutines):
        def times(self, length: int) -> int:
            looks.append(length)
            assert len(looks) < 9
            return super().times(length)

    each = Counted((Term("routine", 40, ""),), per_frame=1, period=100, jitter=0, bit=5)
    assert each.within(90) == 2
    assert looks == [90, 130, 170]  # one begins with the work, one more within what both need


@pytest.mark.parametrize("ppm", [-80, 0])
def test_routines_of_the_same_cycles_are_alike_where_a_cycle_is_no_whole_number_of_ticks(ppm: int):
    handlers = observe_handlers(imu_hil(f"unit.dsp.ppm={ppm}", "host.first=2 ms"), "dsp")
    assert handlers.per_frame == 1 and not reasons(handlers.terms)
