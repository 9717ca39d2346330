"""Senders on a UART line, which make each edge with a kernel event.

The time at which each bit of a burst begins is computed as an exact fraction and then rounded down to a tick, so a long
burst does not drift.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache
from typing import final

from ...core.agent import Agent, Event
from ...core.kernel import Kernel
from ...core.records import Kind, Recorder
from ...core.state import State
from ...core.wire import Wire
from ...form.c_types import BigInt
from .frame_format import UartFormat

EDGE = 0x100  # the tag of events that make an edge; a subclass may have events with other tags


class EdgeSender(Agent):
    """Makes edges on a line, each with an event of the kernel."""

    STATE = State("_level _next", ticks="_edges")

    __slots__ = ("_edges", "_kernel", "_level", "_next")

    def __init__(self, kernel: Kernel) -> None:
        self._kernel = kernel
        self._edges: list[int] = []  # ticks of the edges that are left, the last edge first
        self._level = 1
        self._next: Event | None = None

    def drive(self, level: int) -> None:
        """Drive the line to this level."""
        raise NotImplementedError

    def last_edge(self) -> None:
        """Do nothing by default. Called just after the last of the edges that were passed to `make`."""

    def make(self, edges: list[int]) -> None:
        """Schedule edges of the line at these ticks, which are in descending order. The earliest edge is a fall."""
        self._edges = edges
        self._then(edges[-1])

    def act(self, tag: int) -> None:
        self.edge()

    def edge(self) -> None:
        """Make the edge that is due."""
        edges = self._edges
        edges.pop()
        self._level ^= 1
        self.drive(self._level)
        if edges:
            self._then(edges[-1])
        else:
            self.last_edge()

    def _then(self, tick: int) -> None:
        if self._next is None:
            self._next = self._kernel.schedule(tick, self, EDGE)
        else:
            self._kernel.reschedule(self._next, tick, EDGE)


@lru_cache(maxsize=16)
def _known_edges(frame_format: UartFormat) -> dict[int, list[int]]:
    """Return a cache for frames of this format. For each byte, `send` stores the indices of the bits that begin with an
    edge.
    """
    return {}


@final
class UartSender(EdgeSender):
    """Sends one burst of bytes at a time. bit: the exact length of a bit in ticks."""

    STATE = State("_done", ticks="_ends_at", expires="_ends_at")

    __slots__ = (
        "_begins",
        "_bit",
        "_done",
        "_edges_of",
        "_ends_at",
        "_format",
        "_gap",
        "_length",
        "_mask",
        "_recorder",
        "_wire",
        "who",
    )

    _recorder: Recorder | None
    _length: int
    _format: UartFormat
    _edges_of: dict[int, list[int]]

    def __init__(
        self,
        kernel: Kernel,
        recorder: Recorder,
        wire: Wire,
        bit: Fraction,
        frame_format: UartFormat | None = None,
        who: str = "host",
    ) -> None:
        EdgeSender.__init__(self, kernel)
        self._mask = wire.attach(who).mask
        self.who = who
        self._recorder = recorder if recorder.wants(Kind.FRAME, who) else None
        self._wire = wire
        self._bit = bit
        self._format = frame_format or UartFormat()
        self._length = self._format.length
        self._edges_of = _known_edges(self._format)
        self._gap: Fraction | None = None  # the gap between bytes, in bits, for which `_begins` was computed
        self._begins: list[int] = []  # ticks from the start of a burst to each bit, and to the end of each frame
        self._ends_at = 0
        self._done: Callable[[int], None] = lambda tick: None

    @property
    def busy(self) -> bool:
        """True while a burst is on the wire, its last stop bit included."""
        return bool(self._edges) or self._kernel.now < self._ends_at

    def send(self, data: bytes, gap: Fraction, done: Callable[[int], None]) -> None:
        """Begin to send `data`, with `gap` idle bits between bytes.

        done: a function that is called when the last edge of the burst is made, or at once if there is no data. Its
            argument is the tick at which the last stop bit ends, which is later than the last edge.

        Raise ValueError if a burst is still on the wire.
        """
        if self.busy:
            raise ValueError(f"{self.who}: asked to send while a burst is still on the wire")
        start = self._kernel.now
        if not data:
            done(start)
            return
        self._measure(len(data), gap)
        edges = []
        first = 0  # the index of the frame's first bit among all bits of the burst
        byte: int
        for byte in data:
            if self._recorder is not None:
                self._kernel.schedule(start + self._begins[first], self, byte)
            bit: int
            changes: list[int] | None = self._edges_of.get(byte)
            if changes is None:
                levels = [1, *self._format.levels(byte)]
                changes = [n for n in range(self._length) if levels[n] != levels[n + 1]]
                self._edges_of[byte] = changes
            for bit in changes:
                edges.append(start + self._begins[first + bit])
            first += self._length + 1
        self._ends_at = start + self._begins[first - 1]
        self._done = done
        edges.reverse()
        self.make(edges)

    def act(self, tag: int) -> None:
        if tag == EDGE:
            self.edge()
        else:
            assert self._recorder is not None
            self._recorder.emit(self._kernel.now, Kind.FRAME, self.who, "byte", tag)

    def drive(self, level: int) -> None:
        self._wire.pull(self._mask, level)

    def last_edge(self) -> None:
        self._done(self._ends_at)

    def _measure(self, frames: int, gap: Fraction) -> None:
        """Compute, for a burst of `frames` frames, when each bit begins and when each frame ends."""
        known = len(self._begins) // (self._length + 1)
        if gap is not self._gap and gap != self._gap:
            self._begins = []
            known = 0
        self._gap = gap
        if known >= frames:
            return
        parts, pause = gap.denominator, gap.numerator  # in units of 1/parts bit, all times are whole numbers
        num, den = self._bit.numerator, self._bit.denominator * parts
        frame: BigInt
        for frame in range(known, frames):
            at = frame * (self._length * parts + pause)
            self._begins += [(at + bit * parts) * num // den for bit in range(self._length + 1)]
