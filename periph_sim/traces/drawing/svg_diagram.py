"""A timing diagram as SVG text, from lanes with edges and boxes, a window of time and marks.

    lanes --clip to window--> waves, boxes, ticks      capture  SCL  _/-\\_/-\\_
    marks ------------------> lines across all lanes   replay   SCL  _/-\\___/-
    window -----------------> axis with its unit                0   5   10 us

Times are seconds on a common axis. They are floats, because they are used only for drawing. Equal input gives equal
text. Readers can distinguish the colours side by side, in grey print, and with colour blindness.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, floor, log10

import drawsvg as svg

BLUE, ORANGE, GREY, BLACK = "#0060a8", "#c04a00", "#555555", "#111111"
PALE = {BLUE: "#dcebf7", ORANGE: "#fbe6d8", GREY: "#ececec", BLACK: "#f4f4f4"}
WRONG, WRONG_PALE = "#b00020", "#fbdde2"
GRID, RULE = "#e2e2e2", "#888888"

WIDTH, GUTTER, MARGIN = 1120, 132, 16
LANE, WAVE, GAP = 30, 18, 14  # heights of a lane, of its wave, and of the gap between groups
TITLE, LABELS, AXIS = 34, 18, 44
FONT, MONO = "Helvetica, Arial, sans-serif", "DejaVu Sans Mono, Menlo, Consolas, monospace"
UNITS = ((1e-9, "ns"), (1e-6, "us"), (1e-3, "ms"), (1.0, "s"))
CHARACTER = 6.3  # approximate width of a character in the labels, in pixels


@dataclass(frozen=True)
class Box:
    """A named interval in a lane.

    begin, end: times in seconds.
    wrong: True if the box is drawn as an error.
    """

    begin: float
    end: float
    text: str
    wrong: bool = False


@dataclass(frozen=True)
class Tick:
    """An instant in a lane with a label. at: the time in seconds. text: the label."""

    at: float
    text: str


@dataclass(frozen=True)
class Lane:
    """One line of the diagram. It can have a wave, boxes and ticks.

    group: the name of the group to which the lane belongs. The name is drawn above the first lane of the group.
    initial: the level of the wave before its first edge; None if the lane has no wave.
    edges: the edges of the wave, as pairs of a time and the level from this time on.
    """

    name: str
    group: str
    colour: str = BLACK
    initial: int | None = None
    edges: tuple[tuple[float, int], ...] = ()
    boxes: tuple[Box, ...] = ()
    ticks: tuple[Tick, ...] = ()


@dataclass(frozen=True)
class Mark:
    """A vertical line across all lanes.

    at: the time in seconds.
    wrong: True if the line marks a difference between two sides of a comparison.
    """

    at: float
    text: str
    wrong: bool = False


def timing_diagram(
    lanes: Sequence[Lane], window: tuple[float, float], marks: Sequence[Mark] = (), title: str = "", axis: str = ""
) -> str:
    """Return the diagram as SVG text.

    window: the first and the last time shown, in seconds.
    axis: the label of the axis, which says what time 0 is.

    Raise ValueError if the window is empty or there is no lane.
    """
    begin, end = window
    if not lanes or end <= begin:
        raise ValueError(f"a diagram of {len(lanes)} lanes from {begin} s to {end} s; expected a lane and a later end")
    return str(_Diagram(lanes, begin, end, marks, title, axis).page.as_svg())


class _Diagram:
    def __init__(
        self, lanes: Sequence[Lane], begin: float, end: float, marks: Sequence[Mark], title: str, axis: str
    ) -> None:
        self._begin, self._end = begin, end
        self._top = MARGIN + (TITLE if title else 0) + LABELS
        self._rows: list[tuple[Lane, float]] = []
        y: float = self._top
        for before, lane in pairwise([None, *lanes]):
            assert lane is not None
            if before is None or before.group != lane.group:
                y += GAP if before is None else GAP + 6
            self._rows.append((lane, y))
            y += LANE
        self._bottom = y
        self._height = y + AXIS
        self.page = svg.Drawing(WIDTH, self._height, font_family=FONT)
        self.page.append(svg.Rectangle(0, 0, WIDTH, self._height, fill="white"))
        if title:
            self._words(title, MARGIN, MARGIN + 14, 15, weight="bold")
        self._draw_axis(axis)
        for mark in marks:
            self._draw_band(mark)
        self._draw_groups()
        for lane, top in self._rows:
            self._draw_lane(lane, top)
        self._draw_marks(marks)

    # Coordinates, texts and lines --------------------------------------------------

    def _x(self, at: float) -> float:
        inside = WIDTH - GUTTER - MARGIN
        at = min(max(at, self._begin), self._end)
        return round(GUTTER + (at - self._begin) / (self._end - self._begin) * inside, 2)

    def _seen(self, at: float) -> bool:
        return self._begin <= at <= self._end

    def _words(
        self,
        text: str,
        x: float,
        y: float,
        size: float,
        *,
        anchor: str = "start",
        fill: str = BLACK,
        weight: str = "normal",
        family: str = FONT,
    ) -> None:
        self.page.append(
            svg.Text(text, size, x, y, text_anchor=anchor, fill=fill, font_weight=weight, font_family=family)
        )

    def _line(self, x1: float, y1: float, x2: float, y2: float, stroke: str, width: float, dash: str = "") -> None:
        more = {"stroke_dasharray": dash} if dash else {}
        self.page.append(svg.Line(x1, y1, x2, y2, stroke=stroke, stroke_width=width, **more))

    # Parts of the diagram ---------------------------------------------------------

    def _draw_axis(self, origin: str) -> None:
        step = nice_step(self._end - self._begin)
        scale, unit = next(((s, u) for s, u in reversed(UNITS) if step >= s * 0.999), UNITS[0])
        for number in range(ceil(self._begin / step - 1e-9), floor(self._end / step + 1e-9) + 1):
            x = self._x(number * step)
            self._line(x, self._top, x, self._bottom + 4, GRID, 1)
            self._words(f"{number * step / scale:g}", x, self._bottom + 18, 11, anchor="middle", fill=GREY)
        self._line(GUTTER, self._bottom + 4, WIDTH - MARGIN, self._bottom + 4, RULE, 1)
        self._words(f"{unit}{', ' if origin else ''}{origin}", WIDTH - MARGIN, self._bottom + 36, 11, anchor="end")

    def _draw_band(self, mark: Mark) -> None:
        if mark.wrong and self._seen(mark.at):
            x = self._x(mark.at)
            band = svg.Rectangle(x - 5, self._top, 10, self._bottom - self._top, fill=WRONG_PALE)
            self.page.append(band)

    def _draw_marks(self, marks: Sequence[Mark]) -> None:
        free = [float("-inf"), float("-inf")]  # for each of the two rows of labels, the x at the end of the last label
        for mark in sorted(marks, key=lambda one: one.at):
            if not self._seen(mark.at):
                continue
            x = self._x(mark.at)
            colour = WRONG if mark.wrong else RULE
            self._line(x, self._top, x, self._bottom + 4, colour, 1.6 if mark.wrong else 1, "" if mark.wrong else "4 3")
            half = len(mark.text) * CHARACTER / 2
            middle = min(max(x, GUTTER + half), WIDTH - MARGIN - half)
            row = next((row for row, taken in enumerate(free) if middle - half > taken), 1)
            free[row] = middle + half + 6
            weight = "bold" if mark.wrong else "normal"
            y = self._top - 4 - 13 * row
            self._words(mark.text, middle, y, 11, anchor="middle", fill=WRONG if mark.wrong else GREY, weight=weight)

    def _draw_groups(self) -> None:
        names = list(dict.fromkeys(lane.group for lane, _ in self._rows))
        for name in names:
            of = [(lane, top) for lane, top in self._rows if lane.group == name]
            first, last = of[0][1], of[-1][1] + LANE
            self._line(MARGIN - 6, first + 2, MARGIN - 6, last - 2, of[0][0].colour, 3)
            self._words(name, MARGIN, first - 1, 11, fill=of[0][0].colour, weight="bold")

    def _draw_lane(self, lane: Lane, top: float) -> None:
        low, high = top + 6 + WAVE, top + 6.0
        self._words(lane.name, GUTTER - 10, low - 4, 12, anchor="end", family=MONO)
        if lane.initial is not None:
            self._draw_wave(lane, low, high)
        for box in lane.boxes:
            self._draw_box(box, lane.colour, low, high)
        self._draw_ticks(lane, low, high)

    def _draw_wave(self, lane: Lane, low: float, high: float) -> None:
        level = lane.initial or 0
        inside = []
        for at, value in lane.edges:
            if at < self._begin:
                level = value
            elif at <= self._end:
                inside.append((at, value))
        place: Callable[[int], float] = lambda value: high if value else low  # noqa: E731
        self._line(GUTTER, low, WIDTH - MARGIN, low, GRID, 1)
        path = svg.Path(stroke=lane.colour, stroke_width=1.7, fill="none", stroke_linejoin="round")
        path.M(GUTTER, place(level))
        for at, value in inside:
            x = self._x(at)
            path.L(x, place(level)).L(x, place(value))
            level = value
        path.L(WIDTH - MARGIN, place(level))
        self.page.append(path)

    def _draw_box(self, box: Box, colour: str, low: float, high: float) -> None:
        if box.end < self._begin or box.begin > self._end:
            return
        x, right = self._x(box.begin), self._x(box.end)
        edge = WRONG if box.wrong else colour
        fill = WRONG_PALE if box.wrong else PALE.get(colour, "white")
        width = max(right - x, 1)
        self.page.append(
            svg.Rectangle(x, high, width, low - high, fill=fill, stroke=edge, stroke_width=2 if box.wrong else 1, rx=2)
        )
        long = len(box.text) * CHARACTER > width + 2
        text = box.text.partition(" ")[0] if long and box.wrong else box.text
        if len(text) * CHARACTER <= width + 2:
            weight = "bold" if box.wrong else "normal"
            self._words(text, x + width / 2, low - 5, 11, anchor="middle", fill=edge, weight=weight, family=MONO)

    def _draw_ticks(self, lane: Lane, low: float, high: float) -> None:
        taken = float("-inf")
        for tick in lane.ticks:
            if not self._seen(tick.at):
                continue
            x = self._x(tick.at)
            self._line(x, high, x, low, lane.colour, 1.4)
            width = len(tick.text) * CHARACTER + 4
            if x > taken and x + width < WIDTH - MARGIN:
                self._words(tick.text, x + 3, low - 5, 10.5, fill=lane.colour, family=MONO)
                taken = x + width
            else:
                taken = max(taken, x)


def nice_step(length: float, steps: int = 10) -> float:
    """Return the smallest step of 1, 2 or 5 times a power of ten that fits at most `steps` times into `length`."""
    least = length / steps
    power = 10.0 ** floor(log10(least))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= least * 0.999)
