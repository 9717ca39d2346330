"""The host: sends frames of six signed 16-bit values over a UART, one every period.

    schedule --> values of frame n --> bytes --> UartSender

Values are those of a ramp that tells frames apart, or of a motion (`host_frame`). The dissertation leaves the
encoding open: low byte first is a choice of ours. Nothing in a frame marks its start.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from random import Random
from typing import Literal

from ..bus.uart.sender import UartSender
from ..core.kernel import Kernel
from ..sensors.host_frame import ByteOrder

VALUES = 6
FRAME_BYTES = 2 * VALUES


def ramp(number: int) -> tuple[int, ...]:
    """Values that no other frame of the next minutes has: so a byte on the bus tells its frame."""
    return tuple((number * step + start + 0x8000) % 0x10000 - 0x8000 for step, start in RAMP)


RAMP = ((1, 1), (3, 1000), (5, -2000), (7, 12), (11, -34), (13, 1000))


def encode(values: tuple[int, ...], byte_order: ByteOrder = "little") -> bytes:
    """The bytes of a frame. OverflowError for a value that does not fit 16 bits."""
    return b"".join(value.to_bytes(2, byte_order, signed=True) for value in values)


PacedBy = Literal["schedule", "pause"]


@dataclass(frozen=True)
class HostSchedule:
    """first, period, jitter in ticks, the period exact; gap in bits between bytes. lose: (frame, byte) pairs not sent.

    paced_by: frame n is due n periods after the first; or, as in a loop with a pause in it, a period after the frame
    before began, so that its lateness adds up. silent: spans of ticks, ends excluded, in which no frame begins. twice:
    frames that are sent once more as soon as they are over.
    """

    first: int
    period: Fraction | int
    jitter: int = 0
    gap: Fraction = Fraction(0)
    lose: frozenset[tuple[int, int]] = frozenset()
    frames: int | None = None
    paced_by: PacedBy = "schedule"
    silent: tuple[tuple[int, int], ...] = ()
    twice: frozenset[int] = frozenset()


class Host:
    """sent: told (number, values, end of its last stop bit) of each frame, of one that is sent twice both times."""

    REMEMBERED = 64  # frames

    def __init__(
        self,
        kernel: Kernel,
        peer: UartSender,
        schedule: HostSchedule,
        values: Callable[[int], tuple[int, ...]] = ramp,
        seed: int = 0,
        byte_order: ByteOrder = "little",
    ) -> None:
        self.who = peer.who
        self.frames = 0
        self.bytes = 0
        self.late = 0  # frames that were due while the one before was still being sent
        self.sent: list[Callable[[int, tuple[int, ...], int], None]] = []
        self._kernel = kernel
        self._peer = peer
        self._schedule = schedule
        self._values = values
        self._byte_order: ByteOrder = byte_order
        self._random = Random(seed)
        self._first = kernel.now + schedule.first
        self._number = 0
        self._due = deque([(0, self._first)], maxlen=self.REMEMBERED)  # of the last frames: (number, tick)
        self._plan(self._first)

    def due(self, number: int) -> int:
        """The tick at which a frame was due, before jitter; where a pause paces them, of one of the last frames."""
        if self._schedule.paced_by == "schedule":
            return self._first + number * self._schedule.period // 1
        return next(tick for known, tick in self._due if known == number)

    def frame_at(self, tick: int) -> Fraction:
        """Which frame is due at a tick of the recent past, as a fraction between two frames; negative before the first.

        The next one is a whole period away as long as nobody knows better.
        """
        period = self._schedule.period
        if self._schedule.paced_by == "schedule" or tick < self._first:
            return Fraction(tick - self._first) / period
        number, due = next(known for known in reversed(self._due) if known[1] <= tick)
        return number + min(Fraction(tick - due) / period, Fraction(1))

    def _plan(self, due: int) -> None:
        schedule = self._schedule
        if schedule.frames is None or self._number < schedule.frames:
            late = self._random.randrange(schedule.jitter + 1) if schedule.jitter else 0
            self._kernel.at(due + late, partial(self._begin, due))

    def _begin(self, due: int) -> None:
        schedule, now = self._schedule, self._kernel.now
        number, self._number = self._number, self._number + 1
        if number:
            self._due.append((number, due))
        self._plan(self.due(self._number) if schedule.paced_by == "schedule" else now + schedule.period // 1)
        if any(begin <= now < end for begin, end in schedule.silent):
            return
        if self._peer.busy:
            self.late += 1
            return
        values = self._values(number)
        self._send(number, values, encode(values, self._byte_order), again=number in schedule.twice)

    def _send(self, number: int, values: tuple[int, ...], data: bytes, again: bool) -> None:
        kept = bytes(b for i, b in enumerate(data) if (number, i) not in self._schedule.lose)
        self.frames += 1
        self.bytes += len(kept)
        self._peer.send(kept, self._schedule.gap, partial(self._over, number, values, data if again else b""))

    def _over(self, number: int, values: tuple[int, ...], once_more: bytes, tick: int) -> None:
        if once_more:
            self._kernel.at(tick, partial(self._send, number, values, once_more, again=False))
        for told in self.sent:
            told(number, values, tick)
