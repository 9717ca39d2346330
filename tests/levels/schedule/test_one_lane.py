"""Waits and code of one scenario come to what arrays of them come to, wherever the interrupt lies."""

from __future__ import annotations

import numpy as np
import pytest

from periph_sim.levels.schedule import structure_of
from periph_sim.levels.schedule.clock import CpuClock
from periph_sim.levels.schedule.lanes import Interrupts
from periph_sim.levels.schedule.one_lane import FAR, Lane, Piece
from periph_sim.levels.schedule.stored import Stored
from periph_sim.scene.case.load import load
from tests.scene.runs import TIMING

POLL, BEGUN = 10, 1_000_000  # cycles, ticks


@pytest.mark.parametrize(("num", "den"), [(2_000_000, 100_003), (20, 1)])
def test_an_interrupt_anywhere_around_a_wait_or_a_code_moves_it_as_in_an_array(num: int, den: int):
    """A latch is worked out only where its bounds do not decide: here on both sides of each boundary."""
    structure = structure_of(load(TIMING / "imu_hil_published.toml"))
    terms, clock = structure.terms, CpuClock(num, den)
    lane = Lane(terms, structure.receiver)
    lane.num, lane.den = num, den
    lane.hosts(np.zeros(1, np.int64), False, False, 1)
    latch = int(structure.receiver.latch(clock, np.array([BEGUN]), np.zeros(1, np.int64))[0])
    code = terms.reads[0].clear
    reach = 3 * (POLL + terms.waits + terms.service + structure.receiver.period)
    assert code.length < reach
    moved = 0
    for flag in range(latch - reach, latch + reach, 7):
        for length in (-30, -1, 0, 1, POLL, 90, reach // 2, reach):
            first = flag - length
            interrupts = Interrupts(Stored.of(np.array([[latch], [FAR]])), terms.service, terms.waits)
            lanes = interrupts.lanes(np.zeros(1, np.int64))
            expected = int(lanes.wait(np.array([first]), np.array([flag]), POLL)[0])
            for wait in (lane.wait_from_far, lambda *at: lane.wait(*at, 0)):
                lane.host(BEGUN, 1, 1, 0)
                assert wait(first, flag, POLL) == expected, (flag - latch, length)
                assert lane.number == int(lanes.places[0])
            moved += lane.number
        lane.host(BEGUN, 1, 1, 0)
        lanes = interrupts.lanes(np.zeros(1, np.int64))
        end, marks = lanes.code(np.array([flag]), code)
        assert (lane.code(flag, Piece(code)), lane.mark) == (int(end[0]), int(marks[0][0])), flag - latch
    assert 300 < moved < 8 * 2 * reach // 7 - 300


@pytest.mark.parametrize(("num", "den"), [(2_000_000, 100_003), (20, 1), (199, 10)])
def test_a_latch_lies_in_a_receivers_sample_behind_its_bound(num: int, den: int):
    structure = structure_of(load(TIMING / "imu_hil_published.toml"))
    lane = Lane(structure.terms, structure.receiver)
    lane.num, lane.den = num, den
    lane.hosts(np.zeros(1, np.int64), False, False, 1)
    begun = np.arange(BEGUN, BEGUN + 20_000)
    latches = structure.receiver.latch(CpuClock(num, den), begun, np.zeros(len(begun), np.int64))
    behind = []
    for begin, latch in zip(begun.tolist(), latches.tolist(), strict=True):
        lane.host(begin, 1, 1, 0)
        behind.append(latch * num - lane.lowest)
    assert (
        0 <= min(behind) < num < (structure.receiver.period - 1) * num < max(behind) < structure.receiver.period * num
    )
