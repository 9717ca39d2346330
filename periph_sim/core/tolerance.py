"""Tolerances of times: a duration with its unit, such as "3 us", or a number of cycles of SYSCLKOUT, "20 cycles"."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from .exact_number import exact_number
from .table import duration

_CYCLES = re.compile(r"\s*(\S+?)\s*cycles?\s*")


@dataclass(frozen=True)
class Cycles:
    """A time as a number of cycles of SYSCLKOUT."""

    count: Fraction

    def __post_init__(self) -> None:
        if self.count < 0:
            raise ValueError(f"{float(self.count):g} cycles is negative; a tolerance is 0 or more")


Tolerance: TypeAlias = Fraction | Cycles  # a Fraction is in seconds


def parse_tolerance(text: str) -> Tolerance:
    """Return the tolerance in a text such as "3 us" or "20 cycles". Raise ValueError for other texts."""
    cycles = _CYCLES.fullmatch(text)
    return duration(text) if cycles is None else Cycles(exact_number(cycles[1]))


def in_seconds(tolerance: Tolerance, cycles_per_second: Fraction) -> Fraction:
    """Return a tolerance in seconds."""
    return tolerance.count / cycles_per_second if isinstance(tolerance, Cycles) else tolerance


def in_cycles(tolerance: Tolerance, cycles_per_second: Fraction) -> Fraction:
    """Return a tolerance in cycles."""
    return tolerance.count if isinstance(tolerance, Cycles) else tolerance * cycles_per_second
