"""Verdicts: the figures of one budget, and the word for what they prove.

Needs no other module, so that what only shows verdicts need not load what measures.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

Word = Literal["pass", "fail", "not judged"]

PASS: Final = "pass"
FAIL: Final = "fail"  # a limit is broken
NOT_JUDGED: Final = "not judged"  # no limit is broken, but too little was measured to say that all hold

Proof = Literal["", "every phase", "seen"]  # what a pass proves; empty where nobody asked

EVERY_PHASE: Final = "every phase"  # every limit has a bound, and holds for every phase
SEEN: Final = "seen"  # every limit holds in what was seen
BROKEN: Final = "broken"


@dataclass
class Verdict:
    """Figures of one budget after a run.

    worst, limit, margin: microseconds for times, percent for parts of the time, LSB of values, else plain counts. Of
    several limits the nearest one. at_s: when the worst was, seconds from the start. which: the limit's key; for a
    percentile `worst` is the value at it. found: what there is to say beyond figures, such as that nothing matched.
    measured, occasions: how many of all occasions were measured; occasions is None where the measure has none. bound:
    of `worst` in any phase, None where none is known; of a percentile the maximum's, if that keeps the limit. proof:
    of a budget that passes. unbounded: why it is not for every phase. until_s: of what `found` says is wrong, such as
    a reply, when that was over; it began at `at_s`.
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
    bound: float | int | None = None
    proof: Proof = ""
    unbounded: str = ""
    until_s: float | None = None

    @property
    def word(self) -> str:
        """What tables say: "every phase", "seen", "broken" or "not judged"."""
        if self.passed:
            return self.proof or SEEN
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
    def counted(self) -> str:
        """`count` as text; "3 of 500" where occasions were missed."""
        if self.occasions is None or self.measured >= self.occasions:
            return str(self.count)
        return f"{self.measured} of {self.occasions}"
