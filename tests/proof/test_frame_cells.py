"""Search for the cells of frames with a fake runner, in which a cycle has one tick and an orbit has eight."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from periph_sim.proof.frame_cells import find_cells
from periph_sim.proof.free_run import NotClosed
from periph_sim.proof.pair_groups import Cells, Orbit


def runner_of(entered_at: Callable[[int], int]) -> Any:
    """Return a runner whose first orbit is one of the start-up. entered_at: returns when a frame is received."""
    run, records = SimpleNamespace(now=0, frames=[]), SimpleNamespace(routine=1)

    def start(frames: int) -> None:
        run.frames.append(frames)
        records.entered = entered_at(frames)
        records.left = records.entered + 5

    def settle() -> None:
        run.now = (run.frames[-1] // 8 + 5) * 8

    run.start, run.settle = start, settle
    orbits = SimpleNamespace(known=[Orbit((b"",) * 8, 0), Orbit((b"",) * 8, 0)])
    runner = SimpleNamespace(run=run, records=records, cycle=1, at=(0, 0), orbits=orbits)
    runner.sci_period, runner.place, runner.check_frame = lambda: 4, lambda: (1, 0), lambda is_sent: None
    return runner


def test_cells_are_found_from_an_orbit_that_is_reached_again():
    """Frames that start in the last two ticks of four are received later."""
    assert find_cells(runner_of(lambda frame: (frame + 2) // 4 * 4 + 8)) == Cells(2, 4, 10, 15)


def test_frames_that_are_received_in_three_ways_have_no_cells():
    with pytest.raises(NotClosed, match="received in 3 ways"):
        find_cells(runner_of(lambda frame: frame // 4 * 4 + 8 + max(0, frame % 4 - 1)))
