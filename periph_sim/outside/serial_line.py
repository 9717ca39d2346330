"""The other end of an SCI's lines, which sends and receives bytes like a serial port.

    write --queue--> frames, bit by bit --apply--> RX --> SCI
    read  <--bytes-- decoder <----------- TX <-- SCI

The client's rate and format define the bit times on the wire. A mismatch with the SCI's settings therefore causes
framing errors and breaks, as between two real ports. Waiting bytes stay in a queue. The edges of a frame are scheduled
just before the session reaches its start bit.
"""

from __future__ import annotations

import re
from collections import deque
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Literal

from ..bus.uart.frame_format import UartFormat
from ..bus.uart.reader import LineFrame, UartReader
from ..core.chip import NEVER
from ..scene.case.model import BadCase, Case
from ..scene.case.wiring import SciLines, sci_named
from .errors import OutsideError

if TYPE_CHECKING:
    from .session import Session

PARITIES = {"n": "none", "o": "odd", "e": "even", "m": "none", "s": "none"}
NINTH = {"m": 1, "s": 0}  # level of the parity bit for mark and space parity; the SCI receives it as an address bit
PORT = re.compile(r"sci-?([abc])", re.IGNORECASE)

Wrong = Literal["", "parity", "stop"]
WRONG = ("", "parity", "stop")
# When the client changes, the waiting bytes of the previous client are still sent if this takes at most LAST seconds.
LAST = Fraction(1, 10)


