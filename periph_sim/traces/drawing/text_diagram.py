"""A timing diagram as lines of text, from lanes, a window of time and marks.

    lanes --cut to window--> waves (two rows per lane), boxes (one row)     SCL   ┐ ┌─┐ ┌─┐
    marks -----------------> a row for each mark, with v above it               └─┘ └─┘ └
    window ----------------> axis with its unit                           bytes [-- 68 write --]

One column is one slice of the window. A column in which a wave has more than one edge is drawn as ░. `svg_diagram`
draws the same lanes as SVG. Equal input gives equal text.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor

from .svg_diagram import UNITS, Box, Lane, Mark, nice_step

GUTTER = 8  # minimum number of columns for the names of lanes
LEAST = 20  # minimum number of columns for waves
FAST = "░"
LEVEL = ("─", " "), (" ", "─")  # the characters of a low and of a high level, each as (lower row, upper row)
RISE, FALL = ("┘", "┌"), ("└", "┐")


def text_diagram(
    lanes: Sequence[Lane], window: tuple[float, float], marks: Sequence[Mark] = (), axis: str = "", width: int = 80
) -> list[str]:
    """Return the lines of the diagram, at most `width` characters long and without trailing spaces.

    Groups and colours of lanes are not shown.

    window: the first and the last time shown, in seconds.
    axis: the label of the axis, which says what time 0 is.

    Raise ValueError if there is no lane, the window is empty, or `width` leaves fewer than 20 columns for the waves.
    """
    begin, end = window
    gutter = max([GUTTER, *(len(lane.name) + 2 for lane in lanes)])
    if not lanes or end <= begin:
        raise ValueError(f"a diagram of {len(lanes)} lanes from {begin} s to {end} s; expected a lane and a later end")
    if width - gutter < LEAST:
        raise ValueError(f"a diagram {width} wide; expected {gutter + LEAST} or more for these lanes")
    slices = _Slices(begin, end, width - gutter)
    lines = [" " * gutter + row for row in _marks(marks, slices)]
    for lane in lanes:
        for number, row in enumerate(_lane(lane, slices)):
            lines.append(f"{'' if number else lane.name:{gutter}}{row}")
    lines += [" " * gutter + row for row in _axis(slices, axis)]
    return [line.rstrip() for line in lines]


class _Slices:
    """A window of time that is divided into columns."""

    def __init__(self, begin: float, end: float, count: int) -> None:
        self.begin, self.end, self.count = begin, end, count

    def column(self, at: float) -> int:
        """Return the column of a time. The result is below 0, or `count` or more, if the time is not in the window.

        A time that is before a column only because of a rounding error of floats is assigned to this column.
        """
        return floor((at - self.begin) / (self.end - self.begin) * self.count + 1e-6)

    def last(self, at: float) -> int:
        """Return the last column that begins before this time."""
        return ceil((at - self.begin) / (self.end - self.begin) * self.count - 1e-6) - 1


def _lane(lane: Lane, slices: _Slices) -> list[str]:
    rows: list[str] = []
    if lane.initial is not None:
        rows += _wave(lane.initial, lane.edges, slices)
    if lane.boxes:
        rows.append(_boxes(lane.boxes, slices))
    if lane.ticks:
        rows.append(_ticks([(tick.at, tick.text) for tick in lane.ticks], slices))
    return rows or [""]


def _wave(initial: int, edges: Sequence[tuple[float, int]], slices: _Slices) -> list[str]:
    """Return the upper and the lower row of a wave."""
    level = initial
    turns: dict[int, int] = {}  # for each column with edges, the number of its edges
    for at, value in edges:
        column = slices.column(at)
        if column < 0:
            level = value
        elif column < slices.count:
            turns[column] = turns.get(column, 0) + 1
    cells: list[tuple[str, str]] = []
    for column in range(slices.count):
        count = turns.get(column, 0)
        after = level ^ (count & 1)
        if count > 1:
            cells.append((FAST, FAST))
        else:
            cells.append((RISE if after else FALL) if count else LEVEL[level])
        level = after
    return ["".join(top for _, top in cells), "".join(bottom for bottom, _ in cells)]


def _boxes(boxes: Sequence[Box], slices: _Slices) -> str:
    """Draw each box as [-- text --], [text], the text, the first word of the text, or |||, whichever fits first.

    The text of a wrong box ends in !. A box is left out if earlier boxes occupy all its columns.
    """
    row = [" "] * slices.count
    taken = 0  # the first column that no earlier box occupies
    for box in sorted(boxes, key=lambda one: one.begin):
        if box.end <= slices.begin or box.begin >= slices.end:
            continue
        first = max(slices.column(box.begin), taken)
        last = min(max(slices.last(box.end), first), slices.count - 1)
        if first > last:
            continue
        row[first : last + 1] = _boxed(box.text, "!" * box.wrong, last - first + 1)
        taken = last + 1
    return "".join(row)


def _boxed(text: str, mark: str, width: int) -> str:
    text, short = text + mark, text.strip().partition(" ")[0] + mark
    if len(text) + 6 <= width:
        return f"[{f' {text} ':-^{width - 2}}]"
    if len(text) + 2 <= width:
        return f"[{text:^{width - 2}}]"
    if len(text) <= width:
        return f"{text:^{width}}"
    return f"{short:^{width}}" if len(short) <= width else "|" * width


def _ticks(ticks: Sequence[tuple[float, str]], slices: _Slices) -> str:
    """Draw each tick as |text. A text that would cover another tick or text, or not fit the row, is left out."""
    row = [" "] * slices.count
    places = [(slices.column(at), text) for at, text in ticks if 0 <= slices.column(at) < slices.count]
    for column, _ in places:
        row[column] = "|"
    for column, text in places:
        room = row[column + 1 : column + 1 + len(text)]
        if len(room) == len(text) and not any(cell.strip() for cell in room):
            row[column + 1 : column + 1 + len(text)] = text
    return "".join(row)


def _marks(marks: Sequence[Mark], slices: _Slices) -> list[str]:
    """Draw a row for each mark in the window, in order of time, with v above the instant."""
    rows = []
    for mark in sorted(marks, key=lambda one: one.at):
        column = slices.column(mark.at)
        if 0 <= column < slices.count:
            if column + 2 + len(mark.text) <= slices.count or column < slices.count // 2:
                rows.append((" " * column + f"v {mark.text}")[: slices.count])
            else:
                rows.append(f"{mark.text[: column - 1]:>{column - 1}} v")
    return rows


def _axis(slices: _Slices, origin: str) -> list[str]:
    step = nice_step(slices.end - slices.begin, 8)
    scale, unit = next(((s, u) for s, u in reversed(UNITS) if step >= s * 0.999), UNITS[0])
    rule, words = ["·"] * slices.count, [" "] * slices.count
    taken = 0
    for number in range(ceil(slices.begin / step - 1e-9), floor(slices.end / step + 1e-9) + 1):
        column = slices.column(number * step)
        text = f"{number * step / scale:g}"
        if 0 <= column < slices.count:
            rule[column] = "+"
            if column >= taken and column + len(text) <= slices.count:
                words[column : column + len(text)] = text
                taken = column + len(text) + 1
    return ["".join(rule), "".join(words), f"{unit}{', ' if origin else ''}{origin}"[: slices.count]]
