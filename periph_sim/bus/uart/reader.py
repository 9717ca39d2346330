"""Readers of a UART line, which read or count the frames of all senders.

    wire  --|___+---|___...---+------      start bit, data, parity, stop
            on_begin          on_end(LineFrame)

Each bit of a frame is read in its middle. A frame ends with its last stop bit, or with the start bit of the next frame
if that is earlier.

    wire  ──┐___┌───┐___...───┌──────┐___     a fall begins a character if the line is free again
            begin        free again  begin    the previous character is counted now, or at the end of the run

`UartCounter` needs no events: the start of a character determines when the line is free again.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple, final

from ...core.agent import Agent, Event
from ...core.records import Kind, Topic
from ...core.sampler import watch
from ...core.state import State
from ...core.time import NO_TIME
from ...core.wire import Wire
from .frame_format import UartFormat

Line = Callable[[], tuple[Fraction, UartFormat]]


class LineFrame(NamedTuple):
    """A frame that was read. begin, end: the ticks at which it begins and ends.

    good: True if the start bit, the parity and the stop bits are right.
    address: the address bit, in formats that have one.
    """

    begin: int
    end: int
    value: int
    good: bool
    address: int


class UartReader(Agent):
    """Reads the frames on one line.

    on_begin: callbacks with the tick of each start bit.
    on_end: callbacks with each frame that was read.
    line: called at each start bit; returns the exact length of a bit in ticks, and the format of the frames.
    """

    STATE = State(
        "_bit _format _length _halves _ending", ticks="_start _set_at _edges", expires="_start _set_at _edges"
    )

    __slots__ = (
        "_bit",
        "_edges",
        "_ending",
        "_format",
        "_halves",
        "_kernel",
        "_length",
        "_line",
        "_set_at",
        "_start",
        "on_begin",
        "on_end",
    )

    _format: UartFormat

    def __init__(self, wire: Wire, line: Line) -> None:
        self.on_begin: list[Callable[[int], None]] = []
        self.on_end: list[Callable[[LineFrame], None]] = []
        self._kernel = wire.kernel
        self._line = line
        self._start = 0
        self._set_at = NO_TIME
        self._bit: Fraction | None = None
        self._format = UartFormat()
        self._length = 0  # number of bits of a frame
        self._halves: list[int] = []  # ticks from a frame's start to the start of each half bit, and to the frame's end
        self._edges: list[int] = []  # ticks of the edges of the present frame, the fall of its start bit first
        self._ending: Event | None = None  # the event at the end of the present frame
        watch([wire], self)

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Leave out the length of a bit and the format between frames, because each frame sets them anew.

        See `proof.normal_state`.
        """
        return {} if self._ending is not None else dict.fromkeys(["_bit", "_format", "_length", "_halves"])

    def act(self, tag: int) -> None:
        self._end()

    def sampled(self, now: int, levels: int) -> None:
        ending = self._ending
        if ending is not None and not levels and now >= self._start + self._halves[2 * self._length - 1]:
            self._kernel.cancel(ending)  # this edge is the next start bit, and ends the frame
            self._end()
            ending = None
        if ending is not None:
            self._edges.append(now)
        elif not levels:
            self._begin(now)

    def _begin(self, now: int) -> None:
        if now != self._set_at:
            self._set_at = now
            bit, form = self._line()
            if bit != self._bit or form != self._format:
                self._bit, self._format, self._length = bit, form, form.length
                self._halves = form.half_bits(bit)
        self._start, self._edges = now, [now]
        self._ending = self._kernel.schedule(now + self._halves[2 * self._length], self)
        for callback in self.on_begin:
            callback(now)

    def _end(self) -> None:
        self._ending = None
        form, edges = self._format, self._edges
        levels = []
        passed: int
        level: int
        passed, level = 0, 1  # number of edges so far, and the level after them
        bit: int
        for bit in range(self._length):
            middle: int = self._start + self._halves[2 * bit + 1]
            while passed < len(edges) and edges[passed] <= middle:
                passed += 1
                level ^= 1
            levels.append(level)
        value = 0
        for bit in range(form.bits):
            value |= levels[1 + bit] << bit
        address = levels[1 + form.bits] if form.address else 0
        frame = LineFrame(self._start, self._kernel.now, value, form.is_kept_by(levels), address)
        for callback in self.on_end:
            callback(frame)


class UartMonitor:
    """Makes FRAME records of the start, and of the end or error, of each frame. line: as for a `UartReader`."""

    def __init__(self, wire: Wire, line: Line) -> None:
        self._begins: Topic = wire.recorder.topic(Kind.FRAME, wire.name, "begin")
        self._ends: Topic = wire.recorder.topic(Kind.FRAME, wire.name, "end")
        self._errors: Topic = wire.recorder.topic(Kind.FRAME, wire.name, "error")
        reader = UartReader(wire, line)
        reader.on_begin.append(self._begin)
        reader.on_end.append(self._end)

    def _begin(self, now: int) -> None:
        self._begins.emit(now)

    def _end(self, frame: LineFrame) -> None:
        topic = self._ends if frame.good else self._errors
        topic.emit(frame.end, frame.value)


@final
class UartCounter(Agent):
    """Counts the characters on one line. line: as for a `UartReader`.

    on_character: callbacks with the tick of each character's start bit, called when the next character begins or the
        run ends.
    topics: the topics of records (`core.records`); each character makes one record, with value 1, in each topic.
    """

    topics: list[Topic]

    STATE = State(ticks="_begun_at _over_at _free_at", expires="_begun_at _over_at _free_at")

    def __init__(self, wire: Wire, line: Line) -> None:
        self.on_character: list[Callable[[int], None]] = []
        self.topics = []
        self._line = line
        self._as: tuple[Fraction, UartFormat] | None = None  # bit time and format of the last character
        # Ticks from the start of the last character to the end (`_lasted`) and to the middle (`_taken`) of its last
        # stop bit.
        self._lasted = self._taken = 0
        self._begun_at = NO_TIME
        self._over_at = 0  # the tick at which the last stop bit of the last character ends
        # The tick of the middle of the last stop bit of the last character. A fall from then on is a new start bit.
        self._free_at = 0
        watch([wire], self)

    def sampled(self, now: int, levels: int) -> None:
        if levels or now < self._free_at:
            return
        self._tell()
        line = self._line()
        if line is not self._as and line != self._as:
            self._as, (bit, form) = line, line
            halves = form.half_bits(bit)
            self._taken, self._lasted = halves[-2], halves[-1]
        self._begun_at = now
        self._over_at, self._free_at = now + self._lasted, now + self._taken

    def finish(self, now: int) -> None:
        """Count the last character at the end of the run, unless it is incomplete."""
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
