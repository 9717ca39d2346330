"""Worst and least margin of a kept round are those of the bytes of its extreme parts, where these are alone."""

from __future__ import annotations

from functools import cache
from random import Random

import numpy as np
import pytest

from periph_sim.levels.schedule import Structure, structure_of
from periph_sim.levels.schedule.clock import CpuClock
from periph_sim.levels.schedule.kept_margins import KeptMargins
from periph_sim.levels.schedule.one_lane import Lane
from periph_sim.levels.schedule.read import margins_of
from periph_sim.levels.schedule.value_range import ValueRange
from periph_sim.scene.case.load import load
from tests.scene.runs import TIMING

BYTES = 5


@cache
def structure() -> Structure:
    return structure_of(load(TIMING / "imu_hil_published.toml"))


@pytest.mark.parametrize(("num", "den"), [(2_000_000, 100_003), (20, 1), (199, 10)])
def test_the_bytes_of_the_extreme_parts_have_the_extreme_margins(num: int, den: int):
    """Over many STARTs of many rounds, of which some bytes are a few cycles apart, and others less than a tick."""
    terms, clock, random = structure().terms, CpuClock(num, den), Random(1)
    lane = Lane(terms, structure().receiver)
    lane.num, lane.den = num, den
    rounds_alone, orders = 0, set()
    for _ in range(200):
        let_go = [random.randrange(9_000, 9_040) for _ in range(BYTES)]
        landed = [random.randrange(300, 304) for _ in range(BYTES)]
        start = random.randrange(1_000_000)
        kept = KeptMargins()
        kept.clear(den)
        for each in zip(let_go, landed, strict=True):
            kept.add(each[0] * den - each[1] * num, *each)
        assert kept.most == max(at * den - cycle * num for at, cycle in zip(let_go, landed, strict=True))
        assert kept.least == min(at * den - cycle * num for at, cycle in zip(let_go, landed, strict=True))
        rounds_alone += kept.alone
        for begin in range(start, start + 50 * kept.alone):
            cycle = -(-begin * den // num)
            range_ = ValueRange()
            kept.take(range_, lane, begin, cycle)
            ticks = begin + np.array(let_go)
            writes = clock.tick(cycle + np.array([landed, landed]))
            values = margins_of(terms, clock, ticks, writes)[0].tolist()
            assert (range_.worst, range_.least, range_.count) == (max(values), min(values), 0)
            orders.add((values.index(max(values)), values.index(min(values))))
    assert 10 < rounds_alone < 190 and len(orders) > BYTES
