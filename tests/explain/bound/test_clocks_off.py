"""Clocks that are off: cycles of the unit fall on the grid of ticks in other places each time, by a tick."""

from __future__ import annotations

import pytest

from tests.explain.bound.cases import reported


@pytest.mark.parametrize("ppm", ["-11.3", "-50", "123.4"])
def test_what_interrupts_cost_is_rounded_up_to_the_grid(ppm: str):
    """A service routine may take a tick more than where it was measured; several of them, several ticks."""
    changes = ("host.period=7 ms", "controller.period=10 ms", "unit.dsp.settings.model_cost=3195 us")
    found = reported(f"unit.dsp.ppm={ppm}", *changes, frame_us=2, seconds="0.06")
    (model,) = (each for each in found.beside if each.bound.name == "span model")
    assert found.holds and model.seen is not None
    for term in (*found.handlers.terms, model.bound.terms[0]):
        assert 0 <= term.ticks / found.cycle % 1 < 1 / found.cycle  # whole cycles, rounded up to a tick
