"""A line that stays low for too long: its levels go in; who asked is told, and a BUS record says it.

For scenes in which no agent is the controller, which would tell it.

Source: SMBus specification section 3.1.1.3 for the default of 25 ms (tTIMEOUT); UM10204 has no limit.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from ...core.kernel import Kernel
from ...core.records import Kind, Recorder
from ...core.wire import Wire
from .event_recorder import WHO

STUCK_AFTER = Fraction(25, 1000)


class StuckWatch:
    """told: with the wire, once for each time that it is low for `limit` ticks."""

    def __init__(
        self, kernel: Kernel, recorder: Recorder, wire: Wire, limit: int, told: Callable[[Wire], None]
    ) -> None:
        self._kernel = kernel
        self._recorder = recorder
        self._wire = wire
        self._limit = limit
        self._told = told
        self._fell = kernel.now
        self._guarded = False
        self._reported = False
        wire.watch(self._changed)

    def _changed(self, now: int, level: int) -> None:
        if not level:
            self._fell, self._reported = now, False
            if not self._guarded:
                self._guard()

    def _guard(self) -> None:
        """One event at a time, however often the line moves."""
        self._guarded = True
        self._kernel.at(self._fell + self._limit, self._look)

    def _look(self) -> None:
        self._guarded = False
        if self._wire.level or self._reported:
            return
        if self._kernel.now < self._fell + self._limit:
            self._guard()
            return
        self._reported = True
        self._recorder.emit(self._kernel.now, Kind.BUS, WHO, "stuck", self._wire.level)
        self._told(self._wire)
