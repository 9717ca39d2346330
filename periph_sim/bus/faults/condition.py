"""A false START or STOP: SDA moves while SCL is high, in the middle of a byte.

    SCL  __|‾‾‾‾‾|__|‾‾‾‾‾|__        condition = "START": the next bit that is 1 is cut by a fall of SDA
    SDA  ‾‾‾‾‾|________________      condition = "STOP": SDA is pulled low before a 1, released during the 1

A bit that is 0 cannot be disturbed in this way, because its sender holds SDA low. So the next bit that is 1 is
disturbed. The idle time between two transfers, with both lines high, is not a bit, nor is the clock of a STOP. The
clock of a repeated START counts as a 1, because it is like one until SDA falls.

A controller that loses arbitration by a false START, or cannot make a repeated START because of it, makes no more
clocks. SDA is then released when SCL stays high for LONG_HIGH times its last low phase. This is a STOP.

Source: UM10204 section 3.1.4 (START and STOP conditions).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Literal

from ...core.state import State
from . import FaultContext, Length, Repeated, SdaPuller, When


@dataclass(frozen=True, kw_only=True)
class Settings(When):
    """A false START or STOP: SDA falls or rises within the next bit that is 1.

    condition: "START" or "STOP"
    late: time from the rise of SCL to the condition; SCL must be high for longer than this
    """

    condition: Literal["START", "STOP"] = "START"
    late: Length = Fraction(1, 1_000_000)


class Condition(SdaPuller):
    STATE = State("_rise _is_one")

    def __init__(self, settings: Settings, place: FaultContext) -> None:
        super().__init__(place)
        self._stop = settings.condition == "STOP"
        self._late = place.ticks(settings.late)
        self._rise = 0  # number of rises of SCL so far while a fault was armed
        self._is_one = False  # True if no other party held SDA low at the last rise of SCL

    def clocked(self, now: int, level: int) -> None:
        if not level:
            if self._armed and self._stop:
                self._pull(True)
            elif self._pulls:
                self._pull(False)
        elif self._armed:
            self._rise += 1
            self._is_one = not self._others()
            self._kernel.call_at(now + self._late, partial(self._strike, self._rise))

    def _strike(self, rise: int) -> None:
        """Make the START or STOP. Do nothing if the bit is 0, or if SCL has fallen since its rise with number `rise`.

        Called when the time `late` has passed since that rise.
        """
        if not self._armed or rise != self._rise or not self._scl.level:
            return
        if not self._is_one or self._others():
            return
        self._armed = False
        self._pull(not self._stop)
        if self._pulls:
            self._expect_fall()

    def _others(self) -> bool:
        """Return True if another party holds SDA low: the bit is 0, or the party makes a START or STOP."""
        return len(self._sda.held_by()) > self._pulls


def attach(settings: Settings, place: FaultContext) -> Repeated:
    return Repeated(settings, place, Condition(settings, place).arm)
