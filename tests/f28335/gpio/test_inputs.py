"""The input qualifier: its output follows after three or six equal samples, one every `period` cycles."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.chip import NEVER
from periph_sim.f28335.gpio.inputs import Qualifier
from tests.waves import DiagramRig, play, tidy


class Rig(DiagramRig):
    """A qualifier that is woken only when due. Signal `in` is its synchronised input, `out` its output."""

    def __init__(self, period: int, samples: int) -> None:
        self.qualifier = Qualifier(0, 0, period, samples, 0)

    def drive(self, now: int, signal: str, level: int) -> None:
        self.qualifier.edge(now, level)

    def run_until(self, time: int) -> None:
        if self.qualifier.due <= time:
            self.qualifier.advance(self.qualifier.due)

    def show(self, signal: str) -> int:
        return self.qualifier.qualified


THREE_SAMPLES_EVERY_CYCLE = """
    > in   0 1 . 0 1 . . 0 . . .
    < out  0 . . . . . 1 . . 0 .
"""
THREE_SAMPLES_EVERY_SECOND_CYCLE = """
    > in   0 . . 1 . . . . . . . .
    < out  0 . . . . . . . 1 . . .
"""
SIX_SAMPLES_EVERY_CYCLE = """
    > in   0 1 . . . . 0 1 . . . . . .
    < out  0 . . . . . . . . . . . 1 .
"""
SIX_SAMPLES_EVERY_SECOND_CYCLE = """
    > in   0 1 . . . . . . . . . . . 0 . . . . . . . . . . .
    < out  0 . . . . . . . . . . . 1 . . . . . . . . . . . 0
"""


@pytest.mark.rule("SYS-070")
@pytest.mark.parametrize(
    ("diagram", "period", "samples"),
    [
        (THREE_SAMPLES_EVERY_CYCLE, 1, 3),
        (THREE_SAMPLES_EVERY_SECOND_CYCLE, 2, 3),
        (SIX_SAMPLES_EVERY_CYCLE, 1, 6),
        (SIX_SAMPLES_EVERY_SECOND_CYCLE, 2, 6),
    ],
)
def test_a_level_reaches_the_output_with_the_last_of_enough_equal_samples(diagram, period, samples):
    assert play(diagram, Rig(period, samples), 1) == tidy(diagram)


def test_a_glitch_between_two_samples_has_no_effect():
    Rig(3, 3).check("""
        > in   0 1 . . 0 1 . . . . . . .
        < out  0 . . . . . . . . 1 . . .
    """)


def passes(period: int, samples: int, phase: int, width: int) -> bool:
    """Return True if a high pulse that begins `phase` cycles after a sample reaches the output."""
    qualifier = Qualifier(0, 0, period, samples, 0)
    begin = period + phase
    qualifier.edge(begin, 1)
    came_through = qualifier.due < begin + width
    qualifier.edge(begin + width, 0)
    assert came_through == bool(qualifier.qualified)
    return came_through


PERIODS_AND_SAMPLES = [(1, 3), (1, 6), (2, 3), (2, 6), (4, 6), (10, 3), (510, 6)]


@pytest.mark.rule("SYS-072")
@pytest.mark.parametrize(("period", "samples"), PERIODS_AND_SAMPLES)
def test_a_pulse_no_longer_than_the_window_is_suppressed_in_every_phase(period, samples):
    window = (samples - 1) * period
    assert not any(passes(period, samples, phase, window) for phase in range(period))


@pytest.mark.rule("SYS-073")
@pytest.mark.parametrize(("period", "samples"), PERIODS_AND_SAMPLES)
def test_a_pulse_of_window_and_period_and_one_cycle_passes_in_every_phase(period, samples):
    enough = (samples - 1) * period + period + 1
    assert all(passes(period, samples, phase, enough) for phase in range(period))


@pytest.mark.rule("SYS-074")
@pytest.mark.parametrize(("period", "samples"), PERIODS_AND_SAMPLES)
def test_the_erratum_pulse_passes_in_exactly_one_phase(period, samples):
    width = period * samples - (period - 1)
    assert sum(passes(period, samples, phase, width) for phase in range(period)) == 1


class BruteForce:
    """Reference qualifier that processes each sample, as drawn in the manual."""

    def __init__(self, period: int, samples: int) -> None:
        self.period, self.samples, self.origin = period, samples, 0
        self.level = self.qualified = 0
        self.history = [0] * 6

    def cycle(self, now: int) -> None:
        if (now - self.origin) % self.period == 0 and now > self.origin:
            self.history = [*self.history[1:], self.level]
            last = self.history[-self.samples :]
            if len(set(last)) == 1:
                self.qualified = last[0]


PERIOD = st.sampled_from([1, 2, 4, 6, 10])
ACTIONS = st.one_of(
    st.integers(0, 1),
    st.tuples(PERIOD, st.sampled_from([3, 6])),
)


@given(PERIOD, st.sampled_from([3, 6]), st.lists(st.tuples(st.integers(1, 25), ACTIONS), max_size=30))
def test_the_qualifier_equals_one_that_processes_each_sample(period, samples, steps):
    lazy, brute = Qualifier(0, 0, period, samples, 0), BruteForce(period, samples)
    now = 0
    for gap, action in [*steps, (80, 0)]:
        for cycle in range(now + 1, now + gap + 1):
            if isinstance(action, int) and cycle == now + gap:
                lazy.edge(cycle, action)
                brute.level = action
            brute.cycle(cycle)
            if lazy.due == cycle:  # `advance` is never called in other cycles
                lazy.advance(cycle)
            assert lazy.qualified == brute.qualified, f"cycle {cycle}"
            assert lazy.due > cycle
        now += gap
        if not isinstance(action, int):
            origin = now if action[0] != brute.period else brute.origin
            lazy.configure(now, action[0], action[1], origin)
            (brute.period, brute.samples), brute.origin = action, origin


def test_a_constant_level_requests_no_wake_up():
    assert Qualifier(0, 1, 2, 6, 0).due == NEVER
