"""Times of a fault: once, or repeatedly, each time with a random delay.

at ---- every ---- every ---- ...     times: maximum number of faults
|~spread~|   maximum random delay of each fault, drawn from the case's seed
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated

from msgspec import Meta

from ...core.convert import Before
from ...core.settings import DURATION_TEXT
from ...core.time import TimeError, seconds


def _length(value: object) -> object:
    if not isinstance(value, str):
        raise ValueError(f'{value!r} has no unit; write for instance "{value} ms"')
    try:
        return seconds(value)
    except TimeError as error:
        raise ValueError(str(error)) from None


def _not_negative(value: object) -> object:
    length = _length(value)
    if isinstance(length, Fraction) and length < 0:
        raise ValueError("it is negative; a time is 0 or more")
    return length


def _above_zero(value: object) -> object:
    length = _length(value)
    if isinstance(length, Fraction) and length <= 0:
        raise ValueError("it must be longer than 0")
    return length


Time = Annotated[Fraction, Before(_not_negative, DURATION_TEXT)]
Length = Annotated[Fraction, Before(_above_zero, DURATION_TEXT)]
Count = Annotated[int, Meta(ge=1)]


@dataclass(frozen=True, kw_only=True)
class When:
    """at: the time of the first fault, counted from the begin of the run.

    every: the time from one fault to the next; without it there is only one fault.
    spread: the maximum random delay of each fault.
    times: the maximum number of faults.
    """

    at: Time
    every: Length | None = None
    spread: Time = Fraction(0)
    times: Count | None = None

    def __post_init__(self) -> None:
        if self.every is None and self.times is not None:
            raise ValueError("times needs every; give every, or remove times")
        if self.every is not None and self.spread > self.every:
            raise ValueError("spread is longer than every, so faults would be out of order; shorten it")
