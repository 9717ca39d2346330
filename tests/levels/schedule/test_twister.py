"""A row of draws is what Python's generator draws, one by one."""

from __future__ import annotations

from random import Random

import pytest

from periph_sim.levels.schedule.drawn_rows import drawn_rows
from periph_sim.levels.schedule.twister import LANES, MOST

NUMBERS = [0, 1, 5, -7, (1 << 32) - 1, 1 << 32, (1 << 62) + 7, *range(100, 100 + LANES)]


@pytest.mark.parametrize("below", [1, 2, 3001, 1 << 20, (1 << 32) - 1, (1 << 40) + 1])
@pytest.mark.parametrize("text", ["", " dsp computations", " " * (4 * MOST)])
def test_rows_are_the_draws_of_each_key(below: int, text: str):
    """Of one word and of several, more keys than lanes, keys that are too long for it, and words of two draws."""
    keys = [f"{number}{text}" if text else number for number in NUMBERS]
    for key, row in zip(keys, drawn_rows(keys, below, 5).tolist(), strict=True):
        draw = Random(key).randrange
        assert row == [draw(below) for _ in range(5)], key


def test_a_generator_goes_on_where_its_state_is_used_up():
    (row,) = drawn_rows(["3 dsp computations"], 3001, 1500).tolist()
    draw = Random("3 dsp computations").randrange
    assert row == [draw(3001) for _ in range(1500)]
