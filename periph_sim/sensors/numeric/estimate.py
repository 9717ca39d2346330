"""From operations to time: counts of a model's parts and a library's costs go in, cycles by part and kind come out.

    {"gyroscope": {"mul": 15, ...}, ...} x costs --> Estimate --> total, by part, by kind, rest of a measured time

What it has: the operations of the equations, loads and stores of their operands (assumed: one cycle a number, from
memory without wait states, nothing kept in registers). What it has not: whatever the program does besides, such as
noise, conversions between blocks, function prologues, interrupts.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from msgspec import Struct

from .costs import OPERANDS, Library, Tables

SYSCLK = 150_000_000  # Hz: the dissertation's board
MEASURED = Fraction(250, 1_000_000)  # seconds, section 5.4: GPIO high to low, code in RAM


class NoCost(ValueError):
    """An operation that a library has no figure for; one sentence."""


class Line(Struct, frozen=True):
    """One kind of operation in one part of the model. low, high: cycles of all of them, operands: on top."""

    part: str
    kind: str
    count: int
    low: int
    high: int
    operands: int


class Estimate(Struct, frozen=True):
    library: Library
    tables: Tables
    lines: tuple[Line, ...]

    @property
    def low(self) -> int:
        """Cycles of all operations with their operands, by the lower ends."""
        return sum(line.low + line.operands for line in self.lines)

    @property
    def high(self) -> int:
        return sum(line.high + line.operands for line in self.lines)

    @property
    def middle(self) -> Fraction:
        """Cycles half way between the ends: one number, where one is needed."""
        return Fraction(self.low + self.high, 2)

    @property
    def guessed(self) -> bool:
        """Some operation's figure is a guess."""
        return any(self.library.costs[line.kind].guessed for line in self.lines)

    def seconds(self, sysclk: int = SYSCLK) -> Fraction:
        return self.middle / sysclk

    def part(self, name: str) -> tuple[int, int]:
        """Cycles of one part, low and high, with its operands."""
        own = [line for line in self.lines if line.part == name]
        return sum(line.low + line.operands for line in own), sum(line.high + line.operands for line in own)

    def kinds(self) -> dict[str, Line]:
        """One line a kind, over all parts."""
        found: dict[str, Line] = {}
        for line in self.lines:
            so_far = found.get(line.kind, Line("", line.kind, 0, 0, 0, 0))
            found[line.kind] = Line(
                "",
                line.kind,
                so_far.count + line.count,
                so_far.low + line.low,
                so_far.high + line.high,
                so_far.operands + line.operands,
            )
        return found

    def left_of(self, measured: Fraction = MEASURED, sysclk: int = SYSCLK) -> tuple[int, int]:
        """Cycles of a measured time that the estimate does not explain, least and most."""
        cycles = round(measured * sysclk)
        return cycles - self.high, cycles - self.low


def estimate(counts: Mapping[str, Mapping[str, int]], library: Library, tables: Tables = "RAM") -> Estimate:
    """counts: by part, then by kind. NoCost for a kind that the library has no figure for."""
    lines = []
    for part, kinds in counts.items():
        for kind, count in sorted(kinds.items()):
            cost = library.costs.get(kind)
            if cost is None:
                raise NoCost(f"{library.name}: there is no cost for {kind!r}; it has {', '.join(library.costs)}")
            rom = library.rom.get(kind, 0) if tables == "boot ROM" else 0
            operands = 0 if kind in library.with_operands else count * OPERANDS[kind]
            lines.append(Line(part, kind, count, count * (cost.low + rom), count * (cost.high + rom), operands))
    return Estimate(library, tables, tuple(lines))
