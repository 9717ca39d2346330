"""Timing diagrams as expected values.

There is one row per signal and one character per column of `column` cycles. `>` rows are
played into the rig; `<` rows are what the rig must show at the end of each column:

    > RXD     1 0 10101010 1 1
    < RXFFST  0 . ........ 1 .

0..f are levels or hexadecimal digits, `.` is "as before", blanks are ignored.
`play` returns the observed diagram, so that a test is the one line
`assert play(diagram, rig, BIT) == tidy(diagram)`, or `rig.check(diagram)`; its failure shows the two diagrams
with the differing columns marked (see conftest.py).
"""

from __future__ import annotations

from typing import Protocol, Self


class Rig(Protocol):
    """A chip with a few lines around it, into which a diagram is played."""

    def drive(self, now: int, signal: str, level: int) -> None: ...

    def run_until(self, time: int) -> None: ...

    def show(self, signal: str) -> int: ...


class Diagram(str):
    """A diagram; conftest.py shows two differing ones one above the other."""


def tidy(diagram: str) -> Diagram:
    return Diagram("\n".join(line.strip() for line in diagram.strip().splitlines()))


def play(diagram: str, rig: Rig, column: int, start: int = 0) -> Diagram:
    """Return the observed diagram; `start` is the time at which its first column begins."""
    lines = tidy(diagram).splitlines()
    rows = [line.split(maxsplit=2) for line in lines]
    assert all(way in "<>" for way, _, _ in rows), "a row begins with > (played in) or < (expected)"
    marks = [text.replace(" ", "") for _, _, text in rows]
    assert len({len(text) for text in marks}) == 1, f"rows of different length: {[len(t) for t in marks]}"
    came: list[list[str]] = [[] for _ in rows]
    last: dict[int, str] = {}
    for i in range(len(marks[0])):
        for (way, signal, _), text in zip(rows, marks, strict=True):
            if way == ">" and text[i] != ".":
                rig.drive(start + i * column, signal, int(text[i], 16))
        rig.run_until(start + (i + 1) * column - 1)
        for k, (way, signal, _) in enumerate(rows):
            if way == "<":
                mark = f"{rig.show(signal):x}"
                came[k].append("." if last.get(k) == mark else mark)
                last[k] = mark
    for k, (way, _, text) in enumerate(rows):
        if way == "<":
            shown = iter(came[k])
            lines[k] = lines[k].removesuffix(text) + "".join(c if c == " " else next(shown) for c in text)
    return Diagram("\n".join(lines))


class DiagramRig(Rig):
    """Base class of rigs into which many diagrams are played."""

    def columns(self) -> tuple[int, int]:
        """Return the cycles of a column, and the cycle in which the first one begins."""
        return 1, 0

    def check(self, diagram: str, column: int = 0, start: int | None = None) -> Self:
        """Fail unless the rig shows this diagram; return the rig. Defaults are those of `columns`."""
        usual, begin = self.columns()
        assert play(diagram, self, column or usual, begin if start is None else start) == tidy(diagram)
        return self
