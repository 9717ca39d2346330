"""Encoding of a host frame's six values, attitude and acceleration, as signed 16-bit counts.

    motion --sampled--> rad, g --divided by the value of one count--> counts --> refuse, saturate or wrap beyond 16 bits

The dissertation does not define the encoding (section 3.4.1), so each of its properties is a setting.
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
from .motion.quantities import Acceleration, Angle, six_values

# The quotient of a value and the value of one count is limited to FAR, so that an infinite quotient has a count, too.
# All quotients of FAR or more have the same count anyway: 0 if counts wrap, or the limit if they saturate.
FAR = float(1 << 69)
LEAST, MOST = -0x8000, 0x7FFF

KEPT = 256  # number of frames whose counts are cached

Frame = tuple[tuple[int, ...], tuple[str, ...]]  # the six counts, and the names of the values that do not fit 16 bits


@dataclass(frozen=True)
class Encoding:
    """The encoding of the six values of a frame.

    phi, theta, psi: the angle of one count in rad.
    ax, ay, az: the acceleration of one count in g.
    byte_order: the order of the two bytes of a count.
    beyond: the treatment of a value that does not fit 16 bits. "refuse" raises BadMotion.
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
        for name, scale in zip(VALUES, six_values(self), strict=True):
            if not scale > 0:
                raise BadMotion(f"{name}: one count is {scale:g}; expected more than 0")

    def counts(self, values: Sequence[float]) -> Frame:
        """Convert six values in rad and g to counts. Return the counts, and the names of values that exceed 16 bits.

        Counts are rounded to nearest, and halves to even. If `beyond` is "refuse", raise BadMotion for the first value
        that does not fit.
        """
        counts: list[int] = []
        beyond: list[str] = []
        for name, value, scale in zip(VALUES, values, six_values(self), strict=True):
            exact = value / scale
            count = round(max(-FAR, min(exact, FAR)))
            if not LEAST <= count <= MOST:
                if self.beyond == "refuse":
                    raise BadMotion(
                        f"{name} is {value:.6g}, which is {exact:.0f} counts of {scale:g}; expected {LEAST * scale:g} "
                        f'to {MOST * scale:g}, or another scale, or beyond = "saturate" or "wrap"'
                    )
                beyond.append(name)
                count = (count - LEAST) % 0x10000 + LEAST if self.beyond == "wrap" else max(LEAST, min(MOST, count))
            counts.append(count)
        return tuple(counts), tuple(beyond)


class MotionFrames:
    """Source of the frames of a motion. Frame n has the values of the motion at first + n * period seconds.

    motion: the motion that is sampled.
    encoding: the encoding of its values.
    beyond: by the name of a value, the number of frames so far in which this value did not fit 16 bits.
    """

    def __init__(self, motion: Motion, encoding: Encoding, first: Fraction, period: Fraction) -> None:
        self.beyond: Counter[str] = Counter()
        self.motion = motion
        self.encoding = encoding
        # `_first` and `_period` are whole numbers in units of 1 / `_scale` seconds.
        self._scale = lcm(first.denominator, period.denominator)
        self._first, self._period = (int(length * self._scale) for length in (first, period))
        self._counted = 0
        self._frame = lru_cache(KEPT)(self._calculated)

    def __call__(self, number: int) -> tuple[int, ...]:
        """Return the six counts of a frame.

        Raise BadMotion if an angle or acceleration exceeds the largest one that is allowed for any motion, or if it
        does not fit 16 bits and `Encoding.beyond` is "refuse".
        """
        values, beyond = self._frame(number)
        if number >= self._counted:
            self._counted = number + 1
            self.beyond.update(beyond)
        return values

    def _calculated(self, number: int) -> Frame:
        seconds = (self._first + number * self._period) / self._scale
        try:
            return self.encoding.counts(sampled(self.motion, seconds))
        except BadMotion as error:
            raise BadMotion(f"frame {number}, due at {seconds:.6g} s: {error}") from None


ANGLE, ACCELERATION = 1e-4, 1e-3  # the values of one count that the sensor models assume, in rad and g
