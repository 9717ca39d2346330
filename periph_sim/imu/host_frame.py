"""Encoding of a host frame's six values, attitude and acceleration, as signed 16-bit counts.

    motion --sampled--> rad, g --/ value of one count--> counts --if beyond 16 bits--> refuse, saturate or wrap

The dissertation does not define the encoding (section 3.4.1), so every value has a named setting.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import lcm
from typing import Literal

from ..devices.host_frames import ByteOrder
from .motion import VALUES, BadMotion, Motion, sampled
from .motion.quantities import Acceleration, Angle

LEAST, MOST = -0x8000, 0x7FFF

KEPT = 256  # number of frames that are kept for later reading

Frame = tuple[tuple[int, ...], tuple[str, ...]]  # the values of a frame, and the names of those beyond 16 bits


@dataclass(frozen=True)
class Encoding:
    """The encoding of the six values of a frame.

    phi to az: the value of one count, in rad and g.
    beyond: the treatment of a value that does not fit into 16 bits.
    """

    phi: Angle = 1e-4
    theta: Angle = 1e-4
    psi: Angle = 1e-4
    ax: Acceleration = 1e-3
    ay: Acceleration = 1e-3
    az: Acceleration = 1e-3
    byte_order: ByteOrder = "little"
    beyond: Literal["refuse", "saturate", "wrap"] = "refuse"

    def __post_init__(self) -> None:
        for name, scale in zip(VALUES, self.scales, strict=True):
            if not scale > 0:
                raise BadMotion(f"{name}: one count is {scale:g}; expected more than 0")

    @property
    def scales(self) -> tuple[float, ...]:
        """The value of one count of each of the six values."""
        return self.phi, self.theta, self.psi, self.ax, self.ay, self.az

    def counts(self, values: Sequence[float]) -> Frame:
        """Convert six values in rad and g to counts.

        Counts are rounded to nearest, and halves to even. If `beyond` is "refuse", raise BadMotion for the first count
        beyond 16 bits.
        """
        counts: list[int] = []
        beyond: list[str] = []
        for name, value, scale in zip(VALUES, values, self.scales, strict=True):
            count = round(value / scale)
            if not LEAST <= count <= MOST:
                if self.beyond == "refuse":
                    raise BadMotion(
                        f"{name} is {value:.6g}, which is {count} counts of {scale:g}; expected {LEAST * scale:g} to "
                        f'{MOST * scale:g}, or another scale, or beyond = "saturate" or "wrap"'
                    )
                beyond.append(name)
                count = (count - LEAST) % 0x10000 + LEAST if self.beyond == "wrap" else max(LEAST, min(MOST, count))
            counts.append(count)
        return tuple(counts), tuple(beyond)


class MotionFrames:
    """Source of the values of frame n, which is due at the time first + n * period of the motion, in seconds.

    motion: the motion that is sampled.
    beyond: how often each value of the frames so far was beyond 16 bits.
    """

    def __init__(self, motion: Motion, encoding: Encoding, first: Fraction, period: Fraction) -> None:
        self.beyond: Counter[str] = Counter()
        self.motion = motion
        self._encoding = encoding
        # Number of parts of a second with which times are whole numbers.
        self._scale = lcm(first.denominator, period.denominator)
        self._first, self._period = (int(length * self._scale) for length in (first, period))
        self._counted = 0
        self._frame = lru_cache(KEPT)(self._calculated)

    @property
    def byte_order(self) -> ByteOrder:
        return self._encoding.byte_order

    def __call__(self, number: int) -> tuple[int, ...]:
        """Return the six counts of a frame.

        Raise BadMotion if the motion is out of range at this frame, or beyond 16 bits with "refuse".
        """
        values, beyond = self._frame(number)
        if number >= self._counted:
            self._counted = number + 1
            self.beyond.update(beyond)
        return values

    def _calculated(self, number: int) -> Frame:
        seconds = (self._first + number * self._period) / self._scale
        try:
            return self._encoding.counts(sampled(self.motion, seconds))
        except BadMotion as error:
            raise BadMotion(f"frame {number}, due at {seconds:.6g} s: {error}") from None


ANGLE, ACCELERATION = 1e-4, 1e-3  # rad and g per count
