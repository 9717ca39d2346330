"""float32 as calculated by the C28x FPU and TI's fastRTS, where every result is rounded to 24 bits.

    float32 --> ADDF32, MPYF32 (no fused operation) --> float32
            --> fastRTS tables (sin, cos, atan2), Newton (divide, sqrt) --> float32

Results are rounded to nearest even, because TI's start-up code and interrupt entries set RNDF32; after reset, rounding
is toward zero. Denormal results become 0. Comparisons, and so `clamp`, treat a NaN as an infinity with the sign of the
NaN (SPRUEO2A, CMPF32, MAXF32, MINF32). The sign of a NaN that a calculation produces is not documented; here it is the
sign that numpy produces.

The fastRTS guide states no errors of the software functions. In our tests, the errors are at most: sin and cos 5e-7
up to 2 pi (the argument is reduced in float32, so the error grows with the angle: 1e-4 rad at 1000 rad); atan and atan2
4e-7; divide and sqrt two units in the last place. atan2(0, 0) divides 0 by 0 in fastRTS and is NaN here.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .arithmetic import Rounding
from .tables import ARCTANGENT, COSINES, PARABOLAS, SINES, TURN

Singles = NDArray[np.float32]

TINY = np.finfo(np.float32).tiny  # the smallest normal number
STEPS_PER_RADIAN = np.float32(TURN / (2 * pi))
RADIANS_PER_STEP = np.float32(2 * pi / TURN)
SIXTH, HALF, ONE, ROUND = np.float32(-1 / 6), np.float32(-0.5), np.float32(1), np.asarray(0.5, dtype=np.float32)
QUARTER_TURN, HALF_TURN = np.float32(pi / 2), np.float32(pi)
INFINITY, SEGMENTS = np.float32(np.inf), np.float32(PARABOLAS)

SINE, COSINE = np.array(SINES, dtype=np.float32), np.array(COSINES, dtype=np.float32)
A0, A1, A2 = (np.array([a[i] for a in ARCTANGENT], dtype=np.float32) for i in range(3))


class Float32:
    """The arithmetic of float32. T is an array, float32[n] or 0-dimensional. The caller disables numpy's warnings."""

    name = "float32"

    def constant(self, value: float) -> Singles:
        return np.asarray(value, dtype=np.float32)

    def value(self, x: Singles) -> Any:
        return x.astype(np.float64)

    def scaled(self, count: Singles, lsb: float) -> Singles:
        return self.mul(np.asarray(count, dtype=np.float32), self.constant(lsb))

    def add(self, x: Singles, y: Singles) -> Singles:
        return _flushed(x + y)

    def sub(self, x: Singles, y: Singles) -> Singles:
        return _flushed(x - y)

    def mul(self, x: Singles, y: Singles) -> Singles:
        return _flushed(x * y)

    def div(self, x: Singles, y: Singles) -> Singles:
        """Return x times the reciprocal of y. The reciprocal and the product are rounded."""
        return _flushed(x * _flushed(np.reciprocal(y)))

    def neg(self, x: Singles) -> Singles:
        return -x

    def sqrt(self, x: Singles) -> Singles:
        """Return x times the reciprocal of the root of x; 0 if x is 0. The reciprocal and the product are rounded."""
        return np.where(x == 0, np.float32(0), _flushed(x * _flushed(np.reciprocal(np.sqrt(x)))))

    def mag(self, x: Singles, y: Singles) -> Singles:
        """Return the root of the sum of the squares.

        The sum can overflow, since the library has no function that avoids the overflow.
        """
        return self.sqrt(self.add(self.mul(x, x), self.mul(y, y)))

    def sincos(self, x: Singles) -> tuple[Singles, Singles]:
        """Return the sine and the cosine, each from a cubic of its own, as in sinf and cosf."""
        k, over = _step(x)
        s, c, sixth = SINE[k], COSINE[k], _flushed(SIXTH * over)
        bend_s = _flushed(_flushed(HALF * s) + _flushed(sixth * c))
        bend_c = _flushed(_flushed(HALF * c) - _flushed(sixth * s))
        return (
            _flushed(s + _flushed(over * _flushed(c + _flushed(over * bend_s)))),
            _flushed(c + _flushed(over * _flushed(_flushed(over * bend_c) - s))),
        )

    def atan(self, x: Singles) -> Singles:
        return self.atan2(x, np.broadcast_to(ONE, np.shape(x)))

    def atan2(self, y: Singles, x: Singles) -> Singles:
        wide, high = np.abs(x), np.abs(y)
        steep = wide < high
        ratio = self.div(np.where(steep, wide, high), np.where(steep, high, wide))
        at = _whole(ratio * SEGMENTS, PARABOLAS - 1)
        angle = _flushed(A0[at] + _flushed(ratio * _flushed(A1[at] + _flushed(A2[at] * ratio))))
        up = _flushed(QUARTER_TURN + np.where(x >= 0, -angle, angle))
        angle = np.where(steep, up, np.where(x < 0, _flushed(HALF_TURN - angle), angle))
        return np.where(y >= 0, angle, -angle)

    def select_greater(self, x: Singles, y: Singles, yes: Singles, no: Singles) -> Singles:
        return np.where(_comparable(x) > _comparable(y), yes, no)

    def clamp(self, x: Singles, low: Singles, high: Singles) -> Singles:
        return np.minimum(np.maximum(_comparable(x), low), high)

    def to_integer(self, x: Singles, rounding: Rounding) -> Singles:
        if rounding == "nearest":
            return np.floor(self.add(x, ROUND))
        return np.floor(x) if rounding == "floor" else np.trunc(x)


def _flushed(x: Singles) -> Singles:
    return np.where(np.abs(x) < TINY, np.float32(0), x)


def _comparable(x: Singles) -> Singles:
    return np.where(np.isnan(x), np.copysign(INFINITY, x), x)


def _step(angle: Singles) -> tuple[Any, Singles]:
    """Return the index of an angle in the sine table, 0 to 511, and the rest of the angle beyond this entry in rad."""
    exact = _flushed(angle * STEPS_PER_RADIAN)
    whole = np.trunc(exact)
    return _whole(np.remainder(whole, np.float32(TURN)), TURN - 1), _flushed(_flushed(exact - whole) * RADIANS_PER_STEP)


def _whole(x: Singles, most: int) -> Any:
    """Convert numbers to indices of a table: limit them to 0 to `most`, and cut off their fractions.

    A NaN becomes index 0, which has no effect on the result of the caller.
    """
    return np.nan_to_num(np.clip(x, 0, most), nan=0.0).astype(np.intp)
