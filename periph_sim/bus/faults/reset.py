"""Reset of a unit: its XRS pin is pulled low for `length`. Its firmware then restarts from its beginning.

The unit releases every line at once, even in the middle of a byte, and does not answer until its start-up is over. The
registers of its modules get their reset values. Python firmware is called again, and the variables of C sources are
initialized again. An image is started again, but the memory keeps its contents, as RAM does on the chip.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from . import FaultContext, Length, Repeated, When, pulse


@dataclass(frozen=True, kw_only=True)
class Settings(When):
    """A reset of a unit by its XRS pin. The firmware restarts.

    unit: the unit that is reset
    length: time for which XRS is low
    """

    unit: str
    length: Length = Fraction(1, 1000)


def attach(settings: Settings, place: FaultContext) -> Repeated:
    return pulse(settings, place, f"{settings.unit}.XRS", settings.length)
