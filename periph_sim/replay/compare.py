"""Two lists of events, the capture's and the replay's: where they part first, and how far apart in time they are.

An event is compared by its words ("address 50 write", "ACK"), not by its time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import zip_longest

NOTHING = "nothing more"


@dataclass(frozen=True, slots=True)
class Happened:
    """One event in words. at: seconds since the capture began; None if unknown."""

    words: str
    at: Fraction | None


@dataclass(frozen=True, slots=True)
class Divergence:
    """index: events that agreed before it. Times in seconds since the capture began; None where nothing came."""

    index: int
    expected: str
    found: str
    capture_s: float | None
    replay_s: float | None


@dataclass(frozen=True, slots=True)
class Comparison:
    """agreed: events up to the first that differs. lag: the largest difference in time of those, in seconds."""

    agreed: int
    divergence: Divergence | None
    lag: Fraction


def compare(expected: Sequence[Happened], found: Sequence[Happened]) -> Comparison:
    """The first difference; also where one list is longer."""
    lag = Fraction(0)
    for index, (was, came) in enumerate(zip_longest(expected, found, fillvalue=Happened(NOTHING, None))):
        if was.words != came.words:
            divergence = Divergence(index, was.words, came.words, _seconds(was.at), _seconds(came.at))
            return Comparison(index, divergence, lag)
        if was.at is not None and came.at is not None:
            lag = max(lag, abs(came.at - was.at))
    return Comparison(len(expected), None, lag)


def _seconds(at: Fraction | None) -> float | None:
    return None if at is None else float(at)
