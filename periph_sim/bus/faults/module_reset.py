"""A reset of a unit's I2C module, for example in mid-byte, as a watchdog routine or a debugger makes it.

    I2CMDR.IRS  ‾‾‾‾‾‾|______|‾‾‾‾‾‾     for `length`: the module releases both lines and clears all flags; with
                                         IRS = 1 it waits for a START, and the firmware waits for flags that never come

Source: SPRUG03B section 5.9 (IRS).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from . import FaultContext, Length, Repeated, When, pulse


@dataclass(frozen=True, kw_only=True)
class Settings(When):
    """A reset of a unit's I2C module by I2CMDR.IRS, without the firmware's knowledge.

    unit: the unit whose I2C module is reset
    length: time from IRS = 0 to IRS = 1
    """

    unit: str
    length: Length = Fraction(1, 1_000_000)


def attach(settings: Settings, place: FaultContext) -> Repeated:
    return pulse(settings, place, f"{settings.unit}.IRS", settings.length)
