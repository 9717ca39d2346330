"""Edges of seven bits that pass at once, where somebody records them: a byte goes in; pulls of SCL and SDA come out.

    controller --7 bits at once--> EdgePlay --pull SCL, SDA--> wires: the records that edges make, tick by tick
                                   SdaFollows (who sends)      nobody else is told

Each pull comes at the tick and in the phase in which its party would make it, so records stand in the same order among
all others. What the chips do with an edge is left out.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ...core.kernel import TIMER, Agent, Event, Kernel
from ...core.wire import Wire
from .line_events import SCL

BITS = 7  # that pass at once

# What an event is for.
RISE, FALL, FOLLOW = range(3)


@final
class Deaf(Agent):
    """Stands in for one to whom edges do nothing meanwhile."""

    __slots__ = ()

    def sampled(self, now: int, levels: int) -> None:
        """It need not know."""

    def pulled(self, line: int, now: int, pulling: int) -> None:
        """It need not know."""


class EdgePlay(Agent):
    """Of the controller, whose holds on the wires `scl_mask` and `sda_mask` are."""

    __slots__ = (
        "_bit",
        "_byte",
        "_high",
        "_hold",
        "_kernel",
        "_low",
        "_next",
        "_scl",
        "_scl_mask",
        "_sda",
        "_sda_mask",
    )

    def __init__(self, kernel: Kernel, scl: Wire, sda: Wire, scl_mask: int, sda_mask: int) -> None:
        self._kernel = kernel
        self._scl, self._sda = scl, sda
        self._scl_mask, self._sda_mask = scl_mask, sda_mask
        self._byte = self._bit = self._low = self._high = self._hold = 0
        self._next: Event = kernel.event(self)

    def begin(self, byte: int, low: int, high: int, hold: int) -> None:
        """SCL rises for the first bit of `byte`, which SDA shows. low, high, hold: ticks, as the controller clocks."""
        self._byte, self._bit = byte, 0
        self._low, self._high, self._hold = low, high, hold
        self.act(RISE)

    def act(self, tag: int) -> None:
        now = self._kernel.now
        if tag == RISE:
            self._scl.pull(self._scl_mask, 1)
            self._then(now + self._high, FALL)
            return
        if tag == FALL:
            self._scl.pull(self._scl_mask, 0)
            self._bit += 1
            around = self._byte >> (BITS - self._bit) & 3
            if around == 1 or around == 2:
                self._then(now + self._hold, FOLLOW)
                return
            rise = now + self._low
        else:
            self._sda.pull(self._sda_mask, self._byte >> (BITS - self._bit) & 1)
            rise = now + self._low - self._hold
        if self._bit < BITS:
            self._then(rise, RISE)

    def stop(self) -> None:
        """The rest is done by the controller itself."""
        self._kernel.cancel(self._next)

    def _then(self, time: int, tag: int) -> None:
        self._kernel.renew(self._next, time, tag)


class SdaFollows(Agent):
    """One who sends: SDA takes the next bit `hold` ticks behind each fall of SCL."""

    __slots__ = ("_bit", "_byte", "_hold", "_kernel", "_mask", "_next", "_rose", "_sda")

    def __init__(self, kernel: Kernel, sda: Wire, mask: int, hold: int) -> None:
        self._kernel = kernel
        self._sda = sda
        self._mask = mask
        self._hold = hold
        self._byte = self._bit = 0
        self._rose = False  # SCL has
        self._next: Event | None = None

    def begin(self, byte: int) -> None:
        """SCL is about to rise for the first bit of `byte`, which SDA shows."""
        self._byte, self._bit, self._rose = byte, 0, False

    def sampled(self, now: int, levels: int) -> None:
        if levels & SCL:
            self._rose = True
        elif self._rose:
            self._rose = False
            self._bit += 1
            around = self._byte >> (BITS - self._bit) & 3
            if around == 1 or around == 2:
                self.follow(now, around & 1)

    def pulled(self, line: int, now: int, pulling: int) -> None:
        """It listens to levels."""

    def follow(self, now: int, level: int) -> None:
        """SCL fell at `now`, and SDA is to have another level behind it."""
        self.then(now + self._hold, level, TIMER)

    def act(self, tag: int) -> None:
        self._sda.pull(self._mask, tag)

    def then(self, time: int, tag: int, phase: int) -> None:
        """It acts at `time`."""
        if self._next is None:
            self._next = self._kernel.ask(time, self, tag, phase)
        else:
            self._kernel.renew(self._next, time, tag)

    def stop(self) -> None:
        """The rest it does itself."""
        if self._next is not None:
            self._kernel.cancel(self._next)
