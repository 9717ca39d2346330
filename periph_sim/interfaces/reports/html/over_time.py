"""The values of a budget over the run, reduced to the resolution of a screen, and their plot.

5.1 us |- - - - - - - - - - - -  max      each column is a dot or a stroke from the least to the greatest value of its
       |  .  .  | .  .   . |              part of the run, so a single outlier is visible; limits are horizontal lines;
   0 us |__________________________       values beyond a limit are drawn a second time on top
       0 s         5 s         10 s

Up to MOST values beyond a limit are stored with their instants. The field is the plot area, which the axes enclose.
Positions are in percent of the field, so they fit pages of any width.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....core.phrases import counted
from ....timing.budgets import Values
from ....timing.verdict import Verdict
from ....traces.drawing.svg_diagram import nice_step
from .distribution import axis_ticks, number, scale_of

COLUMNS = 240
MOST = 2_000  # maximum number of violations that are kept with their instants
SHOWN = 6  # number of violations that get a timeline in addition to the worst violation
PARTS = SHOWN - SHOWN // 2


@dataclass(frozen=True)
class Column:
    """The values in one part of the run, or a single value.

    at: the middle of the part, or the instant of the value, in ticks from the start of the run.
    low, high: the least and the greatest value.
    beyond: True if at least one value is beyond a limit.
    """

    at: int
    low: int
    high: int
    beyond: bool = False


@dataclass(frozen=True)
class OverTime:
    """The values of a budget over the run, in the unit of `Values`.

    end: the end of the run, in ticks from the start of the run.
    limits: key and value of each limit.
    which: the key of the limit that the verdict names.
    violations: instant and value of the first MOST violations (values beyond a limit), in order of time.
    violation_count: the number of all violations.
    count: the number of all values.
    """

    unit: str
    end: int
    columns: tuple[Column, ...]
    limits: tuple[tuple[str, int], ...]
    which: str
    violations: tuple[tuple[int, int], ...]
    violation_count: int
    count: int


def over_time(values: Values, verdict: Verdict, end: int) -> OverTime:
    """Return the values of a budget over time. end: the end of the run, in ticks from the start of the run."""
    order = np.argsort(values.at, kind="stable")
    at, data = values.at[order], values.values[order]
    beyond = _beyond(data, verdict, values.limits)
    wrong = np.flatnonzero(beyond)
    return OverTime(
        unit=values.unit,
        end=end,
        columns=tuple(_columns(at, data, beyond, end)),
        limits=tuple(values.limits.items()),
        which=verdict.which,
        violations=tuple((int(at[n]), int(data[n])) for n in wrong[:MOST]),
        violation_count=len(wrong),
        count=len(data),
    )


def _beyond(data: NDArray[np.int64], verdict: Verdict, limits: Mapping[str, int]) -> NDArray[np.bool_]:
    """Return an array with True for each value beyond a limit.

    The limit of a percentile counts only if the verdict names this limit as broken.
    """
    found = np.zeros(len(data), bool)
    for key, limit in limits.items():
        if key == "min":
            found |= data < limit
        elif key == "exactly":
            found |= data != limit
        elif key == "max" or (verdict.broken and key == verdict.which):
            found |= data > limit
    return found


def _columns(at: NDArray[np.int64], data: NDArray[np.int64], beyond: NDArray[np.bool_], end: int) -> list[Column]:
    if len(at) <= COLUMNS:
        return [Column(t, v, v, b) for t, v, b in zip(at.tolist(), data.tolist(), beyond.tolist(), strict=True)]
    of = np.minimum(at * COLUMNS // max(end, 1), COLUMNS - 1)
    firsts = np.flatnonzero(np.diff(of, prepend=-1))
    low, high = np.minimum.reduceat(data, firsts), np.maximum.reduceat(data, firsts)
    some = np.logical_or.reduceat(beyond, firsts)
    middles = (2 * of[firsts] + 1) * end // (2 * COLUMNS)
    found = zip(middles.tolist(), low.tolist(), high.tolist(), some.tolist(), strict=True)
    return [Column(*one) for one in found]


def shown_violations(over: OverTime, worst_at: int) -> tuple[tuple[int, int], ...]:
    """Return the violations that get a timeline in addition to the worst violation, in order of time.

    These are the first SHOWN // 2 violations of the run, and some later ones: the later violations are divided, in
    order of time, into PARTS equal parts, and the violation with the largest value of each part is taken (for a `min`,
    with the smallest).
    """
    others = [one for one in over.violations if one[0] != worst_at]
    first, rest = others[: SHOWN // 2], others[SHOWN // 2 :]
    parts = [rest[n * len(rest) // PARTS : (n + 1) * len(rest) // PARTS] for n in range(PARTS)]
    pick = min if over.which == "min" else max
    return (*first, *(pick(part, key=lambda one: one[1]) for part in parts if part))


FIELD_WIDTH = 1000  # width of the field (the plot area) in the units of the SVG paths
# A limit is drawn if its distance from the range of the values is at most NEAR times the width of this range. If all
# values are equal, it is drawn if its distance from them is at most NEAR times their absolute value.
NEAR = 1.5
ROOM = 0.08  # margin above and below the values and the drawn limits, as a fraction of their range


@dataclass(frozen=True)
class Line:
    """A limit as a line across the field.

    y: the position in percent from the top; None if the limit is off scale.
    above: if the limit is off scale, True if it is above the field.
    """

    text: str
    y: float | None
    above: bool = True


@dataclass(frozen=True)
class TimePlot:
    """The layout of a plot.

    up, across: the labels of the axes as positions in percent and texts.
    lines: the limits.
    values, broken: SVG paths of all values, and of the values beyond a limit.
    summary: a text for screen readers.
    """

    up: tuple[tuple[float, str], ...]
    across: tuple[tuple[float, str], ...]
    lines: tuple[Line, ...]
    values: str
    broken: str
    summary: str


def shown_unit(over: OverTime, per_second: int) -> tuple[str, int]:
    """Return the unit in which values are shown, and its size in the unit of the stored values, such as ticks."""
    largest = max(max(abs(c.low), abs(c.high)) for c in over.columns)
    return scale_of(over.unit, largest, per_second // 10**9)[:2]


def time_plot(over: OverTime, per_second: int) -> TimePlot:
    """Lay out the plot. per_second: the number of ticks per second."""
    unit, size = shown_unit(over, per_second)
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
        return round(FIELD_WIDTH * at / max(over.end, 1), 1)

    def line(name: str, value: int) -> Line:
        inside = begin <= value <= end
        return Line(f"{name} {number(value / size)} {unit}".rstrip(), y(value) if inside else None, value > end)

    strokes = (f"M{x(c.at):g} {y(c.high):g}v{round(y(c.low) - y(c.high), 1):g}" for c in over.columns)
    marks = (f"M{x(c.at):g} {y(c.low if over.which == 'min' else c.high):g}v0" for c in over.columns if c.beyond)
    across = nice_step(over.end / per_second, 8) if over.end else 1.0
    return TimePlot(
        up=axis_ticks(begin / size, end / size, nice_step((end - begin) / size, 3), lambda v: y(v * size), unit),
        across=axis_ticks(
            0, over.end / per_second, across, lambda s: round(100 * s * per_second / max(over.end, 1), 2), "s"
        ),
        lines=tuple(line(*one) for one in lines),
        values="".join(dict.fromkeys(strokes)),
        broken="".join(marks),
        summary=f"{counted(over.count, 'value')} over the run, {over.violation_count or 'none'} beyond a limit",
    )
