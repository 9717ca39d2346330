"""The verdict on one trace, from its rows of limits: pass, fail or undecidable, a text, or an AssertionError."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from .limits import Mode
from .resolution import Resolution
from .text_report import failure, table
from .verdict import Row, Verdict


@dataclass(frozen=True)
class Report:
    """The verdict on one trace. shared: positions at which both lines change. notes: a sentence each."""

    name: str
    mode: Mode
    resolution: Resolution
    rows: tuple[Row, ...]
    starts: int
    shared: int
    notes: tuple[str, ...] = ()

    @property
    def verdict(self) -> Verdict:
        """NOT_JUDGED if no time was measured, FAIL if any row fails, else UNDECIDABLE if any is, else PASS."""
        found = {row.verdict for row in self.rows}
        judged = {row.verdict for row in self.rows if row.count}
        if not judged & {Verdict.PASS, Verdict.FAIL, Verdict.UNDECIDABLE}:
            return Verdict.NOT_JUDGED
        if Verdict.FAIL in found:
            return Verdict.FAIL
        return Verdict.UNDECIDABLE if Verdict.UNDECIDABLE in found else Verdict.PASS

    def row(self, symbol: str) -> Row:
        """Return the row of a limit. KeyError if there is no such limit."""
        for row in self.rows:
            if row.limit.symbol == symbol:
                return row
        raise KeyError(f"there is no limit {symbol!r}; there are {', '.join(row.limit.symbol for row in self.rows)}")

    def symbols_with(self, verdict: Verdict) -> list[str]:
        """Return the symbols that have this verdict."""
        return [row.limit.symbol for row in self.rows if row.verdict is verdict]

    def assert_compliant(self, strict: bool = False) -> None:
        """AssertionError with the worst rows if a limit is broken, or undecidable if strict, or none was measured."""
        if self.verdict is Verdict.NOT_JUDGED:
            raise AssertionError(f"{self.name}: no time of the I2C limits was measured; the trace has no whole bit")
        if self.verdict is Verdict.FAIL or (strict and self.verdict is Verdict.UNDECIDABLE):
            raise AssertionError(failure(self, strict))

    def seconds(self, position: int) -> Fraction:
        return position / self.resolution.rate

    def __str__(self) -> str:
        return table(self)
