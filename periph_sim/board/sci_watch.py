"""Looks at an SCI receive FIFO: a unit goes in; words waiting and overruns come out, whenever they change."""

from __future__ import annotations

from collections.abc import Callable

from .dsp import Dsp


class SciWatch:
    """Looks at a receive FIFO after each input: words waiting, and rising overrun flags."""

    def __init__(self, dsp: Dsp, told: Callable[[int, int, bool], None]) -> None:
        self._dsp = dsp
        self._socket = dsp.socket("SCI-A")
        self._told = told
        chip_map = self._socket.chip.MAP
        self._rx, self._status = chip_map["SCIFFRX"], chip_map["SCIRXST"]
        self._words = 0
        self._overrun = False
        self._socket.watch(self._look)

    def _look(self, cycle: int) -> None:
        fifo = self._socket.chip.peek(cycle, self._rx.offset)
        status = self._socket.chip.peek(cycle, self._status.offset)
        words = self._rx["RXFFST"].of(fifo)
        overrun = bool(self._rx["RXFFOVF"].of(fifo) or self._status["OE"].of(status))
        if words != self._words or overrun != self._overrun:
            self._told(self._dsp.clock.tick(cycle), words, overrun and not self._overrun)
            self._words, self._overrun = words, overrun
