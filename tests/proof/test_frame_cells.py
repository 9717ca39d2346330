"""Search of the cells of frames, with a runner that only gives answers: a cycle has one tick, an orbit eight."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from periph_sim.proof.frame_cells import find_cells
from periph_sim.proof.pair_groups import Cells, Orbit


def test_cells_are_found_from_an_orbit_that_is_reached_again():
    """The first orbit is one of the start-up. Frames that start in the last two ticks of four are received later."""
    run, records = SimpleNamespace(now=0, frames=[]), SimpleNamespace(routine=1)

    def start(frames: int) -> None:
        run.frames.append(frames)
        records.entered = (frames + 2) // 4 * 4 + 8
        records.left = records.entered + 5

    def settle() -> None:
        run.now = (run.frames[-1] // 8 + 5) * 8

    run.start, run.settle = start, settle
    orbits = SimpleNamespace(known=[Orbit((b"",) * 8, 0), Orbit((b"",) * 8, 0)])
    runner: Any = SimpleNamespace(run=run, records=records, cycle=1, at=(0, 0), orbits=orbits)
    runner.sci_period, runner.place, runner.check_frame = lambda: 4, lambda: (1, 0), lambda is_sent: None
    assert find_cells(runner) == Cells(2, 4, 10, 15)
