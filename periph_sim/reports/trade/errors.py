"""How far a level is off: paired occurrences go in; mean, p99 and worst error of each observable come out.

An occurrence without a partner is an infinite error, and counts in each of the three. An observable that occurs in
neither run has no error: it is unmeasured, and not exact.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil, inf

import numpy as np

from .pairing import Paired

CYCLES = "cycles"


@dataclass(frozen=True)
class Errors:
    """Of one observable. unit: "cycles" of SYSCLKOUT; "%", "LSB", "differ" (0 equal, 1 not) or a word for a count.

    count: occurrences, each pair once; 0 if there is none in either run. lacking, added, disordered: those without a
    partner.
    """

    name: str
    unit: str
    count: int
    lacking: int
    added: int
    disordered: int
    mean: float
    p99: float
    worst: float

    @property
    def measured(self) -> bool:
        return self.count > 0

    @property
    def exact(self) -> bool:
        return self.measured and self.worst == 0


def errors_of(name: str, unit: str, pairs: Iterable[Paired], scale: float = 1.0) -> Errors:
    """All these together, as one observable. scale: differences in one unit."""
    parts = list(pairs)
    found = np.concatenate([np.abs(part.differences) for part in parts]) / scale
    lacking, added = sum(part.lacking for part in parts), sum(part.added for part in parts)
    changed = sum(part.disordered for part in parts)
    beyond = lacking + added + changed
    count = len(found) + beyond
    return Errors(
        name,
        unit,
        count,
        lacking,
        added,
        changed,
        mean=inf if beyond else float(found.mean()) if count else 0.0,
        p99=_p99(found, count),
        worst=inf if beyond else float(found.max(initial=0.0)),
    )


def _p99(found: np.ndarray[tuple[int], np.dtype[np.float64]], count: int) -> float:
    """By nearest rank, infinite errors last."""
    rank = ceil(99 * count / 100)
    if not rank:
        return 0.0
    return float(np.partition(found, rank - 1)[rank - 1]) if rank <= len(found) else inf


def worst_of(errors: Iterable[Errors], unit: str = CYCLES) -> float:
    """The worst of all that are in this unit; 0.0 if none is."""
    return max((each.worst for each in errors if each.unit == unit), default=0.0)


def within(errors: Iterable[Errors], cycles: float) -> bool:
    """Whether no time is off by more than this, and all that is no time is equal."""
    return all(each.worst <= (cycles if each.unit == CYCLES else 0) for each in errors)
