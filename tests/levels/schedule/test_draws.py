"""The draws are those of Python's generator, one by one."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from periph_sim.levels.schedule.draws import FEW, Drawn

SEEDS = st.lists(st.integers(0, 1 << 40), min_size=1, max_size=5)


@example([1, 1, 2], 1, 3)
@example([1], 1 << 31, 40)  # a word in two is rejected
@example([3], (1 << 40) + 1, 4)  # of two words each
@given(SEEDS, st.integers(1, 1 << 34), st.integers(1, 60))
def test_each_number_is_the_one_that_an_edge_run_draws(seeds: list[int], below: int, count: int):
    drawn = Drawn(np.array(seeds), below, count, lambda seed: f"{seed} dsp computations")
    came = np.array([drawn.row(number) for number in range(count)])
    draw = [Random(f"{seed} dsp computations") for seed in seeds]
    assert came.T.tolist() == [[one.randrange(below) for _ in range(count)] for one in draw]


@pytest.mark.parametrize("name", ["", " dsp computations"])
@pytest.mark.parametrize("below", [3001, 1 << 20, (1 << 32) - 1])
def test_many_seeds_at_once_draw_what_each_draws_alone(name: str, below: int):
    """Of words of one and of two digits, of 32 and of 64 bits; more of them than a generator has state for."""
    seeds = np.concatenate([np.arange(-3, FEW), np.array([99, 12_345, 1 << 31, 1 << 32, (1 << 62) + 7, -(1 << 40)])])
    drawn = Drawn(seeds, below, 700, lambda seed: f"{seed}{name}" if name else seed)
    came = np.array([drawn.row(number) for number in range(700)])
    for seed, numbers in zip(seeds.tolist(), came.T.tolist(), strict=True):
        draw = Random(f"{seed}{name}" if name else seed).randrange
        assert numbers == [draw(below) for _ in range(700)], seed


def test_the_draws_of_a_range_are_those_of_randint():
    drawn = Drawn(np.array([5]), 3001, 50, lambda seed: seed + 1)
    one = Random(6)
    assert [int(drawn.row(number)[0]) + 34_200 for number in range(50)] == [
        one.randint(34_200, 37_200) for _ in range(50)
    ]
