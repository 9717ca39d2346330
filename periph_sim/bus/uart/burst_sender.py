"""Sender of bursts of valid or invalid characters, and of breaks.

    burst  --queue--> | character | gap | character |      one burst after the other, never two at once
                      begin                         end

The time at which each bit begins is computed as an exact fraction and then rounded down to a tick, so a long burst does
not drift.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from ...core.kernel import Kernel
from ...core.state import State
from ...core.wire import Pin
from .frame_format import UartFormat
from .rs485 import Driver
from .sender import EdgeSender


class Character(NamedTuple):
    """A character to send.

    address: the address bit, in formats that have one.
    wrong_parity: True if the parity bit is inverted.
    missing_stop: True if the stop bits are 0; then an idle bit follows.
    """

    value: int
    address: int = 0
    wrong_parity: bool = False
    missing_stop: bool = False

    def levels(self, form: UartFormat) -> list[int]:
        levels = form.levels(self.value, self.address)
        if self.wrong_parity:
            levels[-form.stop - 1] ^= 1
        if self.missing_stop:
            levels[-form.stop :] = [0] * form.stop + [1]
        return levels


@dataclass(frozen=True)
class Burst:
    """Characters that are sent together, or a break.

    bit: the exact length of a bit in ticks.
    gap: the number of ticks between two characters.
    low: the length of the break in ticks; 0 for characters.
    idle: the least number of bits from the end of the sender's previous burst to this burst.
    name: the name of the sender, for messages.
    """

    bit: Fraction
    form: UartFormat
    characters: tuple[Character, ...] = ()
    gap: int = 0
    low: int = 0
    idle: int = 0
    name: str = ""

    def edges(self, start: int) -> tuple[list[int], int]:
        """Return the ticks of the edges of a burst that begins at tick `start`, and the tick of the burst's end.

        The first edge is a fall. The burst ends with its last bit, normally a stop bit, or with the end of the break.
        """
        if self.low:
            return [start, start + self.low], start + self.low
        edges: list[int] = []
        level, at = 1, Fraction(start)
        for number, character in enumerate(self.characters):
            if number:
                at += self.gap
            for bit in character.levels(self.form):
                if bit != level:
                    level = bit
                    edges.append(int(at))
                at += self.bit
        return edges, int(at)

    def over_by(self, ticks: int) -> int:
        """Return the number of characters that have ended by `ticks` after the start of the burst."""
        at = Fraction(0)
        for number, character in enumerate(self.characters):
            at += self.bit * len(character.levels(self.form))
            if at > ticks:
                return number
            at += self.gap
        return len(self.characters)


class BurstSender(EdgeSender):
    """Sends bursts at the output `out`: a pin, or a driver that is switched on for each burst.

    hold: the number of ticks for which the driver stays on after a burst. If another burst waits then, the driver stays
        on until `hold` after that burst.
    line: the length of a bit in ticks and the format of the present or last burst; None before the first burst.
    """

    STATE = State("_burst _busy _characters line _waiting", ticks="_began _ends_at _free_at")

    def __init__(self, kernel: Kernel, out: Pin | Driver, who: str, hold: int = 0) -> None:
        EdgeSender.__init__(self, kernel)
        self.who = who
        self._characters = 0  # number of characters of past bursts
        self._burst: Burst | None = None  # the present burst
        self._began = self._ends_at = 0  # ticks at which the present or last burst begins and ends
        self._out = out
        self._driver = out if isinstance(out, Driver) else None
        self._hold = hold
        self._waiting: deque[tuple[Burst, Callable[[int], None], Callable[[int], None]]] = deque()
        self._busy = False
        self._free_at = 0
        self.line: tuple[Fraction, UartFormat] | None = None

    def drive(self, level: int) -> None:
        self._out.drive(level)

    @property
    def characters(self) -> int:
        """The number of characters whose last stop bits are over."""
        under_way = 0 if self._burst is None else self._burst.over_by(self._kernel.now - self._began)
        return self._characters + under_way

    @property
    def busy_with(self) -> tuple[str, int] | None:
        """The name of the present burst, and the tick at which it ends; None between bursts."""
        return None if self._burst is None else (self._burst.name, self._ends_at)

    def send(self, burst: Burst, begins: Callable[[int], None], ends: Callable[[int], None]) -> None:
        """Send a burst when earlier bursts of this sender have been over for at least `Burst.idle` bits.

        begins, ends: functions that are called at the start and at the end of the burst, each with the present tick.
        """
        self._waiting.append((burst, begins, ends))
        if not self._busy:
            self._schedule_burst()

    def _schedule_burst(self) -> None:
        burst = self._waiting[0][0]
        start = max(self._kernel.now, self._free_at + int(burst.idle * burst.bit))
        self._busy = True
        self._kernel.call_at(start, self._begin)

    def _begin(self) -> None:
        burst, begins, ends = self._waiting.popleft()
        now = self._kernel.now
        self.line = burst.bit, burst.form
        edges, end = burst.edges(now)
        self._burst, self._began, self._ends_at = burst, now, end
        if self._driver is not None:
            self._driver.enable(True)
        begins(now)
        if edges:
            self.make(edges[::-1])
        self._kernel.call_at(end, lambda: self._end(ends))

    def _end(self, ends: Callable[[int], None]) -> None:
        self._free_at = self._kernel.now
        if self._burst is not None:
            self._characters += len(self._burst.characters)
            self._burst = None
        if self._driver is not None:
            self._kernel.call_at(self._free_at + self._hold, self._let_go)
        self._busy = False
        ends(self._free_at)
        if self._waiting and not self._busy:
            self._schedule_burst()

    def _let_go(self) -> None:
        if not self._busy and self._driver is not None and self._kernel.now >= self._free_at + self._hold:
            self._driver.enable(False)
