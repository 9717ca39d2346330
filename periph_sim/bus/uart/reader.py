"""Reads a UART line: edges go in; begin and end of each frame, and what it carries, come out, whoever sent it.

    wire  --|___+---|___...---+------      start bit, data, parity, stop
            on_begin          on_end(Heard)

What a frame carries is read in the middle of each bit. It ends with its last stop bit, or with the start bit of the
next one if that comes first.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

from ...core.kernel import Event, Kernel
from ...core.wire import Wire
from .frame_format import UartFormat

Line = Callable[[], tuple[Fraction, UartFormat]]


class Heard(NamedTuple):
    """A frame. good: its parity is right and its stop bits are high. address: its address bit, where it has one."""

    begin: int
    end: int
    value: int
    good: bool
    address: int


class UartReader:
    """line: the length of a bit in ticks, exact, and the format of frames; asked at each start bit."""

    def __init__(self, kernel: Kernel, wire: Wire, line: Line) -> None:
        self.on_begin: list[Callable[[int], None]] = []
        self.on_end: list[Callable[[Heard], None]] = []
        self._kernel = kernel
        self._line = line
        self._start = 0
        self._bit = Fraction(1)
        self._format = UartFormat()
        self._edges: list[tuple[int, int]] = []  # of the frame under way, its start bit's first
        self._ending: Event | None = None  # the kernel's promise to end the frame under way
        wire.watch(self._edge)

    def _edge(self, now: int, level: int) -> None:
        if self._ending and not level and now >= self._at(self._format.length - Fraction(1, 2)):  # the next start bit
            self._kernel.cancel(self._ending)
            self._end()
        if self._ending:
            self._edges.append((now, level))
        elif not level:
            self._begin(now)

    def _at(self, bits: Fraction | int) -> int:
        """The tick so many bits behind the start of the frame."""
        return self._start + int(bits * self._bit)

    def _begin(self, now: int) -> None:
        self._bit, self._format = self._line()
        self._start, self._edges = now, [(now, 0)]
        self._ending = self._kernel.at(self._at(self._format.length), self._end)
        for told in self.on_begin:
            told(now)

    def _end(self) -> None:
        self._ending = None
        form = self._format
        levels = [self._level(self._at(bit + Fraction(1, 2))) for bit in range(form.length)]
        value = sum(level << place for place, level in enumerate(levels[1 : 1 + form.bits]))
        address = levels[1 + form.bits] if form.address else 0
        heard = Heard(self._start, self._kernel.now, value, levels == form.levels(value, address), address)
        for told in self.on_end:
            told(heard)

    def _level(self, tick: int) -> int:
        """The level at a tick of the frame under way."""
        return next(level for at, level in reversed(self._edges) if at <= tick)
