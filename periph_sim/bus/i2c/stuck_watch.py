"""Detection of a line that stays low for too long: calls a callback and makes a BUS record.

It is for scenes without a controller agent, which would report the line itself.

Source: SMBus specification section 3.1.1.3 for the default of 25 ms (tTIMEOUT); UM10204 has no limit.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from ...core.kernel import Kernel
from ...core.records import Kind, Recorder
from ...core.sampler import watch
from ...core.state import State
from ...core.time import NO_TIME
from ...core.wire import Wire
from .bit_skip import BitParty, BitSkip
from .bit_times import SKIPPED_BITS, BitTimes
from .event_recorder import WHO

STUCK_AFTER = Fraction(25, 1000)


class StuckWatch(BitParty):
    """Reports a wire to `on_stuck`, once each time that it has been low for `limit` ticks.

    bit_skip: the shortcut that skips bits on the bus of the wire, or None.
    """

    STATE = State("_guarded _reported", ticks="_fell")

    def __init__(
        self,
        kernel: Kernel,
        recorder: Recorder,
        wire: Wire,
        limit: int,
        on_stuck: Callable[[Wire], None],
        bit_skip: BitSkip | None = None,
    ) -> None:
        self._kernel = kernel
        self._recorder = recorder
        self._wire = wire
        self._limit = limit
        self._on_stuck = on_stuck
        self._fell = kernel.now
        self._guarded = False
        self._reported = False
        self._bit_skip = bit_skip
        watch([wire], self)

    def sampled(self, now: int, levels: int) -> None:
        if not levels:
            self._falls(now)

    def ready(self, low: int, high: int, hold: int, each: bool) -> bool:
        return self._limit > (SKIPPED_BITS + 1) * (low + high)

    def on_bits_skipped(self, shown: int, times: BitTimes) -> None:
        assert self._bit_skip is not None
        fell = times.fall(SKIPPED_BITS) if self._wire.name == "SCL" else self._bit_skip.sda_fell()
        if fell != NO_TIME:
            self._falls(fell)

    def _falls(self, at: int) -> None:
        self._fell, self._reported = at, False
        if not self._guarded:
            self._guard()

    def _guard(self) -> None:
        """Schedule the check of the line. There is one such event at a time, however often the line moves."""
        self._guarded = True
        self._kernel.call_at(self._fell + self._limit, self._look)

    def _look(self) -> None:
        self._kernel.materialize()
        self._guarded = False
        if self._wire.level or self._reported:
            return
        if self._kernel.now < self._fell + self._limit:
            self._guard()
            return
        self._reported = True
        self._recorder.emit(self._kernel.now, Kind.BUS, WHO, "stuck", self._wire.level)
        self._on_stuck(self._wire)
