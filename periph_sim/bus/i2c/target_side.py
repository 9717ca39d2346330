"""The wire side of any I2C target: SCL and SDA go in, ACKs and bytes come out; what to say somebody else knows.

    SCL, SDA --> START, bits, STOP --> whom? --> Reply: sends(byte), hears(byte, value) --> SDA
                                                 on_end(stop, whole)

Each START with an address asks `answer` for a reply. A bit changes `hold` after SCL fell. It stretches only where
the reply says so, or who answers calls `hold_clock` meanwhile.

Source: UM10204 sections 3.1.4 to 3.1.10.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import Protocol

from ...core.kernel import Agent, Kernel
from ...core.wire import Wire, watch
from .line_events import EVENT, FALL, IDLE, RISE, SDA, START

Stretches = tuple[tuple[int, int, int], ...]


class Reply(Protocol):
    """To one START with its address.

    stretches: (byte, bit, ticks) where SCL stays low for so long after its fall, before that bit. Byte -1 is the
    address, of which only bit 8, the ACK, can be stretched: before it nobody knows who is meant.
    """

    @property
    def ack(self) -> bool: ...

    @property
    def stretches(self) -> Stretches: ...

    def sends(self, byte: int) -> int:
        """Data byte number 0, 1, ... of a read; asked once, when its first bit is due."""

    def hears(self, byte: int, value: int) -> bool:
        """Data byte number 0, 1, ... of a write has come. True acknowledges it."""


class _Does(Enum):
    NOTHING = "nothing"  # not meant, or no START yet
    ADDRESS = "hears an address"
    HEARS = "hears data"
    SENDS = "sends data"


def _ignore(stop: bool, whole: bool) -> None:
    """Nobody asked for ends."""


class TargetSide(Agent):
    """answer: given the address byte, R/W included. hold: ticks from SCL's fall to its change of SDA.

    on_end: told when a phase that `answer` acknowledged ends, by a STOP or else by another START; whole: not in the
    middle of a byte.
    """

    def __init__(
        self,
        kernel: Kernel,
        scl: Wire,
        sda: Wire,
        answer: Callable[[int], Reply | None],
        hold: int,
        who: str,
        on_end: Callable[[bool, bool], None] = _ignore,
    ) -> None:
        self.who = who
        self._kernel = kernel
        self._sda = sda.attach(who)
        self._scl = scl.attach(who)
        self._lines = IDLE
        self._hold = hold
        self._answer = answer
        self._does = _Does.NOTHING
        self._reply: Reply | None = None
        self._stretches: dict[tuple[int, int], int] = {}  # of this reply: (byte, bit) -> ticks
        self._bit = 0  # rising SCL of this byte so far
        self._in = 0
        self._out = 0xFF
        self._byte = 0  # number of the data byte
        self._refused = False  # the controller's NACK in a read
        self._level = 1  # what SDA gets
        self._on_end = on_end
        self._taken = False  # the phase under way is acknowledged
        self._held_until = 0
        self._powered = True
        watch([scl, sda], self)

    def sampled(self, now: int, levels: int) -> None:
        event = EVENT[self._lines << 2 | levels]
        self._lines = levels
        if event == FALL:
            if self._does is not _Does.NOTHING:
                self._fall()
        elif event == RISE:
            if self._does is not _Does.NOTHING:
                self._rise(int(levels >= SDA))
        elif event:
            if self._taken:
                self._taken = False
                self._on_end(event != START, self._bit <= 1)  # SCL has risen once for the START or STOP itself
            self._does = _Does.ADDRESS if event == START and self._powered else _Does.NOTHING
            self._bit = self._in = 0
            self._stretches = {}
            self._put(1)

    def _fall(self) -> None:
        if self._bit == 8:
            self._put(self._ninth())
        elif self._bit == 9:
            self._byte_over()
        elif self._does is _Does.SENDS and self._bit:
            self._put(self._out >> (7 - self._bit) & 1)
        if self._stretches:
            self._stretch()

    def _stretch(self) -> None:
        """SCL has fallen: hold it, if the reply does so before the bit that comes."""
        byte = -1 if self._does is _Does.ADDRESS else self._byte
        ticks = self._stretches.pop((byte, self._bit), 0)
        if ticks:
            self.hold_clock(ticks)

    def hold_clock(self, ticks: int) -> None:
        """Hold SCL low from now on for so long. Call it from `answer`, `sends` or `hears`: SCL has just fallen then."""
        self._scl.drive(0)
        self._held_until = max(self._held_until, self._kernel.now + ticks)
        self._kernel.at(self._kernel.now + ticks, self._let_go)

    def power(self, on: bool) -> None:
        """Off: both lines are let go at once, and no START is seen until power comes back."""
        self._powered = on
        if not on:
            self._does, self._taken = _Does.NOTHING, False
            self._level = 1
            self._held_until = 0
            self._sda.drive(1)
            self._scl.drive(1)

    def _let_go(self) -> None:
        if self._kernel.now >= self._held_until:
            self._scl.drive(1)

    def _rise(self, level: int) -> None:
        self._bit += 1
        if self._bit <= 8:
            self._in = self._in << 1 | level
        elif self._does is _Does.SENDS:
            self._refused = level == 1

    def _ninth(self) -> int:
        """SDA for the ninth bit, once eight are over."""
        if self._does is _Does.SENDS:
            return 1
        if self._does is _Does.ADDRESS:
            self._reply = self._answer(self._in)
            if self._reply is None:
                return 1
            self._stretches = {(byte, bit): ticks for byte, bit, ticks in self._reply.stretches}
            return int(not self._reply.ack)
        assert self._reply is not None
        return int(not self._reply.hears(self._byte, self._in))

    def _byte_over(self) -> None:
        self._bit = 0
        if self._does is _Does.ADDRESS:
            self._byte = 0
            meant = self._taken = self._reply is not None and self._reply.ack
            self._does = _Does.NOTHING if not meant else _Does.SENDS if self._in & 1 else _Does.HEARS
        else:
            self._byte += 1
            if self._does is _Does.SENDS and self._refused:
                self._does = _Does.NOTHING
        self._in = 0
        if self._does is _Does.SENDS:
            assert self._reply is not None
            self._out = self._reply.sends(self._byte)
            self._put(self._out >> 7)
        else:
            self._put(1)

    def _put(self, level: int) -> None:
        if level != self._level:
            self._level = level
            self._kernel.at(self._kernel.now + self._hold, self._drive)

    def _drive(self) -> None:
        self._sda.drive(self._level)
