"""A bit on the wire that is 0 instead of 1: SDA is pulled low for one clock, and no condition is made by it.

    SCL  ‾‾|__|‾‾|__|‾‾|__|‾‾|__     the bus has pull-ups, so a 0 cannot be made a 1: the next bit that is 1 is struck,
    SDA  ‾‾‾‾______‾‾‾‾‾‾            an ACK or a data bit of either side

A device that sends wrong bits of either kind has a fault of its own (`fault` of [device.NAME]).
"""

from __future__ import annotations

from dataclasses import dataclass

from ...core.kernel import Agent
from . import FaultContext, repeat
from .when import When


@dataclass(frozen=True, kw_only=True)
class Settings(When):
    """Nothing but when: the first 1 after that time is struck."""


class Flip(Agent):
    def __init__(self, settings: Settings, place: FaultContext) -> None:
        self._scl, self._sda = place.wire("SCL"), place.wire("SDA")
        self._pin = self._sda.attach(place.who)
        self._armed = False
        self._pulls = False
        self._is_one = False  # nobody else pulls SDA in this clock
        self._scl.watch(self._scl_changed)
        self._sda.watch_pulls(self)
        repeat(settings, place, self._arm)

    def _arm(self) -> None:
        self._armed = True

    def _scl_changed(self, now: int, level: int) -> None:
        if level:
            self._is_one = self._pulls and self._alone()
        elif self._is_one:  # that clock is over, with its 1 struck
            self._armed = self._is_one = False
            self._let_go()
        elif self._armed and not self._pulls:
            self._pulls = True
            self._pin.drive(0)

    def pulled(self, line: int, now: int, pulling: int) -> None:
        """Within a clock that was no 1 the last of the others lets go: a STOP, which must pass."""
        if self._pulls and self._scl.level and not self._is_one and self._alone():
            self._let_go()

    def _alone(self) -> bool:
        return len(self._sda.held_by()) == 1

    def _let_go(self) -> None:
        self._pulls = False
        self._pin.drive(1)


def attach(settings: Settings, place: FaultContext) -> None:
    Flip(settings, place)
