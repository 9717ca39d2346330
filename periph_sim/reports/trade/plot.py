"""The trade as a picture: a `Trade` goes in, SVG text of CPU time against worst error comes out.

    error  inf |      x refused levels are not drawn
    cycles     |   o           o
         exact |_______o____________
                  CPU seconds a simulated second

Both axes are logarithmic; an error of 0 has a line of its own below, an infinite one above.
"""

from __future__ import annotations

from math import ceil, floor, inf, log10

import drawsvg as svg

from .trade import Trade

WIDTH, HEIGHT = 760, 460
LEFT, RIGHT, TOP, BOTTOM = 90, 60, 60, 70
FONT = "Helvetica, Arial, sans-serif"
POINT, LINE, WORD, COLOUR, GRID, INK = 5, 14, 120, "#0060a8", "#e2e2e2", "#333333"


def picture(found: Trade) -> str:
    """SVG text; equal trades give equal text."""
    points = [
        (outcome.level.name, outcome.cost.cpu_per_second, 0.0 if outcome is found.reference else outcome.worst)
        for outcome in found.outcomes
        if outcome.cost is not None and outcome.cost.cpu_per_second > 0
    ]
    across = _Decades([cpu for _, cpu, _ in points], LEFT, WIDTH - RIGHT)
    up = _Decades([error for _, _, error in points if 0 < error < inf], HEIGHT - BOTTOM, TOP, room=1)
    page = svg.Drawing(WIDTH, HEIGHT, id_prefix="trade")
    page.append(svg.Rectangle(0, 0, WIDTH, HEIGHT, fill="white"))
    page.append(_words(f"{found.case}: worst error against CPU time", WIDTH / 2, 28, size=16, anchor="middle"))
    for power in across.powers:
        x = across.place(10.0**power)
        page.append(svg.Line(x, TOP, x, HEIGHT - BOTTOM, stroke=GRID))
        page.append(_words(f"{10.0**power:g}", x, HEIGHT - BOTTOM + 18, anchor="middle"))
    rows = [(10.0**power, f"{10.0**power:g}") for power in up.powers]
    for value, label in [(0.0, "exact"), *rows, (inf, "infinite")]:
        y = up.place(value)
        page.append(svg.Line(LEFT, y, WIDTH - RIGHT, y, stroke=GRID))
        page.append(_words(label, LEFT - 8, y + 4, anchor="end"))
    page.append(_words("CPU seconds a simulated second", WIDTH / 2, HEIGHT - 24, anchor="middle"))
    page.append(_words("SYSCLKOUT cycles, worst observable", LEFT - 8, TOP - 14))
    taken: list[tuple[float, float]] = []  # where words stand
    for name, cpu, error in points:
        x, y = across.place(cpu), up.place(error)
        page.append(svg.Circle(x, y, POINT, fill=COLOUR))
        words = y - 6
        while any(abs(words - row) < LINE and abs(x - column) < WORD for column, row in taken):
            words += LINE
        taken.append((x, words))
        right = x > WIDTH - RIGHT - WORD
        page.append(_words(name, x - 8 if right else x + 8, words, fill=COLOUR, anchor="end" if right else "start"))
    text: str | None = page.as_svg()
    assert text is not None
    return text


class _Decades:
    """Whole powers of ten around some values, between two places on paper. room: decades kept for 0 and infinity."""

    def __init__(self, values: list[float], begin: float, end: float, room: int = 0) -> None:
        known = values or [1.0]
        low, high = floor(log10(min(known))), ceil(log10(max(known)))
        self.powers = range(low, max(high, low + 1) + 1)
        self._begin, self._end, self._room = begin, end, room

    def place(self, value: float) -> float:
        least, most = self.powers[0] - self._room, self.powers[-1] + self._room
        power = least if value == 0 else most if value == inf else log10(value)
        return round(self._begin + (self._end - self._begin) * (power - least) / (most - least), 2)


def _words(text: str, x: float, y: float, *, size: int = 12, fill: str = INK, anchor: str = "start") -> svg.Text:
    return svg.Text(text, size, x, y, fill=fill, font_family=FONT, text_anchor=anchor)
