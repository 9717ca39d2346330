"""Conversion between steps of a simulator and ticks of a session, without drift for any lengths of both."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.cosim.axis import Axis
from tests.outside.sessions import refuses

TICKS = 3_000_000_000  # ticks per second of a 150 MHz part


@given(st.integers(0, 10**15), st.integers(TICKS, 10**12), st.integers(0, 10**9), st.sampled_from([12, 13, 15]))
def test_the_step_of_a_tick_is_within_that_tick(tick: int, ticks: int, begin: int, power: int) -> None:
    axis = Axis(10**power, ticks, begin)
    step = axis.step(tick)
    assert axis.tick(step) == tick
    assert (step - begin) * ticks >= tick * 10**power > (step - 1 - begin) * ticks


def test_ticks_of_a_third_of_a_nanosecond() -> None:
    axis = Axis(10**12, TICKS)
    assert [axis.step(tick) for tick in range(5)] == [0, 334, 667, 1000, 1334]
    assert [axis.tick(step) for step in (0, 333, 334, 666, 667, 999, 1000)] == [0, 0, 1, 1, 2, 2, 3]


@pytest.mark.parametrize(
    ("steps", "ticks", "sentence"),
    [
        (10**9, TICKS, r"precision is 1 ns, and a tick of this case is 333 ps; write `timescale 1ns/1ps into"),
        (10**8, TICKS, r"precision is 10 ns"),
        (10**12, 3 * 10**12, r"precision is 1 ps, and a tick of this case is 0.333 ps; write `timescale 1ns/100fs"),
        (10**15, 10**16, r"a tick is shorter than 1 fs"),
    ],
)
def test_steps_longer_than_a_tick_are_refused_with_the_timescale_to_write(
    steps: int, ticks: int, sentence: str
) -> None:
    refuses(sentence, Axis, steps, ticks)
