"""Timing diagrams as expected values.

One row a signal, one character a column, `column` cycles a column. `>` rows are
played into the rig; `<` rows are what it must show at the end of each column:

    > RXD     1 0 10101010 1 1
    < RXFFST  0 . ........ 1 .

0..f are levels or hexadecimal digits, `.` is "as before", blanks are for the eye.
`play` hands back the diagram as it came out, so that a test is the one line
`assert play(diagram, rig, BIT) == tidy(diagram)`, or `rig.check(diagram)`; its failure shows the two diagrams,
the columns that differ marked (see conftest.py).
"""

from __future__ import annotations

from typing import Protocol, Self


class Rig(Protocol):
    """What a diagram is played into: a bare chip and a few lines around it."""

    def drive(self, now: int, signal: str, level: int) -> None: ...

    def run_until(self, time: int) -> None: ...

    def show(self, signal: str) -> int: ...


class Diagram(str):
    """A diagram; conftest.py shows two that differ one above the other."""


def tidy(diagram: str) -> Diagram:
    return Diagram("\n".join(line.strip() for line in diagram.strip().splitlines()))


def play(diagram: str, rig: Rig, column: int, start: int = 0) -> Diagram:
    """The diagram as the rig showed it; `start` is the time at which its first column begins."""
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
    """Base of rigs into which many diagrams are played."""

    def columns(self) -> tuple[int, int]:
        """Return the cycles of a column, and the cycle in which the first one begins."""
        return 1, 0

    def check(self, diagram: str, column: int = 0, start: int | None = None) -> Self:
        """Fail unless the rig shows this diagram; return the rig. column, start: as `columns` says if not given."""
        usual, begin = self.columns()
        assert play(diagram, self, column or usual, begin if start is None else start) == tidy(diagram)
        return self
