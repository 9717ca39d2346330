"""The sensor head: asks its chips over I2C, round by round, and checks what it gets.

    schedule --> rounds of requests --> I2cController --> transfers --> values, checks, reports

A round is due every period. A request is a register pointer, written with a STOP after it
or with a repeated START, and the read of `count` bytes. A round that cannot begin when it
is due, since the one before still runs, is missed.

Source: the dissertation's section 3.4.2 and Figure A.2 (order, period); data sheets of
ITG-3200 (registers 0x1D to 0x22), ADXL345 (0x32 to 0x37), HMC5883L (0x03 to 0x08).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from random import Random

from ..core.kernel import Kernel
from ..lines.i2c_controller import I2cController, Phase, Transfer


@dataclass(frozen=True)
class ChipData:
    """Where a sensor keeps its three values. big: high byte first. order: which axis comes when."""

    address: int
    pointer: int
    big: bool
    order: tuple[int, int, int] = (0, 1, 2)

    def values(self, data: bytes) -> tuple[int, ...]:
        """The values x, y, z of six bytes read, signed 16-bit."""
        words = [int.from_bytes(data[i : i + 2], "big" if self.big else "little", signed=True) for i in (0, 2, 4)]
        return tuple(words[self.order.index(axis)] for axis in range(3))


CHIPS: dict[str, ChipData] = {
    "gyroscope": ChipData(0x68, 0x1D, big=True),
    "accelerometer": ChipData(0x53, 0x32, big=False),
    "magnetometer": ChipData(0x1E, 0x03, big=True, order=(0, 2, 1)),
}


@dataclass(frozen=True)
class Request:
    """One read or write of a round. pointer None: no pointer is written. write: bytes after the pointer."""

    name: str
    address: int
    pointer: int | None
    count: int
    write: bytes = b""
    expect: bytes | None = None

    def transfers(self, by_stop: bool) -> list[Transfer]:
        """The transfers that make it: one with a repeated START, or two."""
        head = b"" if self.pointer is None else bytes([self.pointer])
        phases: list[Phase] = []
        if head or self.write:
            phases.append(Phase(self.address, read=False, data=head + self.write))
        if self.count:
            phases.append(Phase(self.address, read=True, count=self.count, expect=self.expect))
        if by_stop:
            return [Transfer(self.name, [phase]) for phase in phases]
        return [Transfer(self.name, phases)]


@dataclass(frozen=True)
class Schedule:
    """All in ticks. jitter: each round begins up to this much late, evenly spread."""

    first: int
    period: int
    gap: int  # between two transfers of a round, on top of the bus-free time
    jitter: int = 0
    rounds: int | None = None  # None: as long as the run lasts


@dataclass
class Round:
    """What came of one round. due: when the schedule wanted it; end: its last STOP."""

    number: int
    due: int
    start: int
    end: int = 0
    nacked: int = 0  # requests whose address was not acknowledged
    transfers: int = 0


class SensorHead:
    """on_transfer, on_round: told of each when it is over."""

    def __init__(
        self,
        kernel: Kernel,
        controller: I2cController,
        requests: list[Request],
        schedule: Schedule,
        *,
        by_stop: bool = False,
        seed: int = 0,
    ) -> None:
        self.who = controller.who
        self.controller = controller
        self.missed = 0
        self.rounds = 0  # completed
        self.on_transfer: list[Callable[[Transfer], None]] = []
        self.on_round: list[Callable[[Round], None]] = []
        self._kernel = kernel
        self._requests = requests
        self._schedule = schedule
        self._by_stop = by_stop
        self._random = Random(seed)
        self._due = kernel.now + schedule.first
        self._number = 0
        self._round: Round | None = None
        self._left: list[Transfer] = []
        self._plan()

    @property
    def at_rest(self) -> bool:
        """No round is under way."""
        return self._round is None

    def _plan(self) -> None:
        schedule = self._schedule
        if schedule.rounds is None or self._number < schedule.rounds:
            late = self._random.randrange(schedule.jitter + 1) if schedule.jitter else 0
            self._kernel.at(self._due + late, self._begin)

    def _begin(self) -> None:
        due, self._due = self._due, self._due + self._schedule.period
        self._number += 1
        self._plan()
        if self._round is not None:
            self.missed += 1
            return
        self._round = Round(self._number, due, self._kernel.now)
        self._left = [t for request in self._requests for t in request.transfers(self._by_stop)]
        self._next()

    def _next(self) -> None:
        self.controller.begin(self._left.pop(0), self._over)

    def _over(self, transfer: Transfer) -> None:
        current = self._round
        assert current is not None
        current.transfers += 1
        current.nacked += not transfer.acked
        for told in self.on_transfer:
            told(transfer)
        if self._left:
            self._kernel.at(self._kernel.now + self._schedule.gap, self._next)
            return
        current.end = self._kernel.now
        self._round = None
        self.rounds += 1
        for heard in self.on_round:
            heard(current)
