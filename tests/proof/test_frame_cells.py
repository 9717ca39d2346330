"""Search for the cells of frames with a fake runner, in which a cycle has one tick and an orbit has eight."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from periph_sim.proof.frame_cells import MOST_AWAY, find_cells
from periph_sim.proof.free_run import NotClosed
from periph_sim.proof.pair_groups import Cells, Orbit


def runner_of(entered_at: Callable[[int], int], **different: int) -> Any:
    """Return a runner whose first orbit is one of the start-up. entered_at: returns when a frame is received.

    different: values that are 1 instead of 0 after frames in the last tick of four: "routine", "after" or "shift".
    """
    run, records = SimpleNamespace(now=0, frames=[]), SimpleNamespace(routine=0)
    runner = SimpleNamespace(run=run, records=records, cycle=1, at=(0, 0), checked=[])

    def start(frames: int) -> None:
        run.frames.append(frames)
        records.entered = entered_at(frames)
        records.left = records.entered + 5
        records.routine = is_last() * different.get("routine", 0)

    def settle() -> None:
        run.now = (run.frames[-1] // 8 + 5) * 8

    def is_last() -> bool:
        return run.frames[-1] % 4 == 3

    def place() -> tuple[int, int]:
        return 1 + is_last() * different.get("after", 0), is_last() * different.get("shift", 0)

    run.start, run.settle = start, settle
    runner.orbits = SimpleNamespace(known=[Orbit((b"",) * 8, origin) for origin in (1, 0, 0)])
    runner.sci_period, runner.place = lambda: 4, place
    runner.check_frame = lambda is_sent: runner.checked.append(is_sent)
    return runner


@pytest.mark.parametrize(
    ("entered_at", "cells"),
    [
        (lambda frame: (frame + 2) // 4 * 4 + 8, Cells(2, 4, 10, 15)),
        (lambda frame: (frame + 3) // 4 * 4 + 8, Cells(1, 4, 11, 16)),
        (lambda frame: (frame + 2) // 4 * 4 + 8 + 3 * ((frame + 2) // 4 % 2), Cells(2, 4, 10, 18)),
        (lambda frame: frame // 4 * 4 + 8, Cells(0, 4, 8, 13)),
    ],
)
def test_cells_are_found_from_an_orbit_that_is_reached_again(entered_at: Callable[[int], int], cells: Cells):
    """Frames that start in the last two or three ticks of four are received later; those of every second cell by 3."""
    runner = runner_of(entered_at)
    assert find_cells(runner) == cells
    assert runner.checked == [True] * (1 + MOST_AWAY + 4)  # one leaves the first orbit, and four have the cells


def test_frames_that_are_received_in_three_ways_have_no_cells():
    with pytest.raises(NotClosed, match="received in 3 ways"):
        find_cells(runner_of(lambda frame: frame // 4 * 4 + 8 + max(0, frame % 4 - 1)))


@pytest.mark.parametrize("difference", ["routine", "after", "shift"])
def test_frames_of_one_cell_with_different_effects_have_no_cells(difference: str):
    with pytest.raises(NotClosed, match="received in 3 ways"):
        find_cells(runner_of(lambda frame: (frame + 2) // 4 * 4 + 8, **{difference: 1}))
