"""The wire side of any I2C target: ACKs and bytes on SCL and SDA; a `Reply` provides their content.

    SCL, SDA --> START, bits, STOP --> address --> Reply: send_byte(byte), receive_byte(byte, value) --> SDA
                                                 on_end(stop, whole)

`answer` is called for each START with an address and returns the reply. SDA changes `hold` after the fall of SCL. The
target stretches the clock only if the reply has `stretches` or calls `hold_clock`.

Source: UM10204 sections 3.1.4 to 3.1.10.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from ...core.kernel import Kernel
from ...core.sampler import watch
from ...core.state import State
from ...core.wire import Wire
from .bit_skip import ONES, SKIPPED_BITS, BitParty
from .line_events import EVENTS, FALL, IDLE, RISE, SCL, SDA, START

# What the target is doing. NOT_MEANT: nothing, because it is not addressed or the bus is idle.
NOT_MEANT, RECEIVES_ADDRESS, RECEIVES_DATA, SENDS_DATA = range(4)

# Tags of events: DRIVE changes the level of SDA, LET_GO releases SCL.
DRIVE, LET_GO = range(2)

Stretches = tuple[tuple[int, int, int], ...]


class Reply(Protocol):
    """A target's reply to a START and the address that follows it.

    stretches: triples (byte, bit, ticks). SCL is held low for `ticks` after the fall that precedes the bit. Byte -1 is
        the address. In the address, only bit 8, the ACK, can be stretched, because the reply is not known earlier.
    """

    @property
    def ack(self) -> bool: ...

    @property
    def stretches(self) -> Stretches: ...

    def send_byte(self, byte: int) -> int:
        """Return data byte number `byte` of a read, counted from 0. Called once for each byte, before its first bit."""

    def receive_byte(self, byte: int, value: int) -> bool:
        """Receive data byte number `byte` of a write, counted from 0. Return True to acknowledge it."""


class Target(Protocol):
    """A device on the bus. addresses: all addresses that it acknowledges, 7 bits each."""

    @property
    def addresses(self) -> tuple[int, ...]: ...

    def answer(self, address_byte: int) -> Reply | None:
        """Return the reply to an address byte after START; for a NACK, None or a reply whose `ack` is False."""

    def on_end(self, stop: bool, whole: bool) -> None:
        """Handle the end of a phase whose address was acknowledged.

        stop: True for a STOP, False for a repeated START.
        whole: False if the phase ends in the middle of a byte.
        """

    def power_on(self) -> None:
        """Handle the return of the supply. Volatile data are lost."""


def _ignore(stop: bool, whole: bool) -> None:
    """Do nothing: the default for `on_end`."""


class TargetSide(BitParty):
    """The wire side of one target.

    answer: called with each address byte, R/W included; returns the reply, as `Target.answer` does.
    hold: ticks from the fall of SCL to a change of SDA by the target.
    on_end: called with (stop, whole) at the end of each phase whose address was acknowledged. stop: True for a STOP,
        False for a repeated START. whole: True if the phase does not end in the middle of a byte. It is not called if
        the power was switched off during the phase.
    """

    STATE = State(
        "_lines _answer _does _reply _stretches _bit _in _out _byte _refused _level _taken _powered",
        ticks="_held_until",
    )

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
        self._does = NOT_MEANT
        self._reply: Reply | None = None
        self._stretches: dict[tuple[int, int], int] = {}  # stretches of this reply: (byte, bit) -> ticks
        self._bit = 0  # number of rises of SCL in this byte so far
        self._in = 0
        self._out = 0xFF
        self._byte = 0  # number of the present data byte
        self._refused = False  # True if the controller's last acknowledge in a read was a NACK
        self._level = 1  # the level to which the target drives SDA, after the hold time
        self._on_end = on_end
        self._taken = False  # True if the address of the present phase was acknowledged
        self._held_until = 0
        self._powered = True
        watch([scl, sda], self)

    def act(self, tag: int) -> None:
        if tag == DRIVE:
            self._sda.drive(self._level)
        elif self._kernel.now >= self._held_until:
            self._scl.drive(1)

    def sampled(self, now: int, levels: int) -> None:
        event = EVENTS >> 3 * (self._lines << 2 | levels) & 7
        self._lines = levels
        if event == FALL:
            if self._does != NOT_MEANT:
                self._fall()
        elif event == RISE:
            if self._does != NOT_MEANT:
                self._bit += 1
                if self._bit <= 8:
                    self._in = self._in << 1 | levels >> 1
                elif self._does == SENDS_DATA:
                    self._refused = levels >= SDA
        elif event:
            if self._taken:
                self._taken = False
                # `_bit` also counts the rise of SCL before a START or STOP, so it is above 1 in an incomplete byte.
                self._on_end(event != START, self._bit <= 1)
            self._does = RECEIVES_ADDRESS if event == START and self._powered else NOT_MEANT
            self._bit = self._in = 0
            self._stretches = {}
            self._put(1)

    def _fall(self) -> None:
        if self._bit == 8:
            self._put(self._ninth())
        elif self._bit == 9:
            self._byte_over()
        elif self._does == SENDS_DATA and self._bit:
            self._put(self._out >> (7 - self._bit) & 1)
        if self._stretches:
            byte = -1 if self._does == RECEIVES_ADDRESS else self._byte
            ticks = self._stretches.pop((byte, self._bit), 0)
            if ticks:
                self.hold_clock(ticks)

    def hold_clock(self, ticks: int) -> None:
        """Hold SCL low for the next `ticks`. `answer` and the reply call this just after a fall of SCL."""
        self._scl.drive(0)
        self._held_until = max(self._held_until, self._kernel.now + ticks)
        self._kernel.schedule(self._kernel.now + ticks, self, LET_GO)

    def power(self, on: bool) -> None:
        """Switch the power. Without power both lines are released, and STARTs are ignored until the power returns."""
        self._kernel.materialize()
        self._powered = on
        if not on:
            self._does, self._taken = NOT_MEANT, False
            self._level = 1
            self._held_until = 0
            self._sda.drive(1)
            self._scl.drive(1)

    def _ninth(self) -> int:
        """Pass a received byte to `answer` or to the reply. Return the level of SDA for the ninth bit; 0 is ACK.

        After a sent byte, return 1, because the controller acknowledges it.
        """
        if self._does == SENDS_DATA:
            return 1
        if self._does == RECEIVES_ADDRESS:
            self._reply = self._answer(self._in)
            if self._reply is None:
                return 1
            stretches = self._reply.stretches
            if stretches:
                self._stretches = {(byte, bit): ticks for byte, bit, ticks in stretches}
            return int(not self._reply.ack)
        assert self._reply is not None
        return int(not self._reply.receive_byte(self._byte, self._in))

    def _byte_over(self) -> None:
        self._bit = 0
        if self._does == RECEIVES_ADDRESS:
            self._byte = 0
            meant = self._taken = self._reply is not None and self._reply.ack
            self._does = NOT_MEANT if not meant else SENDS_DATA if self._in & 1 else RECEIVES_DATA
        else:
            self._byte += 1
            if self._does == SENDS_DATA and self._refused:
                self._does = NOT_MEANT
        self._in = 0
        if self._does == SENDS_DATA:
            assert self._reply is not None
            self._out = self._reply.send_byte(self._byte)
            self._put(self._out >> 7)
        else:
            self._put(1)

    # Skipped bits ---------------------------------------------------------

    def pulls(self, line: int) -> int:
        return self._scl.mask if line == SCL else self._sda.mask

    def sda_follows_at(self, fall: int) -> int:
        return fall + self._hold

    def ready(self, low: int, high: int, hold: int, each: bool) -> bool:
        """Return True if the first seven bits of the byte can be skipped for this target (see `BitParty.ready`).

        This is so if the target is not addressed, or if all of these conditions hold:
        - The target waits for the first bit of a byte, and the reply has no stretches left.
        - The target's hold time is at least `hold`.
        - The time from the target's change of SDA to the release of SCL is at least `hold` or, if `each` is True, at
          least the target's hold time.
        """
        if self._does == NOT_MEANT:
            return True
        least = self._hold if each else hold
        return not self._bit and not self._stretches and hold <= self._hold <= low - least

    def byte(self) -> int:
        return self._out & ONES if self._does == SENDS_DATA else ONES

    def set_bit_position(self, shown: int, bit: int, fell: int) -> None:
        self._lines = SDA if shown >> (SKIPPED_BITS - bit) & 1 else 0
        if self._does != NOT_MEANT:
            self._bit, self._in = bit, shown >> (SKIPPED_BITS + 1 - bit)
            self._level = self.byte() >> (SKIPPED_BITS - bit) & 1

    def _put(self, level: int) -> None:
        if level != self._level:
            self._level = level
            self._kernel.schedule(self._kernel.now + self._hold, self, DRIVE)
