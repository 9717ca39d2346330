"""Recorder of the frames of a UART line: begin, end and byte of each.

UartReader --> begin, end 55       or error 55: the parity is wrong, or the stop bit is low
"""

from __future__ import annotations

from ...core.kernel import Kernel
from ...core.records import Kind, Recorder
from ...core.wire import Wire
from .reader import Heard, Line, UartReader


class UartMonitor:
    """Makes FRAME records of one line. line: as for a `UartReader`."""

    def __init__(self, kernel: Kernel, recorder: Recorder, wire: Wire, line: Line) -> None:
        self._begins, self._ends, self._errors = (
            recorder.topic(Kind.FRAME, wire.name, what) for what in ("begin", "end", "error")
        )
        reader = UartReader(kernel, wire, line)
        reader.on_begin.append(self._begin)
        reader.on_end.append(self._end)

    def _begin(self, now: int) -> None:
        self._begins.emit(now)

    def _end(self, heard: Heard) -> None:
        (self._ends if heard.good else self._errors).emit(heard.end, heard.value)
