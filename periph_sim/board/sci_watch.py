"""Looks at an SCI receive FIFO: a unit goes in; words waiting and overruns come out, whenever they change."""

from __future__ import annotations

from collections.abc import Callable

from .dsp import Dsp


class SciWatch:
    """Looks at a receive FIFO after each input: words waiting, and rising overrun flags."""

    def __init__(self, dsp: Dsp) -> None:
        self._dsp = dsp
        self._socket = dsp.socket("SCI-A")
        self.told: list[Callable[[int, int, bool], None]] = []
        chip_map = self._socket.chip.MAP
        self._rx, self._status = chip_map["SCIFFRX"], chip_map["SCIRXST"]
        self._level = self._rx["RXFFST"]
        self._overruns = self._rx["RXFFOVF"].mask, self._status["OE"].mask
        self._words = 0
        self._overrun = False
        self._socket.watch(self._look)

    def _look(self, cycle: int) -> None:
        fifo = self._socket.chip.peek(cycle, self._rx.offset)
        status = self._socket.chip.peek(cycle, self._status.offset)
        words = self._level.of(fifo)
        in_fifo, without = self._overruns
        overrun = bool(fifo & in_fifo or status & without)
        if words != self._words or overrun != self._overrun:
            tick, lost = self._dsp.clock.tick(cycle), overrun and not self._overrun
            for told in self.told:
                told(tick, words, lost)
            self._words, self._overrun = words, overrun
