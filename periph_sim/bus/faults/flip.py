"""A bit on the wire that is 0 instead of 1: SDA is pulled low for one clock, from one fall of SCL to the next.

    SCL  ‾‾|__|‾‾|__|‾‾|__|‾‾|__     the next bit that is 1 becomes 0: a data bit of either side, or
    SDA  ‾‾‾‾______‾‾‾‾‾‾            a NACK, which is then an ACK

A 0 cannot become a 1 in this way; use a device's own fault for that (`fault` of [device.NAME]).

A controller that loses arbitration by this 0, or cannot make a repeated START because of it, makes no more clocks. SDA
is then released when SCL has been high for LONG_HIGH times its last low phase. This is a STOP.
"""

from __future__ import annotations

from dataclasses import dataclass

from ...core.state import State
from . import FaultContext, Repeated, SdaPuller, When


@dataclass(frozen=True, kw_only=True)
class Settings(When):
    """A wrong bit: the next bit on the bus that is 1, or a NACK, becomes 0."""


class Flip(SdaPuller):
    STATE = State("_is_one")

    def __init__(self, place: FaultContext) -> None:
        super().__init__(place)
        self._is_one = False  # True during a clock whose bit would be 1 without the fault
        self._sda.watch_pulls(self)

    def clocked(self, now: int, level: int) -> None:
        if level:
            self._is_one = self._pulls and self._alone()
            if self._is_one:
                self._armed = False
                self._expect_fall()
        elif self._is_one and self._pulls:  # the clock in which a 1 became 0 is over
            self._is_one = False
            self._pull(False)
        elif self._armed and not self._pulls:
            self._pull(True)

    def pulled(self, line: int, now: int, pulling: int) -> None:
        """Release SDA if the other party releases SDA while SCL is high: this is a STOP, for which SDA must rise."""
        if self._pulls and self._scl.level and not self._is_one and self._alone():
            self._pull(False)

    def _alone(self) -> bool:
        return len(self._sda.held_by()) == 1


def attach(settings: Settings, place: FaultContext) -> Repeated:
    return Repeated(settings, place, Flip(place).arm)
