"""Counter of characters on a UART line, from any sender: reports each whole character.

    wire  ──┐___┌───┐___...───┌──────┐___     a start bit that ends no character before it begins one
            begin        free again  the one before is reported now, or at the run's end

It needs no events: the begin of a character determines when the line is free again.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import final

from ..core.agent import Agent
from ..core.records import Topic
from ..core.sampler import watch
from ..core.state import State
from ..core.time import NO_TIME
from ..core.wire import Wire
from .uart.frame_format import UartFormat
from .uart.reader import Line


@final
class UartCounter(Agent):
    """Counts the characters on one line. line: as for a `UartReader`.

    on_character: callbacks with the tick of each character's start bit, called when the next character begins or the
        run ends.
    topics: topics in which a record with value 1 is made for each character.
    """

    topics: list[Topic]

    STATE = State(ticks="_begun_at _over_at _free_at")

    def __init__(self, wire: Wire, line: Line) -> None:
        self.on_character: list[Callable[[int], None]] = []
        self.topics = []
        self._line = line
        self._as: tuple[Fraction, UartFormat] | None = None  # bit time and format of the last character
        self._lasted = self._taken = 0  # ticks from its begin to the end, and to the middle, of its last stop bit
        self._begun_at = NO_TIME
        self._over_at = 0  # the end of its last stop bit
        self._free_at = 0  # the middle of its last stop bit, from which on a fall is a start bit
        watch([wire], self)

    def sampled(self, now: int, levels: int) -> None:
        if levels or now < self._free_at:
            return
        self._tell()
        self._set_line()
        self._begun_at = now
        self._over_at, self._free_at = now + self._lasted, now + self._taken

    def _set_line(self) -> None:
        """Set rate and format of the next character."""
        line = self._line()
        if line is not self._as and line != self._as:
            self._as, (bit, form) = line, line
            halves = form.half_bits(bit)
            self._taken, self._lasted = halves[-2], halves[-1]

    def finish(self, now: int) -> None:
        """Finish the run; an incomplete character does not count."""
        if self._over_at <= now:
            self._tell()

    def _tell(self) -> None:
        if self._begun_at != NO_TIME:
            topic: Topic
            for topic in self.topics:
                topic.emit(self._begun_at, 1)
            for callback in self.on_character:
                callback(self._begun_at)
        self._begun_at = NO_TIME
