"""The host: sends frames of six signed 16-bit values over a UART, one every period.

    schedule --> values of frame n --> bytes --> UartPeer

Values are those of a ramp that tells frames apart, or of a motion (`host_frame`). The dissertation leaves the
encoding open: low byte first is a choice of ours. Nothing in a frame marks its start.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from random import Random

from ..core.kernel import Kernel
from ..lines.uart_peer import UartPeer
from .host_frame import ByteOrder

VALUES = 6
FRAME_BYTES = 2 * VALUES
ANGLE, ACCELERATION = 1e-4, 1e-3  # rad and g a count


def ramp(number: int) -> tuple[int, ...]:
    """Values that no other frame of the next minutes has: so a byte on the bus tells its frame."""
    return tuple((number * step + start + 0x8000) % 0x10000 - 0x8000 for step, start in RAMP)


RAMP = ((1, 1), (3, 1000), (5, -2000), (7, 12), (11, -34), (13, 1000))


def encode(values: tuple[int, ...], byte_order: ByteOrder = "little") -> bytes:
    """The bytes of a frame. OverflowError for a value that does not fit 16 bits."""
    return b"".join(value.to_bytes(2, byte_order, signed=True) for value in values)


@dataclass(frozen=True)
class HostSchedule:
    """first, period, jitter in ticks; gap in bits between bytes. lose: (frame, byte) pairs that are not sent."""

    first: int
    period: int
    jitter: int = 0
    gap: Fraction = Fraction(0)
    lose: frozenset[tuple[int, int]] = frozenset()
    frames: int | None = None


class Host:
    """sent: told (number, values, tick at which the last stop bit ended) of each frame."""

    def __init__(
        self,
        kernel: Kernel,
        peer: UartPeer,
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
        self._due = kernel.now + schedule.first
        self._number = 0
        self._plan()

    def _plan(self) -> None:
        schedule = self._schedule
        if schedule.frames is None or self._number < schedule.frames:
            late = self._random.randrange(schedule.jitter + 1) if schedule.jitter else 0
            self._kernel.at(self._due + late, self._send)

    def _send(self) -> None:
        number = self._number
        self._number += 1
        self._due += self._schedule.period
        self._plan()
        if self._peer.busy:
            self.late += 1
            return
        values = self._values(number)
        data = encode(values, self._byte_order)
        kept = bytes(b for i, b in enumerate(data) if (number, i) not in self._schedule.lose)
        self.frames += 1
        self.bytes += len(kept)
        self._peer.send(kept, self._schedule.gap, partial(self._over, number, values))

    def _over(self, number: int, values: tuple[int, ...], tick: int) -> None:
        for told in self.sent:
            told(number, values, tick)
