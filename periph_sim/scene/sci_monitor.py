"""Records of an SCI's receiver: words waiting, overruns and characters received.

record     value                                  recorded when
words      number of words in the receive FIFO    this number or RXFFOVF | OE changes
lost       1                                      a character is lost, because 16 wait in the FIFO (RXFFOVF), or without
                                                  FIFO, because the one before was not read (OE)
received   1                                      a character increments RXFFST (without FIFO: sets RXRDY), or
                                                  RXFFOVF | OE becomes 1. Characters lost after this are not received
"""

# core: compiled

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from ..core.records import Kind, Recorder
from ..core.socket import ChipObserver
from ..core.state import State
from ..f28335.sci.module import Sci
from ..f28335.sci.register_map import SCI_MAP
from ..processor.dsp import Dsp

if TYPE_CHECKING:
    from ..core.records import Topic
    from ..core.socket import Socket
    from ..core.time import Clock

SCIFFRX, SCIRXST = SCI_MAP["SCIFFRX"].offset, SCI_MAP["SCIRXST"].offset
RXFFST, RXFFST_PLACE = SCI_MAP["SCIFFRX"]["RXFFST"].mask, SCI_MAP["SCIFFRX"]["RXFFST"].lsb
RXFFOVF = SCI_MAP["SCIFFRX"]["RXFFOVF"].mask
RXRDY, OE = SCI_MAP["SCIRXST"]["RXRDY"].mask, SCI_MAP["SCIRXST"]["OE"].mask


class SciMonitor(ChipObserver):
    """Observer of an SCI that makes the records. It reads the receiver's registers after each input of the SCI."""

    STATE = State("_words _waiting _overrun")

    def __init__(self, dsp: Dsp, module: str, recorder: Recorder) -> None:
        place = f"{dsp.name}.{module}"
        self._words_topic: Topic = recorder.topic(Kind.RECEIVER, place, "words")
        self._lost_topic: Topic = recorder.topic(Kind.RECEIVER, place, "lost")
        self._received_topic: Topic = recorder.topic(Kind.RECEIVER, place, "received")
        self._socket: Socket = dsp.sockets[module]
        self._lost: int = cast(Sci, self._socket.chip).characters_lost
        self._clock: Clock = dsp.clock
        self._words = 0
        self._waiting = 0  # number of words in the FIFO, or in SCIRXBUF if FIFO mode is off
        self._overrun = False
        self._socket.watch(self)

    def look(self, cycle: int) -> None:
        fifo = self._socket.chip.peek(cycle, SCIFFRX)
        status = self._socket.chip.peek(cycle, SCIRXST)
        words = (fifo & RXFFST) >> RXFFST_PLACE
        waiting: int = words or int(status & RXRDY > 0)
        overrun: bool = fifo & RXFFOVF > 0 or status & OE > 0
        lost: int = cast(Sci, self._socket.chip).characters_lost
        if words == self._words and waiting == self._waiting and overrun == self._overrun and lost == self._lost:
            return
        tick = self._clock.tick(cycle)
        came: int = waiting - self._waiting
        if overrun and not self._overrun:
            came = max(came, 1)
        if words != self._words or overrun != self._overrun:
            self._words_topic.emit(tick, words)
        while self._lost < lost:
            self._lost += 1
            self._lost_topic.emit(tick, 1)
        self._words, self._waiting, self._overrun = words, waiting, overrun
        while came > 0:
            came -= 1
            self._received_topic.emit(tick, 1)
