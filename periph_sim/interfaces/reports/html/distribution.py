"""The distribution of a budget's values, and its plot.

All bins have the same width and begin at whole multiples of this width. So the bins of two runs coincide if both have
the same width.

    counts   |    _        :            :
    (log)    |  _| |_      :      //    :
             |_|_____|_____v______//____:__
              least ... worst         a distant limit, after a break of the axis

Counts are drawn on a logarithmic scale, so a single outlier is visible.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil, floor, log10

import numpy as np

from ....core.phrases import counted
from ....timing.budgets import Values
from ....timing.measures.measure import MILLIONTHS
from ....traces.drawing.svg_diagram import nice_step

MOST = 60  # maximum number of bins
SHOWN = (("median", 500), ("p95", 950), ("p99", 990))
UNITS = (("ns", 1), ("us", 10**3), ("ms", 10**6), ("s", 10**9))


@dataclass(frozen=True)
class Bin:
    """The values from `begin` up to, but not including, `end`."""

    begin: float
    end: float
    count: int


@dataclass(frozen=True)
class Distribution:
    """The distribution of the values of a budget.

    unit: the unit of all numbers, which depends on the size of the values.
    counted: True if the values are whole numbers of the unit, so that a bin of width 1 contains one distinct value.
    least, worst: the smallest and the largest value.
    limits: key and value of each limit.
    quantiles: name and value (nearest rank) of each quantile.
    """

    unit: str
    counted: bool
    bins: tuple[Bin, ...]
    least: float
    worst: float
    limits: tuple[tuple[str, float], ...]
    quantiles: tuple[tuple[str, float], ...]

    @property
    def count(self) -> int:
        return sum(one.count for one in self.bins)


def distribution(values: Values, per_ns: int) -> Distribution:
    """Return the distribution of the values of a budget. per_ns: the number of ticks per nanosecond."""
    data = np.sort(values.values)
    least, worst = int(data[0]), int(data[-1])
    unit, size, grain = scale_of(values.unit, max(abs(least), abs(worst)), per_ns)
    grains = (worst - least) / grain
    width = grain * max(1, round(nice_step(grains, MOST - 1))) if grains > 1 else grain  # results in at most MOST bins
    first = least // width
    places, counts = np.unique(data // width - first, return_counts=True)
    return Distribution(
        unit=unit,
        counted=size == 1,
        bins=tuple(
            Bin((first + place) * width / size, (first + place + 1) * width / size, count)
            for place, count in zip(places.tolist(), counts.tolist(), strict=True)
        ),
        least=least / size,
        worst=worst / size,
        limits=tuple((key, limit / size) for key, limit in values.limits.items()),
        quantiles=tuple((name, int(data[-(-per * len(data) // 1000) - 1]) / size) for name, per in SHOWN),
    )


def scale_of(unit: str, largest: int, per_ns: int) -> tuple[str, int, int]:
    """Return (name, size, width) for the unit in which values are shown.

    name: the name of this unit. For a time, it is the first of UNITS in which the largest value is below
        1000, or else the last of them.
    size: the size of this unit in the unit of the recorded values, such as ticks.
    width: the minimum width of a bin in the unit of the recorded values.
    """
    if unit == "time":
        name, ns = next((one for one in UNITS if largest < 1000 * one[1] * per_ns), UNITS[-1])
        return name, ns * per_ns, per_ns
    if unit == "LSB":
        return unit, MILLIONTHS, MILLIONTHS // 1000
    return "" if unit == "value" else unit, 1, 1


WIDTH, HEIGHT = 560, 244
LEFT, RIGHT, TOP, BOTTOM = 46, 18, 58, 40
# The size of the drawing, and the edges of the box that the axes enclose.
PAPER = {
    "width": WIDTH,
    "height": HEIGHT,
    "left": LEFT,
    "right": WIDTH - RIGHT,
    "top": TOP,
    "bottom": HEIGHT - BOTTOM,
}
BREAK = 78  # width of the part of the axis after a break, in units of the drawing
REACH = 1.5  # a limit is on scale if its distance from the values is at most this multiple of the values' range
ROWS = 2  # number of rows for the texts of limits
CHARACTER = 6.6  # width of a character, in units of the drawing
LEAST = 24  # minimum number of bins of the axis, so that a single value is a narrow bar


@dataclass(frozen=True)
class Bar:
    x: float
    y: float
    width: float
    height: float
    says: str


@dataclass(frozen=True)
class Rule:
    """A vertical line with a text above it.

    anchor: the alignment of the text at the line: start, middle or end.
    row: the number of the text's row; 0 is the lowest row.
    """

    x: float
    text: str
    anchor: str
    row: int = 0


@dataclass(frozen=True)
class Plot:
    """Layout of the plot, in units of the drawing.

    limits, worst: the lines of the limits and of the worst value.
    across, up: position and text of each label of the horizontal and of the vertical axis.
    breaks: the positions of breaks of the horizontal axis.
    summary: a text for screen readers.
    """

    bars: tuple[Bar, ...]
    limits: tuple[Rule, ...]
    worst: Rule
    across: tuple[tuple[float, str], ...]
    up: tuple[tuple[float, str], ...]
    breaks: tuple[float, ...]
    unit: str
    summary: str


def plot(spread: Distribution, least_is_worst: bool = False) -> Plot:
    """Lay out the plot of a distribution.

    least_is_worst: True if the nearest limit is a `min`. Then the smallest value is marked, otherwise the largest.
    """
    scale = _Scale(spread)
    bottom = PAPER["bottom"]
    most = max(max(one.count for one in spread.bins), 9)

    def rise(count: int) -> float:
        return round((bottom - TOP) * log10(1 + count) / log10(1 + most), 2)

    between = f" from {number(spread.least)} to {number(spread.worst)}"
    if spread.least == spread.worst:
        between = f", {'all ' * (spread.count > 1)}{number(spread.worst)}"
    # Grid lines are at powers of ten and, if there is room, at 2 and 5 times the powers of ten.
    counts = [f * 10**n for n in range(floor(log10(most)) + 1) for f in ((1, 2, 5) if most < 100 else (1,))]
    marked = spread.least if least_is_worst else spread.worst
    return Plot(
        bars=tuple(scale.bar(one, bottom, rise(one.count)) for one in spread.bins),
        limits=_rules(spread, scale),
        worst=_rule(scale.place(marked), _with_unit("least" if least_is_worst else "worst", marked, spread.unit)),
        across=scale.across(),
        up=tuple((bottom - rise(count), f"{count}") for count in counts if count <= most),
        breaks=scale.breaks,
        unit=spread.unit,
        summary=f"{counted(spread.count, 'value')}{between} {spread.unit}".rstrip(),
    )


class _Scale:
    """The horizontal scale of the plot, which converts values to positions in the drawing."""

    def __init__(self, spread: Distribution) -> None:
        self._spread = spread
        self._shift = 0.5 if spread.counted else 0.0  # the bin of a whole count is centred on this count
        low, high = spread.bins[0].begin - self._shift, spread.bins[-1].end - self._shift
        lacking = LEAST * (spread.bins[0].end - spread.bins[0].begin) - (high - low)
        if lacking > 0:
            low, high = low - lacking / 2, high + lacking / 2
        near = [v for _, v in spread.limits if low - REACH * (high - low) <= v <= high + REACH * (high - low)]
        begin, end = min([low, *near]), max([high, *near])
        room = 0.04 * (end - begin)
        self.begin = begin - room if spread.least < 0 else max(begin - room, -self._shift)
        self.end = end + room
        under = any(value < self.begin for _, value in spread.limits)
        over = any(value > self.end for _, value in spread.limits)
        self._left, self._right = LEFT + BREAK * under, WIDTH - RIGHT - BREAK * over
        self.breaks = (
            *((LEFT + 2 * BREAK / 3,) if under else ()),
            *((WIDTH - RIGHT - 2 * BREAK / 3,) if over else ()),
        )

    def place(self, value: float) -> float:
        """Return the x position of a value. A value that is off scale is beyond the break of the axis."""
        if value < self.begin:
            return LEFT + BREAK / 3
        if value > self.end:
            return WIDTH - RIGHT - BREAK / 3
        return round(self._left + (self._right - self._left) * (value - self.begin) / (self.end - self.begin), 2)

    def bar(self, one: Bin, bottom: float, height: float) -> Bar:
        x, right = self.place(one.begin - self._shift), self.place(one.end - self._shift)
        alone = self._spread.counted and one.end - one.begin == 1
        values = number(one.begin) if alone else f"{number(one.begin)} to {number(one.end)}"
        says = f"{values} {self._spread.unit}".rstrip() + f": {counted(one.count, 'value')}"
        return Bar(x, round(bottom - height, 2), max(round(right - x - 0.6, 2), 1), height, says)

    def across(self) -> tuple[tuple[float, str], ...]:
        step = nice_step(self.end - self.begin, 5 if self.breaks else 6)
        step = max(step, 1) if self._spread.counted else step
        return axis_ticks(self.begin, self.end, step, self.place)


def axis_ticks(
    begin: float, end: float, step: float, place: Callable[[float], float], unit: str = ""
) -> tuple[tuple[float, str], ...]:
    """Return position and text of each multiple of a step on an axis. place: a function from values to positions."""
    first, last = ceil(begin / step - 1e-9), floor(end / step + 1e-9)
    return tuple((place(n * step), f"{number(n * step, step)} {unit}".rstrip()) for n in range(first, last + 1))


def _rules(spread: Distribution, scale: _Scale) -> tuple[Rule, ...]:
    """Return the lines of the limits from left to right. Texts that would overlap are in different rows (of ROWS)."""
    rules: list[Rule] = []
    free = [float("-inf")] * ROWS
    for key, value in sorted(spread.limits, key=lambda one: one[1]):
        rule = _rule(scale.place(value), _with_unit(key.replace("_", "."), value, spread.unit))
        long = CHARACTER * len(rule.text)
        begin = rule.x - {"start": 0, "middle": long / 2, "end": long}[rule.anchor]
        row = next((row for row in range(ROWS) if free[row] < begin), ROWS - 1)
        free[row] = begin + long + 4
        rules.append(replace(rule, row=row))
    return tuple(rules)


def _with_unit(name: str, value: float, unit: str) -> str:
    return f"{name} {number(value)} {unit}".rstrip()


def number(value: float, step: float | None = None) -> str:
    """Format a number with up to three decimals. step: if given, use as many decimals as this step of an axis needs."""
    decimals = 3 if step is None else max(0, -floor(log10(step) + 1e-9))
    text = f"{value:.{decimals}f}"
    text = text.rstrip("0").rstrip(".") if "." in text and step is None else text
    return "0" if text in ("-0", "") else text


def _rule(x: float, text: str) -> Rule:
    half = CHARACTER * len(text) / 2
    anchor = "start" if x - half < LEFT else "end" if x + half > WIDTH - RIGHT else "middle"
    return Rule(x, text, anchor)
