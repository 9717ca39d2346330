"""Errors of a level: the worst one of each observable of paired occurrences.

An occurrence without a partner is an infinite error. An observable that occurs in neither run has no error: it is
unmeasured, and not exact.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf, isinf

import numpy as np

from .pairing import Paired

CYCLES = "cycles"
INFINITE = "infinite"


@dataclass(frozen=True)
class Errors:
    """Error of one observable. unit: "cycles" of SYSCLKOUT, "%", "LSB", "differ" (0 equal, 1 not), or of a count.

    count: occurrences, each pair once; 0 if there is none in either run. worst: infinite if some have no partner.
    """

    name: str
    unit: str
    count: int
    worst: float

    @property
    def measured(self) -> bool:
        return self.count > 0

    @property
    def exact(self) -> bool:
        return self.measured and self.worst == 0


def errors_of(name: str, unit: str, pairs: Iterable[Paired], scale: float = 1.0) -> Errors:
    """Return the error of all these together, as one observable. scale: differences in one unit."""
    parts = list(pairs)
    found = np.concatenate([np.abs(part.differences) for part in parts]) / scale
    unpaired = sum(part.unpaired for part in parts)
    beyond = unpaired or any(part.disordered for part in parts)
    return Errors(name, unit, len(found) + unpaired, inf if beyond else float(found.max(initial=0.0)))


def worst_of(errors: Iterable[Errors], unit: str = CYCLES) -> float:
    """Return the worst of all errors in this unit; 0.0 if none has it."""
    return max((each.worst for each in errors if each.unit == unit), default=0.0)


def within(errors: Iterable[Errors], cycles: float) -> bool:
    """Return True if no time is off by more than this, and everything else is equal."""
    return all(each.worst <= (cycles if each.unit == CYCLES else 0) for each in errors)


def number(value: float) -> str:
    """`infinite`, `0`, `13`, `3.75`, `93686.2`: no more digits than tell something."""
    if isinf(value):
        return INFINITE
    digits = f"{value:.1f}" if value >= 100 else f"{value:.3g}"
    return digits.rstrip("0").rstrip(".") if "." in digits and "e" not in digits else digits
