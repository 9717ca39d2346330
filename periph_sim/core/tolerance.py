"""Tolerances of times: a duration with its unit, such as "3 us", or a number of cycles of SYSCLKOUT, "20 cycles"."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from .exact_number import SHOWN, exact_number, number_and_unit, unknown_unit
from .phrases import shorten
from .table import duration
from .time import UNITS, TimeError, seconds

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
    if cycles is not None:
        return Cycles(exact_number(cycles[1]))
    try:
        seconds(text)
    except TimeError as error:
        raise ValueError(_with_cycles(str(error), text)) from None
    return duration(text)


def _with_cycles(error: str, text: str) -> str:
    """Return the message for a text that is not a time. If the unit is wrong or missing, the message suggests cycles.

    For a unit in other characters than ASCII, the message is `error`.
    error: the message of `seconds`, which suggests only units of time.
    """
    number, unit = number_and_unit(text)
    if unit in UNITS or not unit.isascii():
        return error
    has_digits = any(map(str.isdigit, number))
    if unit and has_digits:
        return f"{shorten(repr(text), SHOWN)}: {unknown_unit(number, unit, (*UNITS, 'cycles'))}"
    return f"{error} or {shorten(number, SHOWN) if has_digits else 20} cycles"


def in_seconds(tolerance: Tolerance, cycles_per_second: Fraction) -> Fraction:
    """Return a tolerance in seconds."""
    return tolerance.count / cycles_per_second if isinstance(tolerance, Cycles) else tolerance


def in_cycles(tolerance: Tolerance, cycles_per_second: Fraction) -> Fraction:
    """Return a tolerance in cycles."""
    return tolerance.count if isinstance(tolerance, Cycles) else tolerance * cycles_per_second
