"""A line that somebody holds low: for a time, or until SCL has fallen so often.

    SDA  ‾‾|___________________________|‾‾‾    clocks = 9: a device that lost count in mid-byte,
    SCL  ‾‾‾‾‾|_|‾|_|‾ ... ‾|_|‾|_|‾|___|‾     and lets go at the latest with the ninth clock

Source: UM10204 section 3.1.16 (bus clear).
"""

from __future__ import annotations

from dataclasses import dataclass

from . import FaultContext, repeat
from .when import Count, Length, When


@dataclass(frozen=True, kw_only=True)
class Settings(When):
    """wire: its name, as in "SDA". length: how long; or clocks: falls of SCL until it is let go."""

    wire: str
    length: Length | None = None
    clocks: Count | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.length is None) == (self.clocks is None):
            raise ValueError("a line is held either for a length or for so many clocks; give one of them")


class Hold:
    def __init__(self, settings: Settings, place: FaultContext) -> None:
        self._kernel = place.kernel
        self._pin = place.wire(settings.wire).attach(place.who)
        self._length = None if settings.length is None else place.ticks(settings.length)
        self._clocks = settings.clocks or 0
        self._left = 0  # clocks until the line is let go
        if settings.clocks is not None:
            place.wire("SCL").watch(self._scl_changed)
        repeat(settings, place, self._strike)

    def _strike(self) -> None:
        self._pin.drive(0)
        self._left = self._clocks
        if self._length is not None:
            self._kernel.at(self._kernel.now + self._length, self._let_go)

    def _scl_changed(self, now: int, level: int) -> None:
        if self._left and not level:
            self._left -= 1
            if not self._left:
                self._let_go()

    def _let_go(self) -> None:
        self._pin.drive(1)


def attach(settings: Settings, place: FaultContext) -> None:
    Hold(settings, place)
