"""The windows of a coverage as a picture: a lane for each failure over the phases of a period.

missed rounds ----[broken]--------[broken]---       windows
              0        5        10       15  ms     phase
"""

from __future__ import annotations

from ...proof.cover import Window
from ...traces.drawing.svg_diagram import WRONG, Box, Lane, timing_diagram
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


def _boxes(coverage: Coverage, windows: list[Window]) -> list[Box]:
    """Return a box for each window; two boxes for a window that continues from the end of the period to its start."""
    phases, found = coverage.case.phases, []
    for window in windows:
        pieces = [(window.first, window.last)]
        if window.first > window.last:
            pieces = [(0, window.last), (window.first, phases.count - 1)]
        found += [Box(float(phases.seconds(a)), float(phases.seconds(b + 1)), "", wrong=True) for a, b in pieces]
    return found
