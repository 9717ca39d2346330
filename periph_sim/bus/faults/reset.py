"""A unit that is reset: its XRS pin is pulled low for `length`. Its firmware then begins anew, with all it holds lost.

What others see of it: it lets go of every line at once, in the middle of a byte too, and answers nobody until its
start-up is over.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from . import FaultContext, pulse
from .when import Length, When


@dataclass(frozen=True, kw_only=True)
class Settings(When):
    """unit: its name."""

    unit: str
    length: Length = Fraction(1, 1000)


def attach(settings: Settings, place: FaultContext) -> None:
    pulse(settings, place, f"{settings.unit}.XRS", settings.length)
