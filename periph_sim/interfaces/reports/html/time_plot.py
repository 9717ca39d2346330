"""Layout of the plot of a budget's values over the run (`OverTime`).

5.1 us |- - - - - - - - - - - -  max      each column is a dot or a stroke; limits are horizontal lines;
       |  .  .  | .  .   . |              values beyond a limit are drawn a second time, on top
   0 us |__________________________
       0 s         5 s         10 s

The field is the area that the axes enclose. Positions are in percent of the field, so they fit any page width.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, floor

from ....traces.drawing.svg_diagram import nice_step
from .over_time import OverTime
from .plot import number

WIDTH, HEIGHT = 1000, 100  # size of the field in the units of the SVG paths
NEAR = 1.5  # a limit is drawn if it is within this many spreads of the values
ROOM = 0.08  # margin above and below, as a fraction of the height of the field


Place = Callable[[float], float]


@dataclass(frozen=True)
class Line:
    """A limit across the field. y: percent from the top; None if it is off scale."""

    text: str
    y: float | None
    above: bool = True


@dataclass(frozen=True)
class TimePlot:
    """up, across: positions in percent with texts. values, broken: SVG paths. summary: for screen readers."""

    up: tuple[tuple[float, str], ...]
    across: tuple[tuple[float, str], ...]
    lines: tuple[Line, ...]
    values: str
    broken: str
    summary: str


def time_plot(over: OverTime, unit: str, size: int, per_second: int) -> TimePlot:
    """Lay out the plot. unit, size: the unit to show, and its size in units of the values."""
    seen = [*(c.low for c in over.columns), *(c.high for c in over.columns)]
    lines = [(key.replace("_", "."), value) for key, value in over.limits]
    least, most = min(seen), max(seen)
    reach = NEAR * (most - least or abs(most) or 1)
    near = [value for _, value in lines if least - reach <= value <= most + reach]
    low, high = min([least, *near]), max([most, *near])
    low = 0 if 0 < low < 0.4 * high else low
    room = ROOM * (high - low or abs(high) or 1)
    begin, end = (0.0 if low == 0 else low - room), high + room

    def y(value: float) -> float:
        return round(100 * (end - value) / (end - begin), 1)

    def x(at: int) -> float:
        return round(WIDTH * at / max(over.end, 1), 1)

    def line(name: str, value: int) -> Line:
        inside = begin <= value <= end
        text = f"{name} {number(value / size)} {unit}".rstrip()
        return Line(text, y(value) if inside else None, value > end)

    strokes = (f"M{x(c.at):g} {y(c.high):g}v{round(y(c.low) - y(c.high), 1):g}" for c in over.columns)
    marks = (f"M{x(c.at):g} {y(c.low if over.which == 'min' else c.high):g}v0" for c in over.columns if c.beyond)
    return TimePlot(
        up=_ticks(begin / size, end / size, 3, lambda value: y(value * size), unit),
        across=_ticks(0, over.end / per_second, 8, lambda s: round(100 * s * per_second / max(over.end, 1), 2), "s"),
        lines=tuple(line(*one) for one in lines),
        values="".join(dict.fromkeys(strokes)),
        broken="".join(marks),
        summary=_summary(over),
    )


def _ticks(
    begin: float, end: float, most: int, place: Callable[[float], float], unit: str
) -> tuple[tuple[float, str], ...]:
    step = nice_step(end - begin, most) if end > begin else 1.0
    first, last = ceil(begin / step - 1e-9), floor(end / step + 1e-9)
    return tuple((place(n * step), f"{number(n * step, step)} {unit}".rstrip()) for n in range(first, last + 1))


def _summary(over: OverTime) -> str:
    count = f"{over.count} value{'s' * (over.count != 1)} over the run"
    if not over.violation_count:
        return f"{count}, none beyond a limit"
    return f"{count}, {over.violation_count} beyond a limit"
