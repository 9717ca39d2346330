"""Pictures of a coverage: the windows over the phases of a period, and the shares of runs that fail over time.

missed rounds   ----[broken]--------[broken]---      windows
                0        5        10       15  ms    phase

missed rounds   [8 of 16][6 of 10][2 of 4][2 of 2]   shares of the runs that have begun like the run at 18.95228 ms
at 18.95228 ms  0       100      200     300     ms  time in that run
"""

from __future__ import annotations

from collections.abc import Sequence

from ...proof.cover import Window
from ...traces.drawing.svg_diagram import WRONG, Box, Lane, timing_diagram
from .certain_failure import CertainFailure
from .coverage import Coverage

GROUP = "phases at which a budget is broken, or the firmware fails"


def picture(coverage: Coverage) -> str:
    """Return the picture as SVG text. Budgets that held have no lane."""
    phases = coverage.case.phases
    names = dict.fromkeys(window.name for window in coverage.windows)
    first, last = coverage.choice.bounds
    window = float(phases.seconds(first)), float(phases.seconds(last + 1))
    lanes = [
        Lane(name, GROUP, WRONG, boxes=tuple(_boxes(coverage, [one for one in coverage.windows if one.name == name])))
        for name in names
    ]
    title = f"{coverage.case.case.name}: {coverage.run_count:,} of {phases.count:,} phases run"
    return timing_diagram(lanes or [Lane("nothing failed", GROUP)], window, title=title, axis="phase")


def picture_of_shares(coverage: Coverage, certain: Sequence[CertainFailure]) -> str:
    """Return the shares of runs that fail as SVG text, with a lane for each end of a window."""
    end = max(float(coverage.case.phases.inputs([one.phase])[1]) for one in certain)
    lanes = [Lane(coverage.choice.time(one.phase), one.name, boxes=tuple(_share_boxes(one, end))) for one in certain]
    title = f"{coverage.case.case.name}: runs that fail, of those that have begun like the run with this phase"
    return timing_diagram(lanes, (0.0, end), title=title, axis="time in the run with this phase")


def _share_boxes(one: CertainFailure, end: float) -> list[Box]:
    ends = [*(share.at_s for share in one.shares[1:]), end]
    return [
        Box(share.at_s, until, f"{share.failing} of {share.runs}", wrong=share.failing == share.runs)
        for share, until in zip(one.shares, ends, strict=True)
    ]


def _boxes(coverage: Coverage, windows: list[Window]) -> list[Box]:
    """Return a box for each window; two boxes for a window that continues from the end of the period to its start."""
    phases, found = coverage.case.phases, []
    for window in windows:
        pieces = [(window.first, window.last)]
        if window.first > window.last:
            pieces = [(0, window.last), (window.first, phases.count - 1)]
        found += [Box(float(phases.seconds(a)), float(phases.seconds(b + 1)), "", wrong=True) for a, b in pieces]
    return found
