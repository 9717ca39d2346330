"""Observers of an I2C bus that report what a controller agent reports itself: bytes, BUS records and stuck lines.

    SCL, SDA --BusRecorder--> START, address, byte, NACK, STOP, as a controller agent records them; number of bytes
    one wire --StuckWatch---> stuck

With these observers, time limits can be checked on a bus whose master is firmware or a replayed capture, because such a
master reports nothing itself.

Source: UM10204 sections 3.1.4 to 3.1.10. SMBus specification section 3.1.1.3 for the default of 25 ms (tTIMEOUT) after
which a line is stuck; UM10204 has no limit.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from ...core.records import Kind
from ...core.sampler import watch
from ...core.state import State
from ...core.time import NO_TIME
from ...core.wire import Wire
from ...traces.decode.i2c_stream import BYTE_OVER, KINDS, START, STOP, I2cStream
from .bit_skip import SKIPPED_BITS, BitParty, BitSkip, BitTimes

WHO = "bus"
STUCK_AFTER = Fraction(25, 1000)


class BusRecorder(BitParty):
    """Counts the bytes on one bus, and makes BUS records if any subscriber wants them.

    The text of a record is the last 7-bit address on the bus so far, such as "0x68". It is "" before the first address,
    for the START of a transfer, and for a STOP on an idle bus.
    bytes: number of whole bytes with their acknowledge bit. Bytes that a START or STOP cuts off do not count.
    """

    STATE = State("stream _address")

    def __init__(self, scl: Wire, sda: Wire) -> None:
        self.bytes = 0
        self.stream = I2cStream(scl.level | sda.level << 1)
        self._kernel = scl.kernel
        self._recorder = scl.recorder
        self._records = scl.recorder.wants(Kind.BUS)
        self._address = ""
        watch([scl, sda], self)

    def sampled(self, now: int, levels: int) -> None:
        stream = self.stream
        busy, event = stream.busy, stream.sample(levels)
        if event == BYTE_OVER:
            self.bytes += 1
        if self._records and event:
            self._record(event, busy)

    def ready(self, low: int, high: int, hold: int, each: bool) -> bool:
        """Return False if `stream` is in the middle of a byte, for example after a reset of the master in mid-byte."""
        return not self.stream.bits

    def on_bits_skipped(self, shown: int, times: BitTimes) -> None:
        self.stream.skip(shown)

    def _record(self, event: int, busy: bool) -> None:
        """Make the BUS records of an event that `stream` returned. busy: True if the bus was busy before the event."""
        stream, kind = self.stream, event & KINDS
        if event == BYTE_OVER:
            first = stream.index == 0
            if first:
                self._address = f"{stream.address:#04x}"
            self._mark("address" if first else "byte", stream.byte << 1 | (not stream.acked), True)
            if not stream.acked and (first or not stream.read):
                self._mark("NACK", int(not first), True)
        elif kind == START:
            self._mark("repeated START" if busy else "START", 0, busy)
        elif kind == STOP:
            self._mark("STOP", 0, busy)

    def _mark(self, what: str, value: int, busy: bool) -> None:
        self._recorder.emit(self._kernel.now, Kind.BUS, WHO, what, value, self._address if busy else "")


class StuckWatch(BitParty):
    """Calls `on_stuck(wire)`, and makes a BUS record, each time that the wire has been low for `limit` ticks.

    bit_skip: the shortcut that skips bits on the wire's bus; None if no bits are skipped there.
    """

    STATE = State("_guarded _reported", ticks="_fell")

    def __init__(
        self, wire: Wire, limit: int, on_stuck: Callable[[Wire], None], bit_skip: BitSkip | None = None
    ) -> None:
        self._kernel = wire.kernel
        self._wire = wire
        self._limit = limit
        self._on_stuck = on_stuck
        self._fell = wire.kernel.now
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
        """Schedule the check for a stuck wire. Call this only if `_guarded` is False: no check is scheduled yet."""
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
        self._wire.recorder.emit(self._kernel.now, Kind.BUS, WHO, "stuck", self._wire.level)
        self._on_stuck(self._wire)
