"""Estimate of cycles, by part and kind of operation, from a model's operation counts and a library's costs.

    {"gyroscope": {"mul": 15, ...}, ...} x costs --> Estimate --> total, by part, by kind, rest of a measured time

Included: the operations of the equations, loads and stores of their operands (assumed: one cycle a number, from
memory without wait states, nothing kept in registers). Not included: all else in the program, such as noise,
conversions between blocks, function prologues, interrupts.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from msgspec import Struct

from .costs import OPERANDS, Library, Tables

SYSCLK = 150_000_000  # Hz: the dissertation's board
MEASURED = Fraction(250, 1_000_000)  # seconds, section 5.4: GPIO high to low, code in RAM


class NoCost(ValueError):
    """An operation without a figure in a library; the message is one sentence."""


class Line(Struct, frozen=True):
    """One kind of operation in one part of the model. low, high: cycles of all of them; operands: in addition."""

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
        """Cycles of all operations with their operands, by the ranges' lower ends."""
        return sum(line.low + line.operands for line in self.lines)

    @property
    def high(self) -> int:
        return sum(line.high + line.operands for line in self.lines)

    @property
    def middle(self) -> Fraction:
        """Cycles half way between the ends, if a single number is needed."""
        return Fraction(self.low + self.high, 2)

    @property
    def guessed(self) -> bool:
        """True if a figure is a guess."""
        return any(self.library.costs[line.kind].guessed for line in self.lines)

    def seconds(self, sysclk: int = SYSCLK) -> Fraction:
        return self.middle / sysclk

    def part(self, name: str) -> tuple[int, int]:
        """Return the cycles of one part, low and high, with its operands."""
        own = [line for line in self.lines if line.part == name]
        return sum(line.low + line.operands for line in own), sum(line.high + line.operands for line in own)

    def kinds(self) -> dict[str, Line]:
        """Return one line for each kind, over all parts."""
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
        """Return the cycles of a measured time that the estimate does not explain, least and most."""
        cycles = round(measured * sysclk)
        return cycles - self.high, cycles - self.low


def estimate(counts: Mapping[str, Mapping[str, int]], library: Library, tables: Tables = "RAM") -> Estimate:
    """Estimate the cycles. counts: by part, then by kind. NoCost for a kind without a figure in the library."""
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
