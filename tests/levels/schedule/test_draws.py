"""The draws are those of Python's generator, one by one."""

from __future__ import annotations

from random import Random

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from periph_sim.levels.schedule.draws import Drawn

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


def test_the_draws_of_a_range_are_those_of_randint():
    drawn = Drawn(np.array([5]), 3001, 50, lambda seed: seed + 1)
    one = Random(6)
    assert [int(drawn.row(number)[0]) + 34_200 for number in range(50)] == [
        one.randint(34_200, 37_200) for _ in range(50)
    ]
