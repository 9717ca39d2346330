"""Encoding of a host frame's six values, attitude and acceleration, as signed 16-bit counts.

    motion --sampled--> rad, g --/ value of one count--> counts --if beyond 16 bits--> refuse, saturate or wrap

The dissertation does not define the encoding (section 3.4.1), so every value has a named setting.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING, Literal

from ..devices.host_frames import ByteOrder
from .motion import VALUES, BadMotion, Motion, SingleTimes, sampled
from .motion.quantities import ACCELERATION_RANGE, ANGLE_RANGE, Acceleration, Angle

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from .motion import Floats

LEAST, MOST = -0x8000, 0x7FFF

MOST_AHEAD = 64  # maximum number of frames that are calculated at once
KEPT = 4 * MOST_AHEAD  # number of frames that are kept for later reading
LIMITS = (ANGLE_RANGE,) * 3 + (ACCELERATION_RANGE,) * 3
UNSURE = 1e-10  # in rad and g; far more than the differences between implementations of sine

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

    def counts(self, values: Floats) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """Convert values in rad and g to counts. Return them, and True for counts beyond 16 bits, with shape (n, 6).

        Counts are rounded to nearest, and halves to even. If `beyond` is "refuse", raise BadMotion for the first count
        beyond 16 bits.
        """
        import numpy as np

        whole = np.rint(values / np.array(self.scales))
        beyond = (whole < LEAST) | (whole > MOST)
        if self.beyond == "refuse" and beyond.any():
            place, column = np.argwhere(beyond)[0]
            scale, found = self.scales[column], values[place, column]
            raise BadMotion(
                f"{VALUES[column]} is {found:.6g}, which is {whole[place, column]:.0f} counts of {scale:g}; expected "
                f"{LEAST * scale:g} to {MOST * scale:g}, or another scale, or beyond = "
                '"saturate" or "wrap"'
            )
        if self.beyond == "wrap":
            return (whole.astype(np.int64) - LEAST) % 0x10000 + LEAST, beyond
        return np.clip(whole, LEAST, MOST).astype(np.int64), beyond

    def plain_counts(self, values: Sequence[float]) -> tuple[int, ...] | None:
        """Return the counts of six values; None for values that `counts` must convert.

        These are values that are near or beyond the end of their range, or so near the middle between two counts that
        an error of UNSURE would change the rounding.
        """
        counts = []
        for value, scale, limit in zip(values, self.scales, LIMITS, strict=True):
            exact = value / scale
            margin = UNSURE / scale
            if not (abs(value) < limit - UNSURE and LEAST + 1 < exact < MOST - 1):
                return None
            count = round(exact)
            if abs(exact - count) > 0.5 - margin:
                return None
            counts.append(count)
        return tuple(counts)


class MotionFrames:
    """Source of the values of frame n, which is due at the time first + n * period of the motion, in seconds.

    Several frames are calculated at once, twice as many each time, so that a short run calculates few. Frames must be
    requested in increasing order.

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
        self._known: dict[int, Frame] = {}
        self._ahead = 1  # number of frames that are calculated at once next time

    @property
    def byte_order(self) -> ByteOrder:
        return self._encoding.byte_order

    def __call__(self, number: int) -> tuple[int, ...]:
        """Return the six counts of a frame.

        Raise BadMotion if the motion is out of range at this frame, or beyond 16 bits with "refuse".
        """
        if number not in self._known:
            self._work_out(number)
        values, beyond = self._known[number]
        if number >= self._counted:
            self._counted = number + 1
            if beyond:
                self.beyond.update(beyond)
        return values

    def _work_out(self, number: int) -> None:
        """Calculate this frame, and some frames after it if none of them is rejected."""
        try:
            self._add(number, self._ahead)
        except BadMotion:
            self._ahead = 1
            try:
                self._add(number, 1)
            except BadMotion as error:
                raise BadMotion(f"frame {number}, due at {self._time(number):.6g} s: {error}") from None
        self._ahead = min(2 * self._ahead, MOST_AHEAD)
        for old in list(self._known)[:-KEPT]:
            del self._known[old]

    def _add(self, first: int, count: int) -> None:
        # A few frames do not justify loading numpy.
        if isinstance(self.motion, SingleTimes) and (count < MOST_AHEAD or "numpy" not in sys.modules):
            plain = [self._encoding.plain_counts(self.motion.at(self._time(first + n))) for n in range(count)]
            if None not in plain:
                self._known.update((first + n, (one, ())) for n, one in enumerate(plain) if one is not None)
                return
        import numpy as np

        times = np.array([self._time(number) for number in range(first, first + count)])
        counts, beyond = self._encoding.counts(sampled(self.motion, times))
        numbers = range(first, first + count)
        self._known.update((number, (tuple(row), ())) for number, row in zip(numbers, counts.tolist(), strict=True))
        for place, column in np.argwhere(beyond).tolist():
            values, names = self._known[first + place]
            self._known[first + place] = values, (*names, VALUES[column])

    def _time(self, number: int) -> float:
        return (self._first + number * self._period) / self._scale


ANGLE, ACCELERATION = 1e-4, 1e-3  # rad and g per count
