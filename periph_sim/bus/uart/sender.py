"""A UART sender on a wire: bytes and a rate go in, edges come out, one event an edge.

The k-th bit of a burst of bytes begins at an exact rational of the rate, rounded down to
a tick, so a long burst does not drift.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial

from ...core.kernel import Kernel
from ...core.records import Kind, Recorder
from ...core.wire import Wire
from .frame_format import UartFormat


class UartSender:
    """bit: length of one bit in ticks, exact. Sends one burst at a time."""

    def __init__(
        self,
        kernel: Kernel,
        recorder: Recorder,
        wire: Wire,
        bit: Fraction,
        frame_format: UartFormat | None = None,
        who: str = "host",
    ) -> None:
        self.who = who
        self._kernel = kernel
        self._recorder = recorder if recorder.wants(Kind.FRAME, who) else None
        self._pin = wire.attach(who)
        self._bit = bit
        self._format = frame_format or UartFormat()
        self._edges: list[tuple[int, int]] = []  # (tick, level), last first
        self._ends_at = 0
        self._done: Callable[[int], None] = lambda tick: None

    @property
    def busy(self) -> bool:
        """Whether a burst is on the wire, its last stop bit included."""
        return bool(self._edges) or self._kernel.now < self._ends_at

    def send(self, data: bytes, gap: Fraction, done: Callable[[int], None]) -> None:
        """Send `data` from now on with `gap` idle bits between bytes.

        `done(tick)` comes at the last rising edge at the latest and is given the end of the last stop bit.
        """
        if self.busy:
            raise ValueError(f"{self.who}: asked to send while a burst is still on the wire")
        start = self._kernel.now
        edges: list[tuple[int, int]] = []
        parts, pause = gap.denominator, gap.numerator  # a bit has `parts` parts, so that every instant is whole
        num, den = self._bit.numerator, self._bit.denominator * parts
        at = 0  # in parts of a bit
        level = 1
        for byte in data:
            if self._recorder is not None:
                self._kernel.at(start + at * num // den, partial(self._mark, byte))
            for bit in self._format.levels(byte):
                if bit != level:
                    level = bit
                    edges.append((start + at * num // den, level))
                at += parts
            at += pause
        self._ends_at = start + (at - pause) * num // den
        self._done = done
        if not edges:
            done(start)
            return
        edges.reverse()
        self._edges = edges
        self._kernel.at(edges[-1][0], self._edge)

    def _mark(self, byte: int) -> None:
        assert self._recorder is not None
        self._recorder.emit(self._kernel.now, Kind.FRAME, self.who, "byte", byte)

    def _edge(self) -> None:
        edges = self._edges
        _, level = edges.pop()
        self._pin.drive(level)
        if edges:
            self._kernel.at(edges[-1][0], self._edge)
        else:
            self._done(self._ends_at)
