"""Listens to an I2C bus: SCL and SDA go in, transfers come out as the bus's controller would have reported them.

    SCL, SDA --> START, bits, STOP --> Transfer: phases, bytes, ACKs, times

For scenes in which no agent is the controller, so that a budget on transfers has something to listen to.

Source: UM10204 sections 3.1.4 to 3.1.10.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..core.kernel import Kernel
from ..core.wire import Wire, watch
from .i2c_controller import Phase, Transfer
from .i2c_events import EVENT, FALL, IDLE, RISE, SDA, START, STOP


class I2cWatch:
    """told: given each transfer with its STOP. names: what to call a transfer, by address.

    stretched: ticks that the controller has lost to stretching so far; asked at every rising SCL.
    """

    def __init__(
        self,
        kernel: Kernel,
        scl: Wire,
        sda: Wire,
        told: Callable[[Transfer], None],
        stretched: Callable[[], int],
        names: Mapping[int, str],
    ) -> None:
        self._kernel = kernel
        self._lines = IDLE
        self._told = told
        self._stretched = stretched
        self._names = names
        self._lost = 0
        self._transfer: Transfer | None = None
        self._phase = Phase(0, False)
        self._index = -1  # -1: address byte, else the number of the data byte
        self._bits = 0
        self._in = 0
        watch([scl, sda], self._on_lines)

    def _on_lines(self, now: int, levels: int) -> None:
        event = EVENT[self._lines << 2 | levels]
        self._lines = levels
        if event == START:
            self._start(now)
        elif event == STOP:
            self._stop(now)
        elif self._transfer is not None:
            if event == RISE:
                self._rise(now, int(levels >= SDA))
            elif event == FALL and self._bits == 9:
                self._byte_over(now)

    def _start(self, now: int) -> None:
        if self._transfer is None:
            self._transfer = Transfer("", [])
        self._phase = Phase(0, False, start_at=now)
        self._transfer.phases.append(self._phase)
        self._index, self._bits, self._in = -1, 0, 0

    def _stop(self, now: int) -> None:
        transfer, self._transfer = self._transfer, None
        if transfer is not None:
            transfer.stop_at = now
            self._told(transfer)

    def _rise(self, now: int, bit: int) -> None:
        lost, self._lost = self._lost, self._stretched()
        phase = self._phase
        phase.stretch = max(phase.stretch, self._lost - lost)
        if phase.acked and self._index == 0 and self._bits == 0:
            phase.answer_at = now
        self._bits += 1
        self._in = self._in << 1 | bit

    def _byte_over(self, now: int) -> None:
        phase, transfer = self._phase, self._transfer
        assert transfer is not None
        byte, ack = self._in >> 1, not self._in & 1
        if self._index < 0:
            phase.address, phase.read, phase.acked = byte >> 1, bool(byte & 1), ack
            transfer.name = transfer.name or self._names.get(phase.address, f"{phase.address:#04x}")
            if ack:
                phase.answer_from = now
        else:
            phase.acks.append(ack)
            if phase.read:
                phase.got.append(byte)
            else:
                phase.data += bytes([byte])
        self._index += 1
        self._bits = self._in = 0
