"""A line that stays low for too long: its levels go in; who asked is told, and a BUS record says it.

For scenes in which no agent is the controller, which would tell it.

Source: SMBus specification section 3.1.1.3 for the default of 25 ms (tTIMEOUT); UM10204 has no limit.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from ...core.kernel import Kernel
from ...core.records import Kind, Recorder
from ...core.time import NO_TIME
from ...core.wire import Wire, watch
from .bit_times import BitTimes
from .edge_play import BITS
from .event_recorder import WHO
from .whole_bytes import ByteParty, WholeBytes

STUCK_AFTER = Fraction(25, 1000)


class StuckWatch(ByteParty):
    """told: with the wire, once for each time that it is low for `limit` ticks. whole_bytes: what passes on its bus."""

    def __init__(
        self,
        kernel: Kernel,
        recorder: Recorder,
        wire: Wire,
        limit: int,
        told: Callable[[Wire], None],
        whole_bytes: WholeBytes | None = None,
    ) -> None:
        self._kernel = kernel
        self._recorder = recorder
        self._wire = wire
        self._limit = limit
        self._told = told
        self._fell = kernel.now
        self._guarded = False
        self._reported = False
        self._whole_bytes = whole_bytes
        watch([wire], self)

    def sampled(self, now: int, levels: int) -> None:
        if not levels:
            self._falls(now)

    def ready(self, low: int, high: int, hold: int, each: bool) -> bool:
        return self._limit > (BITS + 1) * (low + high)

    def heard(self, shown: int, times: BitTimes) -> None:
        assert self._whole_bytes is not None
        fell = times.fall(BITS) if self._wire.name == "SCL" else self._whole_bytes.sda_fell()
        if fell != NO_TIME:
            self._falls(fell)

    def _falls(self, at: int) -> None:
        self._fell, self._reported = at, False
        if not self._guarded:
            self._guard()

    def _guard(self) -> None:
        """One event at a time, however often the line moves."""
        self._guarded = True
        self._kernel.at(self._fell + self._limit, self._look)

    def _look(self) -> None:
        self._kernel.catch_up()
        self._guarded = False
        if self._wire.level or self._reported:
            return
        if self._kernel.now < self._fell + self._limit:
            self._guard()
            return
        self._reported = True
        self._recorder.emit(self._kernel.now, Kind.BUS, WHO, "stuck", self._wire.level)
        self._told(self._wire)
