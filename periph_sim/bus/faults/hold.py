"""A line held low for a time, or until SCL has fallen a number of times.

    SDA  ‾‾|___________________________|‾‾‾    clocks = 9: like a device that lost count in mid-byte
    SCL  ‾‾‾‾‾|_|‾|_|‾ ... ‾|_|‾|_|‾|___|‾     and releases SDA with the ninth clock at the latest

Source: UM10204 section 3.1.16 (bus clear).
"""

from __future__ import annotations

from dataclasses import dataclass

from . import Count, FaultContext, HeldLine, Length, Repeated, When


@dataclass(frozen=True, kw_only=True)
class Settings(When):
    """A wire that is held low, for a time or for a number of falls of SCL.

    wire: the wire, such as "SDA"
    length: time for which the wire is held low
    clocks: number of falls of SCL after which the wire is released
    """

    wire: str
    length: Length | None = None
    clocks: Count | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.length is None) == (self.clocks is None):
            raise ValueError("a line is held either for a length or for a number of clocks; give one of them")


def attach(settings: Settings, place: FaultContext) -> Repeated:
    clocks = settings.clocks or 0
    ticks = 0 if settings.length is None else place.ticks(settings.length)
    scl = place.wire("SCL") if clocks else None
    line = HeldLine(place.kernel, place.wire(settings.wire), scl, place.who, ticks, clocks)
    return Repeated(settings, place, line.pull)
