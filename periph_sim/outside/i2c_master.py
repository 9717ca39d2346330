"""An I2C controller at a session's SDA and SCL: each call moves the lines and returns ACKs and bytes.

    start(0x68, read=False)   write(0x3B)        start(0x68, read=True)      read(ack=False)      stop()
    SDA --|__ A6..A0 W [ack]  D7..D0 [ack]    --|__ A6..A0 R [ack]        [D7..D0] N            __|--
    Between the calls of a transfer, the controller holds SCL low, as real adapters do.

Every call advances the session by the time that it takes on the wires, stretching of SCL by other parties included.

Source: UM10204 sections 3.1.4 to 3.1.10 and Table 10.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from ..core.table import frequency
from .errors import ArbitrationLost, OutsideError

if TYPE_CHECKING:
    from .session import Session

LINES = ("SDA", "SCL")
HOLD = Fraction(300, 10**9)  # hold time of SDA in seconds that a controller must provide: UM10204 Table 10, note 3
FASTEST = 5_000_000  # maximum rate in Hz, that of Ultra Fast-mode
PATIENCE = Fraction(25, 1000)  # maximum time in seconds for which others may hold a line: SMBus section 3.1.1.3


class Master:
    """A controller that external code calls.

    rate: the frequency of SCL without stretching, as a text; SCL is low for one half of the period and high for the
        other half.
    held: True between two calls of a transfer, while this controller holds SCL low.

    The constructor raises OutsideError if SDA or SCL does not lead outside. Methods raise it in these cases:

    - an argument is invalid, or calls are made in the wrong order
    - another party holds SDA low at a START or STOP
    - another party holds SDA or SCL low for more than 25 ms
    - another controller wins the bus (`ArbitrationLost`)
    """

    _reads: bool  # True if the present transfer reads; valid while `held` is True

    def __init__(self, session: Session) -> None:
        missing = [line for line in LINES if line not in session.lines]
        if missing:
            who = f"{' and '.join(missing)} of case {session.case.name}"
            raise OutsideError(f"{who} {'do' if len(missing) > 1 else 'does'} not lead outside; name both")
        self._session = session
        self._fell = 0  # the tick of the last falling edge of SCL; valid while `held` is True
        self.held = False
        self.rate = "100 kHz"

    @property
    def rate(self) -> str:
        return self._rate

    @rate.setter
    def rate(self, text: str) -> None:
        try:
            rate = frequency(text)
        except ValueError:
            rate = Fraction(0)
        if not 0 < rate <= FASTEST:
            raise OutsideError(f"rate {text!r}: expected a frequency above 0 and up to 5 MHz, as in '400 kHz'")
        half = self._session.ticks_per_second / (2 * rate)
        self._half = max(1, round(half))
        self._hold = min(round(HOLD * self._session.ticks_per_second), self._half // 2)
        self._rate = text

    @property
    def reads(self) -> bool:
        """True during a transfer that reads."""
        return self.held and self._reads

    @property
    def writes(self) -> bool:
        return self.held and not self._reads

    # Calls --------------------------------------------------------------------------

    def start(self, address: int, read: bool = False) -> bool:
        """Send a START, or a repeated START within a transfer, and the address. Return True if a target answers ACK."""
        if type(address) is not int or not 0 <= address < 0x80:
            shown = f"{address:#x}" if type(address) is int else repr(address)
            raise OutsideError(f"address {shown}: expected 0 to 0x7f")
        if self.held:
            self._put_sda(1)
            self._rise()
            self._wait(self._half)
        else:
            self._wait_for_idle()
        if not self._session.level("SDA"):
            raise OutsideError("START is impossible: SDA is low, held by another party")
        self._move("SDA", 0)
        self._wait(self._half)
        self._fall()
        self._reads = read
        return self._byte(address << 1 | read)

    def write(self, *values: int) -> bool:
        """Send bytes up to the first that is not acknowledged. Return True if all were acknowledged."""
        if not self.writes:
            raise OutsideError("write: there is no transfer to write in; begin one with start(address)")
        for value in values:
            if type(value) is not int or not 0 <= value <= 0xFF:
                raise OutsideError(f"write: {value!r} is no byte")
        return all(self._byte(value) for value in values)

    def read(self, ack: bool) -> int:
        """Read a byte. ack: False to answer with NACK, as required after the last byte."""
        if not self.reads:
            raise OutsideError("read: there is no transfer to read in; begin one with start(address, read=True)")
        value = 0
        for _ in range(8):
            value = value << 1 | self._bit(1)
        self._bit(0 if ack else 1)
        return value

    def bits(self, *levels: int) -> list[int]:
        """Send clock pulses for single bits, for example for a part of a byte. Return the level of SDA in each bit.

        levels: for each bit, 1 to release SDA and 0 to pull it low.

        The target counts these bits like those of whole bytes. A START or STOP may follow after any number of bits.
        """
        if not self.held:
            raise OutsideError("bits: there is no transfer to clock bits in; begin one with start(address)")
        if any(level not in (0, 1) for level in levels):
            raise OutsideError(f"bits: found {levels}, expected 0, pulled low, or 1, let go")
        return [self._bit(level) for level in levels]

    def stop(self) -> None:
        """Send a STOP. The bus is free afterwards."""
        if not self.held:
            raise OutsideError("stop: there is no transfer to end")
        self._put_sda(0)
        self._rise()
        self._wait(self._half)
        self._move("SDA", 1)
        self._wait(self._half)
        self.held = False
        if not self._session.level("SDA"):
            raise OutsideError("STOP is impossible: SDA is low, held by another party")

    def clear(self) -> bool:
        """Free SDA, which a target may hold low, by nine clock pulses and a STOP. Return True if both lines are high.

        A transfer in progress is aborted. If another party holds SCL low, no pulses are sent. Source: UM10204 section
        3.1.16.
        """
        self.let_go()
        if not self._session.level("SCL"):
            return False
        self._fall()
        try:
            for _ in range(9):
                self._bit(1)
            self.stop()
        except OutsideError:
            self.let_go()
        return all(self._session.level(line) for line in LINES)

    def let_go(self) -> None:
        """Release both lines in the next tick, without a STOP."""
        session = self._session
        session.apply(session.now, dict.fromkeys(LINES, 1))
        session.advance(session.now + 1)
        self.held = False

    def transfer(self, address: int, data: Sequence[int] = b"", count: int = 0) -> bytes | None:
        """Write `data` to an address, and then read `count` bytes after a repeated START. Either part may be empty.

        If both are empty, only the address is sent. Return the bytes that were read, b"" if `count` is 0; None after a
        NACK of the target.
        """
        if type(count) is not int or count < 0:
            raise OutsideError(f"count {count!r}: expected the number of bytes to read, 0 or more")
        try:
            sent = bytes(data)
        except (TypeError, ValueError):
            raise OutsideError(f"data {data!r}: expected bytes, as in b'\\x00' or [0]") from None
        acked = True
        if sent or not count:
            acked = self.start(address) and self.write(*sent)
        got = bytearray()
        if acked and count:
            acked = self.start(address, read=True)
            got.extend(self.read(ack=n + 1 < count) for n in range(count if acked else 0))
        self.stop()
        return bytes(got) if acked else None

    # Bits ---------------------------------------------------------------------------

    def _byte(self, value: int) -> bool:
        for place in range(7, -1, -1):
            sent = value >> place & 1
            if self._bit(sent) != sent:
                self.let_go()
                raise ArbitrationLost("another controller has won the bus; begin again when it is free")
        return not self._bit(1)

    def _bit(self, level: int) -> int:
        """Send one clock pulse, with SDA at `level`. Return SDA's level at the end of SCL's high time."""
        self._put_sda(level)
        self._rise()
        self._wait(self._half)
        seen = self._session.level("SDA")
        self._fall()
        return seen

    def _put_sda(self, level: int) -> None:
        """Move SDA to `level` at the end of the hold time after SCL's falling edge, or now if that time is past."""
        self._move("SDA", level, self._fell + self._hold)

    def _rise(self) -> None:
        """Release SCL at the end of its low time, and wait until it is high."""
        self._move("SCL", 1, self._fell + self._half)
        self._wait_high("SCL")

    def _fall(self) -> None:
        self._fell = self._session.now
        self.held = True
        self._move("SCL", 0)

    def _move(self, line: str, level: int, due: int = 0) -> None:
        """Move a line at tick `due`, or now if that is past. Then advance to the tick after the move."""
        session = self._session
        at = max(due, session.now)
        session.apply(at, {line: level})
        session.advance(at + 1)

    def _wait(self, ticks: int) -> None:
        """Advance to the tick that is `ticks` ticks after the last edge. The last edge is at `now` - 1."""
        self._session.advance(self._session.now + ticks - 1)

    def _wait_high(self, line: str) -> None:
        session = self._session
        limit = session.now + round(PATIENCE * session.ticks_per_second)
        while not session.level(line):
            due = session.next_output()
            if due is None or due > limit:
                session.advance(limit)
                who = " and ".join(session.scene.wires[line].held_by()) or "no party"
                self.let_go()
                raise OutsideError(f"{line} is held low by {who} for more than 25 ms; the bus was let go")
            session.advance(due + 1)

    def _wait_for_idle(self) -> None:
        for line in LINES:
            self._wait_high(line)
