"""The other end of an SCI's lines, which sends and receives bytes like a serial port.

    write --queue--> frames, bit by bit --apply--> RX --> SCI
    read  <--bytes-- decoder <----------- TX <-- SCI

The client's rate and format define the bit times on the wire, so that a mismatch causes framing errors and breaks, as
between two real ports. A frame is put on the line when time reaches it, so the queue contains bytes and not edges.
"""

from __future__ import annotations

import re
from collections import deque
from fractions import Fraction
from typing import TYPE_CHECKING, Literal

from ..bus.uart.frame_format import UartFormat
from ..bus.uart.reader import Heard, UartReader
from ..core.chip import NEVER
from ..scene.case.model import BadCase
from ..scene.case.wiring import sci_named
from .errors import OutsideError

if TYPE_CHECKING:
    from .session import Session

PARITIES = {"n": "none", "o": "odd", "e": "even"}
PORT = re.compile(r"sci-?([abc])", re.IGNORECASE)

Wrong = Literal["", "parity", "stop"]
WRONG = ("", "parity", "stop")
# Seconds; a client's waiting bytes are sent even if another client connects if they take no longer than this.
LAST = Fraction(1, 10)


class SerialLine:
    """The other end of one SCI's lines.

    rx: the name of the wire RX.
    received: number of received bytes.
    wrong: number of received bytes with a wrong parity or stop bit.
    waiting: number of bytes that are not on the line yet.
    sent: number of bytes that were put on the line.
    broken: True if RX is low for a break, or will be when all waiting bytes have been sent.
    """

    def __init__(self, session: Session, rx: str, tx: str, baud: int, form: str) -> None:
        self._session = session
        self.rx = rx
        self.wrong = self.sent = self.received = 0
        self.waiting = 0
        self._got = bytearray()
        self._queue: deque[tuple[bytes, Wrong] | int] = deque()  # bytes, or RX's level for a break
        self._place = 0  # index of the next byte in the first entry of `_queue`
        self._begins: deque[int] = deque()  # ticks of start bits that are on the line but that time has not reached yet
        self.broken = False
        self._parts = 1  # number of parts into which a tick is divided, so that a bit is a whole number of parts
        self._free = 0  # the time from which the line may carry the next frame, in parts of a tick
        self.set(baud, form)
        reader = UartReader(session.scene.wire(tx), lambda: (self._bit, self._format))
        reader.on_end.append(self._heard)

    def set(self, baud: int, form: str = "8n1") -> None:
        """Set rate and format from the next frame on. Raise OutsideError if they are invalid."""
        free = self._free_at()
        self._bit, self._format = self.checked(baud, form)
        # Times are counted in parts of a tick, because a frame that follows the previous one may begin between ticks.
        self._parts = self._bit.denominator
        self._parts_of_bit = self._bit.numerator
        self._free = free * self._parts

    def checked(self, baud: int, form: str) -> tuple[Fraction, UartFormat]:
        """Return the length of a bit in ticks, and the frame's format. Raise OutsideError if one of them is invalid."""
        bits, parity, stop = parts_of_format(form)
        if baud < 1 or baud > self._session.ticks_per_second:
            raise OutsideError(f"{baud} baud: expected 1 or more, and no bit shorter than a tick")
        return Fraction(self._session.ticks_per_second, baud), UartFormat(bits, PARITIES[parity], stop)

    def write(self, data: bytes, wrong: Wrong = "") -> None:
        """Queue bytes after those that are waiting. wrong: "parity" or "stop" to send them with this bit inverted."""
        if not isinstance(data, bytes | bytearray | memoryview):
            raise OutsideError(f"{data!r} is not of type bytes; write b'abc' or 'abc'.encode()")
        if wrong not in WRONG:
            raise OutsideError(f"wrong={wrong!r}: expected {' or '.join(map(repr, WRONG[1:]))}")
        if wrong == "parity" and self._format.parity == "none":
            raise OutsideError("wrong parity: the format has none; set one, as in 8e1")
        if data:
            self.hold_break(False)
            self._queue.append((bytes(data), wrong))
            self.waiting += len(data)

    def hold_break(self, on: bool) -> None:
        """Pull RX low after the waiting bytes, until this is called again or bytes are written."""
        if on != self.broken:
            self.broken = on
            self._queue.append(0 if on else 1)

    def send_break(self, length: str) -> None:
        """Pull RX low now for a duration such as "1 ms". Raise OutsideError if bytes are waiting."""
        session = self._session
        if self._queue or self._free_at() > session.now:
            raise OutsideError("a break cannot begin: bytes are on their way; advance first")
        end = session.now + session.ticks(length)
        session.apply(session.now, {self.rx: 0})
        session.apply(end, {self.rx: 1})
        self._free = end * self._parts + self._parts_of_bit

    def next_client(self) -> int:
        """Assign the line to another client. Return the number of waiting bytes of the last client that are discarded.

        Bytes that take less than a tenth of a second are kept, because a program may write them and end.
        """
        lasts = self.waiting * self._format.length * self._bit
        if lasts <= LAST * self._session.ticks_per_second:
            return 0
        discarded, self.waiting = self.waiting, 0
        self._queue.clear()
        self._place = 0
        self._queue.append(1)  # end a break that was held
        self.broken = False
        return discarded

    def read(self, count: int | None = None) -> bytes:
        """Remove and return up to `count` received bytes; all of them if None."""
        count = len(self._got) if count is None else count
        got = bytes(self._got[:count])
        del self._got[:count]
        return got

    def feed(self, until: int) -> None:
        """Put frames that begin before tick `until` on the line. The session calls it before it advances."""
        parts = self._parts
        while self._queue:
            begin = self._begin()
            if begin >= until * parts:
                return
            first = self._queue[0]
            if isinstance(first, int):
                self._session.apply(begin // parts, {self.rx: first})
                # One bit is the minimum length of a break, and the minimum distance of the next frame from its end.
                self._free = begin + self._parts_of_bit
                self._queue.popleft()
                continue
            data, wrong = first
            self._frame(begin, data[self._place], wrong)
            self._place += 1
            self.waiting -= 1
            if self._place == len(data):
                self._queue.popleft()
                self._place = 0

    def next_begin(self) -> int:
        """Return the tick at which a waiting byte or a waiting change of a break moves RX next; NEVER if none waits."""
        return self._begin() // self._parts if self._queue else NEVER

    def _begin(self) -> int:
        """Return the time at which the first entry of `_queue` may begin, in parts of a tick."""
        return max(self._free, self._session.now * self._parts)

    def begins(self, tick: int) -> bool:
        """Return True if a frame begins in this tick. Call it in order of time, for each tick in which RX moves."""
        if not self._begins or self._begins[0] != tick:
            return False
        self._begins.popleft()
        return True

    def _frame(self, begin: int, byte: int, wrong: Wrong) -> None:
        """Put a frame on the line. begin: the time of its start bit, in parts of a tick."""
        form, parts, bit = self._format, self._parts, self._parts_of_bit
        levels = form.levels(byte)
        if wrong == "parity":
            levels[-1 - form.stop] ^= 1
        elif wrong == "stop":
            levels[-form.stop :] = [0] * form.stop
        before, at = 1, begin
        for level in levels:
            if level != before:
                self._session.apply(at // parts, {self.rx: level})
                before = level
            at += bit
        self.sent += 1
        self._begins.append(begin // parts)
        if not before:  # after a low stop bit, the line is high for a bit before the next frame
            self._session.apply(at // parts, {self.rx: 1})
            at += bit
        self._free = at

    def _free_at(self) -> int:
        """Return the first whole tick at which the next frame may begin."""
        return -(-self._free // self._parts)

    def _heard(self, heard: Heard) -> None:
        self._got.append(heard.value)
        self.received += 1
        self.wrong += not heard.good


def parts_of_format(form: str) -> tuple[int, str, int]:
    """Return data bits, parity as a letter, and stop bits of "8n1". Raise OutsideError for an invalid format."""
    match = re.fullmatch(r"([5-8])([noe])([12])", form.strip().lower())
    if match is None:
        raise OutsideError(f"format {form!r}: expected data bits 5 to 8, n, o or e, and 1 or 2 stop bits: 8n1")
    return int(match[1]), match[2], int(match[3])


def module_of(port: str) -> str:
    """Return the module of a port: "SCI-A" for "scia"; any other name is returned as it is."""
    plain = PORT.fullmatch(port)
    return f"SCI-{plain[1].upper()}" if plain else port


def serial_line(session: Session, port: str, baud: int, form: str) -> tuple[str, SerialLine]:
    """Return the name of a port's SCI, and its other end.

    Raise OutsideError if there is no such SCI, or if its RX does not lead outside.
    """
    try:
        sci = sci_named(session.case, module_of(port), "outside")
    except BadCase as error:
        raise OutsideError(str(error)) from None
    if sci.rx not in session.lines:
        who = f"{sci.rx} of {sci.unit}.{sci.module}"
        raise OutsideError(f"{who} does not lead outside; give it to the session: outside=({sci.rx!r}, ...)")
    return f"{sci.unit}.{sci.module}", SerialLine(session, sci.rx, sci.tx, baud, form)