class SerialLine:
    """The other end of one SCI's lines.

    rx: the name of the wire that is the SCI's RX.
    received: number of bytes received from the SCI.
    wrong: number of received bytes with a wrong parity, stop or address bit.
    waiting: number of bytes in the queue, whose edges have not been scheduled.
    sent: number of bytes whose edges have been scheduled.
    broken: True from the request for a break (`hold_break`) to the request for its end, which may be a `write`.
    """

    def __init__(self, session: Session, rx: str, tx: str, baud: int, form: str) -> None:
        self._session = session
        self.rx = rx
        self.wrong = self.sent = self.received = 0
        self.waiting = 0
        self._got = bytearray()
        # An entry is (bytes that were not sent yet, name of the bit to send wrong, ninth bit), or the level to which RX
        # moves to begin (0) or to end (1) a break.
        self._queue: deque[tuple[bytearray, Wrong, int] | int] = deque()
        self._begins: deque[int] = deque()  # ticks of the future start bits that are already scheduled
        self.broken = False
        self._parts = 1  # number of parts into which a tick is divided, so that a bit is a whole number of parts
        self._free = 0  # the earliest time for the next frame, in units of 1 / `_parts` tick
        self.set(baud, form)
        reader = UartReader(session.scene.wire(tx), lambda: (self._bit, self._format))
        reader.on_end.append(self._on_character)

    def set(self, baud: int, form: str = "8n1") -> None:
        """Set the rate and format of all later frames. Raise OutsideError if the rate or the format is invalid.

        Waiting bytes are sent with the new rate and format. There is one exception: if the new parity is mark or space,
        the parity bit of a waiting byte is 1 if the parity was mark when the byte was written, else 0. If the new
        format has no parity bit, bytes whose parity bit should be wrong are sent without an error.
        """
        free = self._free_at()
        self._bit, self._format = self.checked(baud, form)
        self._ninth = NINTH.get(parts_of_format(form)[1], 0)
        # The unit of times is 1 / `_parts` tick, because the next frame may begin between two ticks.
        self._parts = self._bit.denominator
        self._parts_of_bit = self._bit.numerator
        self._free = free * self._parts

    def checked(self, baud: int, form: str) -> tuple[Fraction, UartFormat]:
        """Return the length of a bit in ticks, and the frame's format. Raise OutsideError if one of them is invalid."""
        bits, parity, stop = parts_of_format(form)
        if baud < 1 or baud > self._session.ticks_per_second:
            raise OutsideError(f"{baud} baud: expected 1 or more, and no bit shorter than a tick")
        return Fraction(self._session.ticks_per_second, baud), UartFormat(bits, PARITIES[parity], stop, parity in NINTH)

    def write(self, data: bytes, wrong: Wrong = "") -> None:
        """Append bytes to the queue. wrong: "parity" or "stop" to send this bit of each byte with the wrong level.

        Raise OutsideError if `data` is not of a type like bytes, or if a parity bit should be wrong and there is none.
        """
        if not isinstance(data, bytes | bytearray | memoryview):
            raise OutsideError(f"{data!r} is not of type bytes; write b'abc' or 'abc'.encode()")
        if wrong not in WRONG:
            raise OutsideError(f"wrong={wrong!r}: expected {' or '.join(map(repr, WRONG[1:]))}")
        if wrong == "parity" and not has_parity_bit(self._format):
            raise OutsideError("wrong parity: the format has none; set one, as in 8e1")
        if data:
            self.hold_break(False)
            self._queue.append((bytearray(data), wrong, self._ninth))
            self.waiting += len(data)

    def hold_break(self, on: bool) -> None:
        """Begin (True) or end (False) a break after the waiting bytes. A later `write` also ends the break."""
        if on != self.broken:
            self.broken = on
            self._queue.append(0 if on else 1)

    @property
    def is_idle(self) -> bool:
        """True if nothing is in the queue and the last frame has ended."""
        return not self._queue and self._free_at() <= self._session.now

    def send_break(self, length: str) -> None:
        """Pull RX low now for a duration such as "1 ms".

        Raise OutsideError if bytes are waiting or the last frame has not ended, and ValueError if `length` is invalid.
        """
        session = self._session
        if not self.is_idle:
            raise OutsideError("a break cannot begin: bytes are on their way; advance first")
        end = session.now + session.ticks(length)
        session.apply(session.now, {self.rx: 0})
        session.apply(end, {self.rx: 1})
        self._free = end * self._parts + self._parts_of_bit

    def next_client(self) -> int:
        """Assign the line to another client. Return the number of discarded bytes of the previous client.

        Waiting bytes are kept if they take at most a tenth of a second, because a program may end just after a write.
        Otherwise they are discarded, and a break of the previous client ends.
        """
        lasts = self.waiting * self._format.length * self._bit
        if lasts <= LAST * self._session.ticks_per_second:
            return 0
        discarded, self.waiting = self.waiting, 0
        self._queue.clear()
        self._queue.append(1)  # ends a break of the previous client
        self.broken = False
        return discarded

    def read(self, count: int | None = None) -> bytes:
        """Remove and return up to `count` received bytes; all of them if None."""
        count = len(self._got) if count is None else count
        got = bytes(self._got[:count])
        del self._got[:count]
        return got

    def feed(self, until: int) -> None:
        """Schedule the edges of all frames that begin before tick `until`. Call this before advancing to this tick."""
        parts = self._parts
        while self._queue:
            begin = self._begin()
            if begin >= until * parts:
                return
            first = self._queue[0]
            if isinstance(first, int):
                self._session.apply(begin // parts, {self.rx: first})
                # A break lasts at least one bit, and the next frame begins at least one bit after its end.
                self._free = begin + self._parts_of_bit
                self._queue.popleft()
                continue
            data, wrong, ninth = first
            self._frame(begin, data[0], wrong, ninth)
            del data[:1]
            self.waiting -= 1
            if not data:
                self._queue.popleft()

    def next_begin(self) -> int:
        """Return the earliest tick at which the first entry of the queue can move RX; NEVER if the queue is empty."""
        return self._begin() // self._parts if self._queue else NEVER

    def _begin(self) -> int:
        """Return the time at which the first entry of `_queue` may begin, in units of 1 / `_parts` tick."""
        return max(self._free, self._session.now * self._parts)

    def begins(self, tick: int) -> bool:
        """Return True if a frame begins in this tick. Call this for each tick in which RX moves, in order of time."""
        if not self._begins or self._begins[0] != tick:
            return False
        self._begins.popleft()
        return True

    def _frame(self, begin: int, byte: int, wrong: Wrong, ninth: int) -> None:
        """Schedule the edges of a frame. begin: the time of its start bit, in units of 1 / `_parts` tick."""
        form, parts, bit = self._format, self._parts, self._parts_of_bit
        levels = form.levels(byte, ninth)
        if wrong == "parity" and has_parity_bit(form):
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
        if not before:  # after a low stop bit, RX is high for one bit before the next frame
            self._session.apply(at // parts, {self.rx: 1})
            at += bit
        self._free = at

    def _free_at(self) -> int:
        """Return the first whole tick at which the next frame may begin."""
        return -(-self._free // self._parts)

    def _on_character(self, character: LineFrame) -> None:
        self._got.append(character.value)
        self.received += 1
        self.wrong += not character.good or character.address != self._ninth


def has_parity_bit(form: UartFormat) -> bool:
    """Return True if a bit follows the data: a parity bit, or the address bit for mark and space parity."""
    return form.parity != "none" or form.address


def parts_of_format(form: str) -> tuple[int, str, int]:
    """Return (data bits, parity, stop bits) of a format: (8, "n", 1) for "8n1". Raise OutsideError if it is invalid."""
    match = re.fullmatch(r"([5-8])([noems])([12])", form.strip().lower())
    if match is None:
        raise OutsideError(f"format {form!r}: expected data bits 5 to 8, n, o, e, m or s, and 1 or 2 stop bits: 8n1")
    return int(match[1]), match[2], int(match[3])


def port_settings(baud: int, form: str) -> dict[str, Any]:
    """Return a rate and a format as the settings of a pyserial port. Raise OutsideError if the format is invalid."""
    bits, parity, stop = parts_of_format(form)
    return {"baudrate": baud, "bytesize": bits, "parity": parity.upper(), "stopbits": stop}


def sci_of(case: Case, port: str) -> SciLines:
    """Return the SCI of a port, such as "scia" or "dsp.SCI-A". Raise OutsideError if the case has no such SCI."""
    plain = PORT.fullmatch(port)
    try:
        return sci_named(case, f"SCI-{plain[1].upper()}" if plain else port, "outside")
    except BadCase as error:
        raise OutsideError(str(error)) from None
