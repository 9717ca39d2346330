"""Looks at an SCI receiver: a unit goes in; words waiting, overruns and characters received come out as they change."""

# core: compiled

from __future__ import annotations

from typing import TYPE_CHECKING

from ..bus.receiver_listener import ReceiverListener
from ..core.socket import Onlooker
from ..f28335.sci.register_map import SCI_MAP
from ..processor.dsp import Dsp

if TYPE_CHECKING:
    from ..core.socket import Socket
    from ..core.time import Clock

SCIFFRX, SCIRXST = SCI_MAP["SCIFFRX"].offset, SCI_MAP["SCIRXST"].offset
RXFFST, RXFFST_PLACE = SCI_MAP["SCIFFRX"]["RXFFST"].mask, SCI_MAP["SCIFFRX"]["RXFFST"].lsb
RXFFOVF = SCI_MAP["SCIFFRX"]["RXFFOVF"].mask
RXRDY, OE = SCI_MAP["SCIRXST"]["RXRDY"].mask, SCI_MAP["SCIRXST"]["OE"].mask


class SciMonitor(Onlooker):
    """Looks at a receiver after each input: words in the FIFO, rising overrun flags, characters.

    A character raises RXFFST, without FIFO RXRDY, or an overrun flag.
    """

    _socket: Socket
    _clock: Clock

    def __init__(self, dsp: Dsp, module: str) -> None:
        self._socket = dsp.socket(module)
        self.listeners: list[ReceiverListener] = []
        self._clock = dsp.clock
        self._words = 0
        self._waiting = 0  # words, or the one in SCIRXBUF
        self._overrun = False
        self._socket.watch(self)

    def look(self, cycle: int) -> None:
        fifo = self._socket.chip.peek(cycle, SCIFFRX)
        status = self._socket.chip.peek(cycle, SCIRXST)
        words = (fifo & RXFFST) >> RXFFST_PLACE
        waiting: int = words or int(status & RXRDY > 0)
        overrun: bool = fifo & RXFFOVF > 0 or status & OE > 0
        if words == self._words and waiting == self._waiting and overrun == self._overrun:
            return
        lost: bool
        tick, lost = self._clock.tick(cycle), overrun and not self._overrun
        came: int = waiting - self._waiting
        if lost:
            came = max(came, 1)
        if words != self._words or overrun != self._overrun:
            listener: ReceiverListener
            for listener in self.listeners:
                listener.changed(tick, words, lost)
        self._words, self._waiting, self._overrun = words, waiting, overrun
        while came > 0:
            came -= 1
            for listener in self.listeners:
                listener.received(tick)
