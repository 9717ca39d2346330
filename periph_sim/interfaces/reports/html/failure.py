"""The failure of a budget in sentences: the broken limit and its cause.

response is broken: 97.953 us, at most 50.000 us allowed (47.953 us too much), at 0.105195 s.
3 of 1500 occurrences are beyond the limit, the first at 0.055195 s.
Most of that time, 97.560 us, went into span frame at imu_hil.py:66 (sci_received).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from ....timing.verdict import Verdict, figure, in_words, instant
from ..explain.chain import Chain, Part, bound
from .over_time import OverTime


@dataclass(frozen=True)
class Failure:
    """The sentences about a failure, which may be "". place: the location in the firmware at the end of `why`."""

    what: str
    count: str = ""
    why: str = ""
    place: str = ""


def failure(
    verdict: Verdict, must_break: bool, chain: Chain | None, over: OverTime | None, per_second: int
) -> Failure | None:
    """Describe the failure of a budget. Return None if the budget is as expected."""
    if must_break and verdict.passed:
        return Failure(f"holds ({in_words(verdict.worst or 0, verdict.unit)}), but the case says that it must break")
    if must_break and verdict.broken:
        return None
    if verdict.broken:
        why, place = ("", "") if chain is None else _why(verdict, chain)
        return Failure(_what(verdict), "" if over is None else _count(verdict, over, per_second), why, place)
    if verdict.passed:
        return None
    return Failure(f"is not judged: {verdict.found or f'nothing was measured by {verdict.measure!r}'}")


def _what(verdict: Verdict) -> str:
    at = "" if verdict.at_s is None else f", at {instant(verdict.at_s)}"
    if verdict.worst is None or verdict.until_s is not None:
        return f"is broken: {verdict.found}{at}"
    worst, limit = (in_words(value, verdict.unit) for value in (verdict.worst, verdict.limit))
    of = "for " if verdict.which not in ("max", "min", "exactly") else ""
    allowed = "none" if (verdict.which, verdict.limit) == ("max", 0) else f"{of}{bound(verdict.which)} {limit}"
    off = abs(verdict.worst - verdict.limit)
    beyond = ""
    if verdict.unit in ("us", "%", "LSB") and verdict.limit:
        beyond = f" ({figure(off, verdict.unit)} {'too much' if verdict.worst > verdict.limit else 'too little'})"
    return f"is broken: {worst}, {allowed} allowed{beyond}{at}"


def _count(verdict: Verdict, over: OverTime, per_second: int) -> str:
    if over.count == 1 or not over.violations:
        return ""
    if over.violation_count == over.count:
        return f"All {over.count} occurrences are beyond the limit"
    if over.violation_count == 1:
        return f"It is the only one of {over.count} occurrences that is beyond the limit"
    first = over.violations[0][0] / per_second
    when = "" if verdict.at_s is not None and abs(first - verdict.at_s) < 1e-9 else f", the first at {instant(first)}"
    return f"{over.violation_count} of {over.count} occurrences are beyond the limit{when}"


def _why(verdict: Verdict, chain: Chain) -> tuple[str, str]:
    part = chain.blamed or next(iter(chain.parts), None)
    if part is None:
        return "", ""
    return (_blame(part, chain), "") if part.place is None else (f"{_blame(part, chain)} at", str(part.place))


def _blame(part: Part, chain: Chain) -> str:
    """Describe a part of the explanation as the cause, with its time if it has one."""
    if not part.length or part is chain.blame:
        return f"Cause: {part}"
    length = chain.figure(abs(part.length))
    if part in chain.more:
        return f"{'Shorter' if part.length < 0 else 'Longer'} than typical by {length}: {part}"
    share = Fraction(part.length, chain.length) if chain.length else Fraction(0)
    most = "Most of that time" if share > Fraction(1, 2) else "The largest part of that time"
    return f"{most}, {length}, went into {part}"
