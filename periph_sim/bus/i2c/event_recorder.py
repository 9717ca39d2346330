"""BUS records of an I2C bus without a controller agent, from its edges.

    SCL, SDA --sampled together--> START, address, byte, NACK, STOP, as a controller agent records them

They allow budgets on the bus for firmware that is the master, and for captures.

Source: UM10204 sections 3.1.4 to 3.1.10.
"""

from __future__ import annotations

from ...core.kernel import Kernel
from ...core.records import Kind, Recorder
from ...core.state import State
from ...core.wire import Wire
from ...traces.decode.i2c_stream import BYTE_OVER, KINDS, START, STOP
from .byte_counter import I2cByteCounter

WHO = "bus"


class BusRecorder(I2cByteCounter):
    """Makes BUS records. The text of a record is the address of the phase, for example "0x68"."""

    STATE = State("_address")

    def __init__(self, kernel: Kernel, recorder: Recorder, scl: Wire, sda: Wire) -> None:
        super().__init__(scl, sda)
        self._recorder = recorder
        self._kernel = kernel
        self._address = ""

    def sampled(self, now: int, levels: int) -> None:
        stream = self.stream
        busy, event = stream.busy, stream.sample(levels)
        kind = event & KINDS
        if event == BYTE_OVER:
            self.bytes += 1
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
