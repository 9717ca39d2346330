"""I2C targets that answer as they once did: lists of answers by address go in; ACKs and bytes on the wires come out.

    SCL, SDA --> START, bits, STOP --> address known? next answer --> SDA

It stands for the devices of a bus that are not the one under test. It stretches where its answer says so. An address
without answers left is not acknowledged.

Source: UM10204 sections 3.1.4 to 3.1.10.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum

from ..core.kernel import Kernel
from ..core.wire import Wire


@dataclass(frozen=True, slots=True)
class Answer:
    """To one START with its address. data: sent in a read, ones follow. acks: of the bytes written; then all ACK.

    stretches: (byte, bit, ticks) where SCL stays low for so long after its fall, before that bit. Byte -1 is the
    address, of which only bit 8, the ACK, can be stretched: before it nobody knows who is meant.
    """

    ack: bool
    data: bytes = b""
    acks: tuple[bool, ...] = ()
    stretches: tuple[tuple[int, int, int], ...] = ()


class _Does(Enum):
    NOTHING = "nothing"  # not meant, or no START yet
    ADDRESS = "hears an address"
    HEARS = "hears data"
    SENDS = "sends data"


class I2cTarget:
    """hold: ticks from SCL's fall to its change of SDA."""

    def __init__(
        self,
        kernel: Kernel,
        scl: Wire,
        sda: Wire,
        answers: Mapping[int, Iterable[Answer]],
        hold: int,
        who: str = "targets",
    ) -> None:
        self.who = who
        self._kernel = kernel
        self._scl_wire = scl
        self._sda_wire = sda
        self._sda = sda.attach(who)
        self._scl = scl.attach(who)
        self._hold = hold
        self._answers = {address: deque(of) for address, of in answers.items()}
        self._does = _Does.NOTHING
        self._answer = Answer(False)
        self._stretches: dict[tuple[int, int], int] = {}  # of this answer: (byte, bit) -> ticks
        self._bit = 0  # rising SCL of this byte so far
        self._in = 0
        self._byte = 0  # number of the data byte
        self._refused = False  # the controller's NACK in a read
        self._level = 1  # what SDA gets
        scl.watch(self._scl_changed)
        sda.watch(self._sda_changed)

    def _sda_changed(self, now: int, level: int) -> None:
        if self._scl_wire.level:
            self._does = _Does.NOTHING if level else _Does.ADDRESS
            self._bit = self._in = 0
            self._stretches = {}
            self._put(1)

    def _scl_changed(self, now: int, level: int) -> None:
        if self._does is _Does.NOTHING:
            return
        if level:
            self._rise()
        elif self._bit == 8:
            self._put(self._ninth())
        elif self._bit == 9:
            self._byte_over()
        elif self._does is _Does.SENDS and self._bit:
            self._put(self._sent() >> (7 - self._bit) & 1)
        if not level and self._stretches:
            self._stretch()

    def _stretch(self) -> None:
        """SCL has fallen: hold it, if the answer does so before the bit that comes."""
        byte = -1 if self._does is _Does.ADDRESS else self._byte
        ticks = self._stretches.pop((byte, self._bit), 0)
        if ticks:
            self._scl.drive(0)
            self._kernel.at(self._kernel.now + ticks, self._let_go)

    def _let_go(self) -> None:
        self._scl.drive(1)

    def _rise(self) -> None:
        level = self._sda_wire.level
        self._bit += 1
        if self._bit <= 8:
            self._in = self._in << 1 | level
        elif self._does is _Does.SENDS:
            self._refused = bool(level)

    def _ninth(self) -> int:
        """SDA for the ninth bit, once eight are over."""
        if self._does is _Does.SENDS:
            return 1
        if self._does is _Does.ADDRESS:
            waiting = self._answers.get(self._in >> 1)
            self._answer = waiting.popleft() if waiting else Answer(False)
            self._stretches = {(byte, bit): ticks for byte, bit, ticks in self._answer.stretches}
            return int(not self._answer.ack)
        acks = self._answer.acks
        return int(self._byte < len(acks) and not acks[self._byte])

    def _byte_over(self) -> None:
        self._bit = 0
        if self._does is _Does.ADDRESS:
            self._byte = 0
            read = self._in & 1
            self._does = _Does.NOTHING if not self._answer.ack else _Does.SENDS if read else _Does.HEARS
        else:
            self._byte += 1
            if self._does is _Does.SENDS and self._refused:
                self._does = _Does.NOTHING
        self._in = 0
        self._put(self._sent() >> 7 if self._does is _Does.SENDS else 1)

    def _sent(self) -> int:
        data = self._answer.data
        return data[self._byte] if self._byte < len(data) else 0xFF

    def _put(self, level: int) -> None:
        if level != self._level:
            self._level = level
            self._kernel.at(self._kernel.now + self._hold, self._drive)

    def _drive(self) -> None:
        self._sda.drive(self._level)
