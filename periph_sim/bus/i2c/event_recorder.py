"""BUS records of an I2C bus without a controller agent, from its edges.

    SCL, SDA --sampled together--> START, address, byte, NACK, STOP, as a controller agent records them

They allow budgets on the bus for firmware that is the master, and for captures.

Source: UM10204 sections 3.1.4 to 3.1.10.
"""

from __future__ import annotations

from ...core.kernel import Kernel
from ...core.records import Kind, Recorder
from ...core.sampler import watch
from ...core.state import State
from ...core.wire import Wire
from .bit_skip import BitParty
from .bit_times import SKIPPED_BITS, BitTimes

SCL, SDA = 1, 2  # bits of the sampled levels
BITS = 9
WHO = "bus"


class BusRecorder(BitParty):
    """text of its records: the address of the phase, "0x68"."""

    STATE = State("_levels _busy _index _bits _in _read _address")

    def __init__(self, kernel: Kernel, recorder: Recorder, scl: Wire, sda: Wire) -> None:
        self._recorder = recorder
        self._kernel = kernel
        self._levels = scl.level | sda.level << 1
        self._busy = False  # between a START and its STOP
        self._index = -1  # -1: the address, else the number of the data byte
        self._bits = self._in = 0
        self._read = False
        self._address = ""
        watch([scl, sda], self)

    def sampled(self, now: int, levels: int) -> None:
        before, self._levels = self._levels, levels
        if before & levels & SCL:
            self._condition(bool(levels & SDA))
        elif levels & SCL:
            self._bits += 1
            self._in = self._in << 1 | levels >> 1
        elif self._busy and self._bits == BITS:
            self._byte_over()

    def on_bits_skipped(self, shown: int, times: BitTimes) -> None:
        self._levels = SDA if shown & 1 else 0
        self._bits += SKIPPED_BITS
        self._in = self._in << SKIPPED_BITS | shown >> 1

    def _condition(self, stop: bool) -> None:
        if stop:
            self._mark("STOP", 0)
        else:
            self._mark("repeated START" if self._busy else "START", 0)
        self._busy, self._index, self._bits, self._in = not stop, -1, 0, 0

    def _byte_over(self) -> None:
        byte, refused = self._in >> 1, bool(self._in & 1)
        if self._index < 0:
            self._address, self._read = f"{byte >> 1:#04x}", bool(byte & 1)
        self._mark("byte" if self._index >= 0 else "address", self._in)
        if refused and (self._index < 0 or not self._read):
            self._mark("NACK", int(self._index >= 0))
        self._index += 1
        self._bits = self._in = 0

    def _mark(self, what: str, value: int) -> None:
        self._recorder.emit(self._kernel.now, Kind.BUS, WHO, what, value, self._address if self._busy else "")
