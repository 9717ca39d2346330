"""Wires of a running scene as a capture: their edges go in, what a logic analyser would have saved comes out."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

from ..core.time import Timebase
from ..core.wire import Wire
from ..traces.capture.capture import Capture, Channel, channel_of


class WireLog:
    """Positions are ticks."""

    def __init__(self, *wires: Wire) -> None:
        self._wires = wires
        self._ticks: list[list[int]] = [[0] for _ in wires]
        self._levels: list[list[int | None]] = [[wire.level] for wire in wires]
        for wire, ticks, levels in zip(wires, self._ticks, self._levels, strict=True):
            wire.watch(_collector(ticks, levels))

    def capture(self, timebase: Timebase, now: int) -> Capture:
        """What was on the wires up to and including `now`."""
        channels = self._channels(now + 1)
        return Capture(Path("replay"), Fraction(timebase.per_second), now + 1, channels, sampled=False, exact=True)

    def _channels(self, length: int) -> tuple[Channel, ...]:
        return tuple(
            channel_of(wire.name, index, ticks, levels, length)
            for index, (wire, ticks, levels) in enumerate(zip(self._wires, self._ticks, self._levels, strict=True))
        )


def _collector(ticks: list[int], levels: list[int | None]) -> Callable[[int, int], None]:
    def collect(tick: int, level: int) -> None:
        ticks.append(tick)
        levels.append(level)

    return collect
