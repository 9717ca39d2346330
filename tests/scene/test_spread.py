"""Computations whose cost is a range: each takes a value drawn from the range."""

from __future__ import annotations

from fractions import Fraction

from periph_sim import Dsp, Firmware, Scene
from periph_sim.core.table import spread
from tests.scene.small import case

CYCLE = 20  # ticks at 150 MHz


def costs(text: str, seed: int = 1, unit: str = "dsp", times: int = 200) -> list[int]:
    """Return the cycles of consecutive computations with this spread."""
    spans: list[int] = []

    def main(dsp: Dsp, settings: object) -> None:
        for _ in range(times):
            before = dsp.cpu.cycle
            dsp.compute(spread(text), "work")
            spans.append(dsp.cpu.cycle - before)

    plain = case(seed=seed, unit={unit: {"firmware": "given", "modules": []}})
    Scene(plain, programs={unit: Firmware("given", main, None)}).run(Fraction(1, 100))
    return spans


def test_each_computation_draws_a_cost_of_the_range_and_all_are_drawn():
    drawn = costs("60 ns to 120 ns", times=400)
    assert set(drawn) == set(range(9, 19))


def test_a_range_of_one_value_is_that_value_and_rounds_up_to_a_cycle():
    assert set(costs("61 ns")) == {10}


def test_draws_belong_to_the_seed_and_the_unit():
    assert costs("1 us to 2 us") == costs("1 us to 2 us")
    assert costs("1 us to 2 us") != costs("1 us to 2 us", seed=2)
    assert costs("1 us to 2 us") != costs("1 us to 2 us", unit="other")
