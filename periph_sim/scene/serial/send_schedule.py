"""Schedule of one entry of [[serial.send]]: one or more bursts on a line after the trigger of the entry.

    the time `at` --------------.
    records --EventTrigger-------+--> happened --delay--> burst 0 --period--> burst 1 ...
    characters --TextTrigger----'

A `BurstSender` drives the line.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial

from ...bus.uart.burst_sender import Burst, BurstSender
from ...bus.uart.reader import LineFrame
from ...core.state import State
from ...core.time import NO_TIME
from ...timing.language.matcher import Matcher
from ...timing.measures.event import EventMeasure
from ..case.serial import SendTable
from ..context import SceneContext


class EventTrigger(EventMeasure):
    """Trigger that calls `happened(tick)` each time an event happens."""

    def __init__(self, event: Matcher, happened: Callable[[int], None]) -> None:
        super().__init__(event)
        self._happened = happened

    def happened(self, place: int, tick: int, value: int) -> None:
        self._happened(tick)


class TextTrigger:
    """Trigger that calls `happened(tick)` at the end of each occurrence of a text among the received characters.

    Occurrences do not overlap. A character with an error is not part of any text.
    """

    STATE = State("_came")

    def __init__(self, characters: bytes, happened: Callable[[int], None]) -> None:
        self._wanted = characters
        self._happened = happened
        self._came = b""

    def character(self, frame: LineFrame) -> None:
        if not frame.good:
            self._came = b""
            return
        self._came = (self._came + bytes([frame.value]))[-len(self._wanted) :]
        if self._came == self._wanted:
            self._came = b""
            self._happened(frame.end)


BEHIND = "its time is after the end of the run"


class Send:
    """The bursts of one entry of [[serial.send]]. A burst sends the characters of the entry once, or one break.

    ppm: error of the clock by which the times of the entry are counted, in parts per million.
    on_begin: callbacks that receive the tick at which a burst begins.
    on_end: callbacks that receive the tick at which a burst ends.
    """

    STATE = State("sent _sender _asked", ticks="_due")

    def __init__(
        self, name: str, table: SendTable, context: SceneContext, sender: BurstSender, burst: Burst, ppm: Fraction
    ) -> None:
        self.name = name
        self.sent = 0
        self.on_begin: list[Callable[[int], None]] = []
        self.on_end: list[Callable[[int], None]] = []
        self.why_unasked: Callable[[], str] = lambda: BEHIND
        self._table = table
        self._context = context
        self._sender = sender
        self._burst = burst
        self._ppm = ppm
        self._most = table.times if table.times is not None else None if table.period is not None else 1
        self._asked = 0
        self._due = NO_TIME  # the tick at which the first burst was due; NO_TIME until then
        if table.at is not None:
            self.happened(context.serial_tick(table.at, ppm))

    @property
    def ticks(self) -> int:
        """The duration of a burst, in ticks."""
        return self._burst.edges(0)[1]

    def why_never(self) -> str:
        """Return the reason why no burst has begun, as a phrase. Call this only if no burst has begun."""
        busy = self._sender.busy_with
        if not self._asked:
            return self.why_unasked()
        if self._due == NO_TIME or busy is None:
            return BEHIND
        context, (name, until) = self._context, busy
        due, end = ((tick - context.start) / context.timebase.per_second for tick in (self._due, until))
        return f"it was due at {due:.6f} s, but its line is busy until {end:.6f} s with send {name!r}"

    def happened(self, tick: int) -> None:
        """Start the bursts for a trigger at tick `tick`.

        If the entry has the key `period`, only the first trigger counts. Otherwise, the key `times` limits the number
        of triggers that count; without `times`, only the first trigger counts.
        """
        if (self._asked and self._table.period is not None) or self._asked == self._most:
            return
        self._asked += 1
        self._fire_at(tick, 0)

    def _fire_at(self, begun: int, number: int) -> None:
        """Schedule burst number `number`, counted from 0, after the trigger at tick `begun`."""
        period = (self._table.period or 0) * number
        due = begun + self._context.ticks(self._table.delay + period, self._ppm)
        kernel = self._context.kernel
        kernel.call_at(max(due, kernel.now), partial(self._fire, begun, number))

    def _fire(self, begun: int, number: int) -> None:
        if self._due == NO_TIME:
            self._due = self._context.kernel.now
        self._sender.send(self._burst, self._begins, self._ends)
        if self._table.period is not None and number + 1 != self._most:
            self._fire_at(begun, number + 1)

    def _begins(self, tick: int) -> None:
        self.sent += 1
        for callback in self.on_begin:
            callback(tick)

    def _ends(self, tick: int) -> None:
        for callback in self.on_end:
            callback(tick)
