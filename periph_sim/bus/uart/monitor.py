"""Listens to a UART line: edges go in; begin, end and byte of each frame come out as records, whoever sent it.

    wire  ──┐___┌───┐___...───┌──────      start bit, data, parity, stop
            begin             end 55       or error 55: the parity is wrong, or the stop bit is low

What a frame carries is read in the middle of each bit. It ends with its last stop bit, or with the start bit of the
next one if that comes first.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from ...core.kernel import Kernel
from ...core.records import Kind, Recorder
from ...core.wire import Wire
from .sender import UartFormat

Line = Callable[[], tuple[Fraction, UartFormat]]


class UartMonitor:
    """line: the length of a bit in ticks, exact, and the format of frames; asked at each start bit."""

    def __init__(self, kernel: Kernel, recorder: Recorder, wire: Wire, line: Line) -> None:
        self._kernel = kernel
        self._recorder = recorder
        self._wire = wire
        self._line = line
        self._start = 0
        self._bit = Fraction(1)
        self._format = UartFormat()
        self._edges: list[tuple[int, int]] = []  # of the frame under way, its start bit's first
        self._ending = 0  # the kernel's promise to end the frame under way; 0 when none is
        wire.watch(self._edge)

    def _edge(self, now: int, level: int) -> None:
        if self._ending and not level and now >= self._at(self._length - Fraction(1, 2)):  # the next start bit
            self._kernel.cancel(self._ending)
            self._end()
        if self._ending:
            self._edges.append((now, level))
        elif not level:
            self._begin(now)

    @property
    def _length(self) -> int:
        """Bits of a frame, start and stop bits included."""
        form = self._format
        return 1 + form.bits + (form.parity != "none") + form.stop

    def _at(self, bits: Fraction | int) -> int:
        """The tick so many bits behind the start of the frame."""
        return self._start + int(bits * self._bit)

    def _begin(self, now: int) -> None:
        self._bit, self._format = self._line()
        self._start, self._edges = now, [(now, 0)]
        self._ending = self._kernel.at(self._at(self._length), self._end)
        self._recorder.emit(now, Kind.FRAME, self._wire.name, "begin")

    def _end(self) -> None:
        self._ending = 0
        levels = [self._level(self._at(bit + Fraction(1, 2))) for bit in range(self._length)]
        data = levels[1 : 1 + self._format.bits]
        value = sum(level << place for place, level in enumerate(data))
        good = levels == self._format.levels(value)
        self._recorder.emit(self._kernel.now, Kind.FRAME, self._wire.name, "end" if good else "error", value)

    def _level(self, tick: int) -> int:
        """The level at a tick of the frame under way."""
        return next(level for at, level in reversed(self._edges) if at <= tick)
