"""Looks at an SCI receiver: a unit goes in; words waiting, overruns and characters received come out as they change."""

from __future__ import annotations

from collections.abc import Callable

from ..core.socket import Onlooker
from ..processor.dsp import Dsp


class SciMonitor(Onlooker):
    """Looks at a receiver after each input: words in the FIFO, and rising overrun flags. received: told of characters.

    A character raises RXFFST, without FIFO RXRDY, or an overrun flag.
    """

    def __init__(self, dsp: Dsp, module: str) -> None:
        self._dsp = dsp
        self._socket = dsp.socket(module)
        self.told: list[Callable[[int, int, bool], None]] = []
        self.received: list[Callable[[int], None]] = []
        chip_map = self._socket.chip.MAP
        self._rx, self._status = chip_map["SCIFFRX"], chip_map["SCIRXST"]
        self._level, self._ready = self._rx["RXFFST"], self._status["RXRDY"].mask
        self._overruns = self._rx["RXFFOVF"].mask, self._status["OE"].mask
        self._words = 0
        self._waiting = 0  # words, or the one in SCIRXBUF
        self._overrun = False
        self._socket.watch(self)

    def look(self, cycle: int) -> None:
        fifo = self._socket.chip.peek(cycle, self._rx.offset)
        status = self._socket.chip.peek(cycle, self._status.offset)
        words = self._level.of(fifo)
        waiting = words or bool(status & self._ready)
        in_fifo, without = self._overruns
        overrun = bool(fifo & in_fifo or status & without)
        if words == self._words and waiting == self._waiting and overrun == self._overrun:
            return
        tick, lost = self._dsp.clock.tick(cycle), overrun and not self._overrun
        came = max(waiting - self._waiting, int(lost))
        if words != self._words or overrun != self._overrun:
            for told in self.told:
                told(tick, words, lost)
        self._words, self._waiting, self._overrun = words, waiting, overrun
        for _ in range(came):
            for heard in self.received:
                heard(tick)
