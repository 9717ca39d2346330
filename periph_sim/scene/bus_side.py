"""Transfers and rounds on a scene's I2C bus, derived from its wires and the master's requests.

    SCL, SDA --I2cMonitor--> transfers --BusRounds--> transfers with their requests, rounds

The monitor is created only when the first subscriber needs it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from ..core.time import NO_TIME
from ..timing.rounds import BusRounds, MasterSchedule
from .plugins import sensors_of

if TYPE_CHECKING:
    from ..bus.i2c.bit_skip import BitSkip
    from ..bus.i2c.monitor import I2cMonitor
    from ..bus.i2c.transfer import Transfer
    from ..core.wire import Wire
    from .case.model import Case

SPIKE = Fraction(50, 10**9)  # seconds; the monitor ignores shorter pulses on SDA (UM10204 Table 10, tSP)


class BusSide:
    """The transfers and rounds of a scene's bus.

    asked: the requests of the master and their schedule; None if they are not known.
    spike: the monitor ignores pulses on SDA that are shorter than this number of ticks.
    before: callbacks that receive each transfer before all other subscribers.
    monitor: the monitor of the wires; None before the first use of `rounds`, and in scenes without a bus.
    wire_bytes: number of bytes in all transfers that were passed to `count`.
    nacked: number of transfers that `count_nacked` counted.
    bit_skip: the object that simulates the first seven bits of a byte in one step; None if each bit is simulated.
    """

    def __init__(self, case: Case, wires: Mapping[str, Wire], spike: int) -> None:
        self._case = case
        self.asked: MasterSchedule | None = None
        self.before: list[Callable[[Transfer], None]] = []
        self.wire_bytes = self.nacked = 0
        self.bit_skip: BitSkip | None = None
        self._wires = wires
        self._spike = spike
        self.monitor: I2cMonitor | None = None
        self._rounds: BusRounds | None = None

    @property
    def rounds(self) -> BusRounds:
        """The rounds on the bus. The first use creates the monitor, so earlier transfers belong to no round."""
        if self._rounds is None:
            self._rounds = BusRounds(self.asked, self._begun_at)
            if "SCL" in self._wires:
                from ..bus.i2c.monitor import I2cMonitor

                names = {sensor.address: name for name, sensor in sensors_of(self._case).items()}
                self.monitor = I2cMonitor(self._wires["SCL"], self._wires["SDA"], self._on_transfer, names, self._spike)
        return self._rounds

    @property
    def period(self) -> int:
        """Number of ticks, rounded down, from one round to the next; 0 if the requests are not known."""
        return 0 if self.asked is None else int(self.asked.period // 1)

    @property
    def starts(self) -> Sequence[int]:
        """The ticks at which the rounds are due; empty if the case does not list these times."""
        return () if self.asked is None else self.asked.starts or ()

    def count(self, transfer: Transfer) -> None:
        """Add the bytes of a transfer of the controller agent to `wire_bytes`, and call `count_nacked`."""
        self.wire_bytes += transfer.wire_bytes
        self.count_nacked(transfer)

    def count_nacked(self, transfer: Transfer) -> None:
        """Count a transfer in `nacked` if it was not acknowledged.

        If [rounds] has `ack_polling = true`, a write of only the address does not count, because the master uses it to
        find out whether an EEPROM is ready.
        """
        first = transfer.phases[0]
        polls = self.asked is not None and self.asked.ack_polling and not first.read and not first.data
        self.nacked += not transfer.acked and not polls

    @property
    def passed(self) -> int:
        """The number of bytes whose first seven bits were simulated in one step."""
        return 0 if self.bit_skip is None else self.bit_skip.passed

    def finish(self, now: int) -> None:
        """Report the rounds that were missed before tick `now`, the end of the run."""
        if self._rounds is not None:
            self._rounds.finish(now)

    def _begun_at(self) -> int:
        return NO_TIME if self.monitor is None else self.monitor.begun_at

    def _on_transfer(self, transfer: Transfer) -> None:
        for callback in self.before:
            callback(transfer)
        self.rounds.transfer(transfer)
