"""Describe the failure of a budget by sentences with the broken limit and its cause, and by lines of the firmware.

response: 97.953 us is over its limit of 50.000 us, at 0.105195 s.
3 of 1500 occurrences are beyond the limit, the first at 0.055195 s.
Most of that time, 97.560 us, went into span frame at imu_hil.py:66 (sci_received).

    65      def sci_received():
    66          with span("frame"):
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from textwrap import dedent

from ....timing.verdict import Verdict, broken, in_words, instant
from ..explain.chain import Chain, FirmwarePlace, Part
from .over_time import OverTime

NEIGHBOURS = 2  # number of lines of firmware that are shown before and after the line of a cause


@dataclass(frozen=True)
class SourceLines:
    """A line of the firmware. lines: number and text of this line and of its neighbours."""

    place: str
    line: int
    lines: tuple[tuple[int, str], ...]


@dataclass(frozen=True)
class Failure:
    """The sentences about the failure of a budget.

    what: the value and the broken limit.
    count: the number of occurrences beyond the limit, or "".
    why: the cause, or "".
    place: the location in the firmware with which the sentence `why` ends, or "".
    source: the line of the firmware at `place`. If the cause has no location, it is the line of the last step of the
        explanation that has a location. None if there is no such step, or if the file cannot be read.
    """

    what: str
    count: str = ""
    why: str = ""
    place: str = ""
    source: SourceLines | None = None


def failure(
    verdict: Verdict, must_break: bool, chain: Chain | None, over: OverTime | None, per_second: int
) -> Failure | None:
    """Describe the failure of a budget. Return None if the budget holds, and is not listed in `breaks` of the case.

    must_break: True if the budget is listed in `breaks`.
    """
    if must_break and verdict.passed:
        return Failure(f"{in_words(verdict.worst or 0, verdict.unit)} holds, but the budget is listed in breaks")
    if verdict.broken:
        part = None if chain is None else chain.blamed or next(iter(chain.parts), None)
        why = "" if chain is None or part is None else _blame(part, chain)
        count = "" if over is None else _count(verdict, over, per_second)
        places = [] if chain is None else [step.place for step in chain.steps if step.place is not None]
        if part is None or part.place is None:
            return Failure(broken(verdict), count, why, "", source_around(places[-1]) if places else None)
        return Failure(broken(verdict), count, f"{why} at", str(part.place), source_around(part.place))
    if verdict.passed:
        return None
    return Failure(f"not judged: {verdict.found or f'nothing was measured by {verdict.measure!r}'}")


def source_around(place: FirmwarePlace) -> SourceLines | None:
    """Return a line of the firmware with its neighbours; None if the line is unknown or the file cannot be read."""
    if place.file is None or not place.line:
        return None
    try:
        lines = place.file.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return None
    if place.line > len(lines):
        return None
    first = max(place.line - 1 - NEIGHBOURS, 0)
    shown = dedent("\n".join(lines[first : place.line + NEIGHBOURS])).split("\n")
    return SourceLines(str(place), place.line, tuple(enumerate(shown, first + 1)))


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


def _blame(part: Part, chain: Chain) -> str:
    """Describe a part of the explanation as the cause, with its time if it has one."""
    if not part.length or part is chain.blame:
        return f"Cause: {part}"
    length = chain.figure(abs(part.length))
    if part in chain.more:
        return f"{length} {'shorter' if part.length < 0 else 'longer'} than in its least critical occurrence: {part}"
    share = Fraction(part.length, chain.length) if chain.length else Fraction(0)
    most = "Most of that time" if share > Fraction(1, 2) else "The largest part of that time"
    return f"{most}, {length}, went into {part}"
