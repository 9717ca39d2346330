"""Verdicts: the figures of one budget, and the word that tables have for them.

Needs no other module, so that what only shows verdicts need not load what measures.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

Word = Literal["pass", "fail", "not judged"]

PASS: Final = "pass"
FAIL: Final = "fail"  # a limit is broken
NOT_JUDGED: Final = "not judged"  # no limit is broken, but too little was measured to say that all hold

SEEN: Final = "seen"  # the word for a pass: every limit held in this run
BROKEN: Final = "broken"

NOTHING_PROVEN: Final = "nothing is proven yet: a verdict holds for the run that was made, and for no other timing"


@dataclass
class Verdict:
    """Figures of one budget after a run.

    worst, limit, margin: microseconds for times, percent for parts of the time, LSB of values, else plain counts. Of
    several limits the nearest one. at_s: when the worst was, seconds from the start. which: the limit's key; for a
    percentile `worst` is the value at it. found: what there is to say beyond figures, such as that nothing matched.
    measured, occasions: how many of all occasions were measured; occasions is None where the measure has none.
    until_s: of what `found` says is wrong, such as a reply, when that was over; it began at `at_s`.
    """

    name: str
    measure: str
    unit: str
    worst: float | int | None
    limit: float | int
    margin: float | int | None
    count: int
    verdict: Word
    at_s: float | None
    why: str = ""
    which: str = "max"
    found: str = ""
    measured: int = 0
    occasions: int | None = None
    until_s: float | None = None

    @property
    def word(self) -> str:
        """The word in tables: "seen", "broken" or "not judged"."""
        if self.passed:
            return SEEN
        return BROKEN if self.broken else NOT_JUDGED

    @property
    def passed(self) -> bool:
        """True if every limit holds and enough was measured to say so."""
        return self.verdict == PASS

    @property
    def broken(self) -> bool:
        """True if a limit is broken."""
        return self.verdict == FAIL

    @property
    def too_little(self) -> bool:
        """True if `worst` is critical for being small: it is held against a `min`, or below an `exactly`."""
        return self.which == "min" or (self.which == "exactly" and self.worst is not None and self.worst < self.limit)

    @property
    def within(self) -> bool:
        """True if `worst` keeps the limit."""
        if self.worst is None:
            return False
        if self.which == "exactly":
            return self.worst == self.limit
        return self.worst >= self.limit if self.which == "min" else self.worst <= self.limit

    @property
    def counted(self) -> str:
        """`count` as text; "3 of 500" where occasions were missed."""
        if self.occasions is None or self.measured >= self.occasions:
            return str(self.count)
        return f"{self.measured} of {self.occasions}"
