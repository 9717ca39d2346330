"""Wires: what several parties do to one line, and who is told.

    Pin.drive --> level, low if anybody pulls --> settle --> watchers

A wire has a pull-up and any number of parties that may pull it low. Watchers hear of a
change after every party that acts in the same event has acted, in the order in which
they asked; nobody hears of a level that does not outlast the event.
"""

from __future__ import annotations

from collections.abc import Callable

from .kernel import Kernel
from .records import Kind, Recorder

Watcher = Callable[[int, int], None]


class Wire:
    def __init__(self, kernel: Kernel, name: str, recorder: Recorder) -> None:
        self.name = name
        self.level = 1
        self.cause = 0  # record of the last edge
        self._kernel = kernel
        self._recorder = recorder
        self.recorded = recorder.wants(Kind.EDGE, name)  # somebody hears of every edge
        self._pulling = 0  # bit i: pin i pulls low
        self._pins: list[str] = []
        self._watchers: list[Watcher] = []
        self._told = 1
        self._queued = False
        self._why = 0  # record under which it was pulled or let go, until that is settled
        self._unsettled = kernel.unsettled

    def attach(self, who: str) -> Pin:
        """A new party's hold on the line, released."""
        self._pins.append(who)
        return Pin(self, 1 << (len(self._pins) - 1))

    def watch(self, watcher: Watcher) -> None:
        """`watcher(tick, level)` on every change that outlasts the event that made it."""
        self._watchers.append(watcher)

    def parties(self) -> list[str]:
        """Who has a hold on the line, pulling or not."""
        return list(self._pins)

    def held_by(self) -> list[str]:
        """Who pulls the line low now: what a person asks first of a stuck bus."""
        return [who for i, who in enumerate(self._pins) if self._pulling >> i & 1]

    def pull(self, mask: int, level: int) -> None:
        """The parties of `mask` let go (1) or pull low (0)."""
        pulling = self._pulling & ~mask if level else self._pulling | mask
        self._pulling = pulling
        self.level = level = 0 if pulling else 1
        if level != self._told and not self._queued:
            self._queued = True
            self._unsettled.append(self)
            if self.recorded:
                self._why = self._recorder.cause

    def skip_to(self, mask: int, level: int) -> None:
        """The parties of `mask` have come to hold this level; whoever watches knows already and is not told."""
        self._pulling = self._pulling & ~mask if level else self._pulling | mask
        self.level = self._told = 0 if self._pulling else 1

    def skip_pulses(self, first: int, high: int, low: int, number: int) -> None:
        """High pulses that have passed, the line being low before and after; as `skip_to`, but recorded if wanted.

        first: tick of the first rise. high, low: ticks.
        """
        if not self.recorded:
            return
        emit, name, holders = self._recorder.emit, self.name, ", ".join(self.held_by())
        for rise in range(first, first + number * (high + low), high + low):
            emit(rise, Kind.EDGE, name, "level", 1)
            self.cause = emit(rise + high, Kind.EDGE, name, "level", 0, holders)

    @property
    def watched_by(self) -> int:
        """How many are told of every change."""
        return len(self._watchers)

    @property
    def pulled_by(self) -> int:
        """How many pull it low."""
        return self._pulling.bit_count()

    def held_by_others(self, mask: int) -> bool:
        """Whether anybody but the parties of `mask` pulls it low."""
        return bool(self._pulling & ~mask)

    def settle(self) -> None:
        """Tell the watchers if the level is not what they were told last."""
        self._queued = False
        level = self.level
        if level == self._told:
            return
        self._told = level
        now = self._kernel.now
        if self.recorded:
            self._record(now, level)
            return
        for watcher in self._watchers:
            watcher(now, level)

    def _record(self, now: int, level: int) -> None:
        recorder = self._recorder
        outer, recorder.cause = recorder.cause, self._why
        self.cause = recorder.emit(now, Kind.EDGE, self.name, "level", level, ", ".join(self.held_by()))
        recorder.cause = self.cause
        for watcher in self._watchers:
            watcher(now, level)
        recorder.cause = outer


class Pin:
    """One party's hold on a wire."""

    __slots__ = ("mask", "wire")

    def __init__(self, wire: Wire, mask: int) -> None:
        self.wire = wire
        self.mask = mask

    def drive(self, level: int) -> None:
        """0 pulls the wire low, 1 lets go."""
        self.wire.pull(self.mask, level)
