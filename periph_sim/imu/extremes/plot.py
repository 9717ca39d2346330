"""Plot of a report of extremes as SVG: error in LSB over the cost of a sample in cycles, one point per arithmetic.

Both axes are logarithmic. If a cost is only known as a range, a bar shows the range. The error is the largest error of
the nine sensor axes in the working range. Equal reports give equal SVG text.
"""

from __future__ import annotations

from math import ceil, floor, log10

import drawsvg as svg

from . import ExtremesReport

WIDTH, HEIGHT = 900, 560
LEFT, RIGHT, TOP, BOTTOM = 90, 40, 60, 80
FONT = "Helvetica, Arial, sans-serif"
POINT, LINE, WORD, FOUNDED, GUESSED, GRID, INK = 5, 14, 110, "#0060a8", "#c04a00", "#e2e2e2", "#333333"
EXACT = 1e-5  # smaller errors, such as 0, are drawn at this number of LSB, because a logarithmic axis has no 0
MEASURED = 37_500  # the time that the dissertation measured for a sample, in cycles: 250 us at 150 MHz


def picture(report: ExtremesReport) -> str:
    """Return a plot of error over cycles, with one point for each arithmetic of the report, as SVG text."""
    points = []
    for name in report.names:
        cost, worst = report.costs[name], report.errors.get(name)
        points.append((name, cost.low, cost.high, max(worst.largest if worst else 0.0, EXACT), cost.guessed))
    cycles = [end for _, low, high, _, _ in points for end in (low, high)] + [MEASURED]
    x_axis = _Axis(min(cycles), max(cycles), LEFT, WIDTH - RIGHT)
    y_axis = _Axis(EXACT, max(point[3] for point in points), HEIGHT - BOTTOM, TOP)
    page = svg.Drawing(WIDTH, HEIGHT, id_prefix="trade")
    page.append(svg.Rectangle(0, 0, WIDTH, HEIGHT, fill="white"))
    page.append(_words("Error against cycles of one sample of nine axes", WIDTH / 2, 28, size=16, anchor="middle"))
    _draw_grid(page, x_axis, y_axis)
    at = x_axis.place(MEASURED)
    page.append(svg.Line(at, TOP, at, HEIGHT - BOTTOM, stroke=INK, stroke_dasharray="4 3"))
    page.append(_words("measured: 250 us", at - 6, TOP + 14, anchor="end"))
    taken: list[tuple[float, float]] = []  # positions (x, y) of the labels so far
    for name, low, high, error, guessed in points:
        x, y = x_axis.place((low * high) ** 0.5), y_axis.place(error)
        colour = GUESSED if guessed else FOUNDED
        page.append(svg.Line(x_axis.place(low), y, x_axis.place(high), y, stroke=colour, stroke_width=3))
        page.append(svg.Circle(x, y, POINT, fill=colour))
        words = y - 6
        while any(abs(words - row) < LINE and abs(x - column) < WORD for column, row in taken):
            words += LINE
        taken.append((x, words))
        page.append(_words(name, x + 6, words, fill=colour))
    text: str | None = page.as_svg()
    assert text is not None
    return text


class _Axis:
    """A logarithmic axis from `begin` to `end`: whole powers of ten, at least two, that include `low` and `high`."""

    def __init__(self, low: float, high: float, begin: float, end: float) -> None:
        first = floor(log10(low))
        self.powers = range(first, max(ceil(log10(high)), first + 1) + 1)
        self._begin, self._end = begin, end

    def place(self, value: float) -> float:
        part = (log10(value) - self.powers[0]) / (self.powers[-1] - self.powers[0])
        return round(self._begin + part * (self._end - self._begin), 2)


def _draw_grid(page: svg.Drawing, x_axis: _Axis, y_axis: _Axis) -> None:
    for power in x_axis.powers:
        x = x_axis.place(10.0**power)
        page.append(svg.Line(x, TOP, x, HEIGHT - BOTTOM, stroke=GRID))
        page.append(_words(f"{10**power}", x, HEIGHT - BOTTOM + 18, anchor="middle"))
    for power in y_axis.powers:
        y = y_axis.place(10.0**power)
        page.append(svg.Line(LEFT, y, WIDTH - RIGHT, y, stroke=GRID))
        label = "exact" if power == y_axis.powers[0] else f"{10.0**power:g}"
        page.append(_words(label, LEFT - 8, y + 4, anchor="end"))
    page.append(_words("SYSCLKOUT cycles (estimated; orange: by a guess)", WIDTH / 2, HEIGHT - 30, anchor="middle"))
    page.append(_words("LSB, worst axis", LEFT - 8, TOP - 14))


def _words(text: str, x: float, y: float, size: float = 12, anchor: str = "start", fill: str = INK) -> svg.Text:
    return svg.Text(text, size, x, y, text_anchor=anchor, font_family=FONT, fill=fill)
