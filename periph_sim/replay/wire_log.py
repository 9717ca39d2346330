"""Log of the edges of wires in a running scene, which can be read like the capture of a logic analyser."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from pathlib import Path

from ..core.sampler import watch
from ..core.time import Timebase
from ..core.wire import Wire
from ..traces.capture.capture import Capture, channel_of


class WireLog:
    """Log of the edges of some wires. Its positions are ticks."""

    def __init__(self, *wires: Wire) -> None:
        self._wires = wires
        self._ticks: list[list[int]] = [[0] for _ in wires]
        self._levels: list[list[int | None]] = [[wire.level] for wire in wires]
        for wire, ticks, levels in zip(wires, self._ticks, self._levels, strict=True):
            # The listener does not refer to `self`. Otherwise, the wire would keep this object in memory for ever.
            watch([wire], partial(_keep, ticks, levels))

    def capture(self, timebase: Timebase, now: int) -> Capture:
        """Return a capture of the wires' levels up to and including tick `now`."""
        states = enumerate(zip(self._wires, self._ticks, self._levels, strict=True))
        channels = tuple(
            channel_of(wire.name, index, ticks, levels, now + 1) for index, (wire, ticks, levels) in states
        )
        return Capture(Path("replay"), Fraction(timebase.per_second), now + 1, channels, sampled=False, exact=True)

    @property
    def last_edge(self) -> int:
        """The tick of the last edge of any wire; 0 before the first edge."""
        return max(ticks[-1] for ticks in self._ticks)

    @property
    def edge_count(self) -> int:
        """The number of edges so far, of all wires together."""
        return sum(len(ticks) - 1 for ticks in self._ticks)


def _keep(ticks: list[int], levels: list[int | None], tick: int, level: int) -> None:
    ticks.append(tick)
    levels.append(level)
