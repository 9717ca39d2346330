"""float64 for arrays, element by element. `Float64` is for single numbers."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .arithmetic import Rounding
from .float64 import Float64Operators

Floats = NDArray[np.float64]

QUARTER_TURN = math.pi / 2


class Float64Arrays(Float64Operators[Floats]):
    """The arithmetic of float64 for arrays, element by element: T = float64[n]. Constants are 0-dimensional arrays.

    The caller turns off numpy's warnings about x/0 and the like, once for all operations (np.errstate).
    """

    def constant(self, value: float) -> Floats:
        return np.asarray(value, dtype=np.float64)

    def div(self, x: Floats, y: Floats) -> Floats:
        return np.divide(x, y)

    def sqrt(self, x: Floats) -> Floats:
        return np.sqrt(x)

    def mag(self, x: Floats, y: Floats) -> Floats:
        return np.hypot(x, y)

    def sincos(self, x: Floats) -> tuple[Floats, Floats]:
        """Return the sine and the cosine, calculated from the tangent of half the angle.

        This takes 2/3 of the time of np.sin and np.cos, and differs from them by less than 3e-16.
        """
        half = np.tan(np.multiply(x, 0.5))
        squared = np.multiply(half, half)
        scale = np.divide(1.0, np.add(squared, 1.0))
        return np.multiply(np.add(half, half), scale), np.multiply(np.subtract(1.0, squared), scale)

    def atan(self, x: Floats) -> Floats:
        return np.arctan(x)

    def atan2(self, y: Floats, x: Floats) -> Floats:
        """Return the angle, calculated with arctan(x/y).

        This takes half the time of np.arctan2 and differs from it by less than 3e-16 rad. Where x/y is NaN, np.arctan2
        is used.
        """
        angle = np.subtract(np.copysign(QUARTER_TURN, y), np.arctan(np.divide(x, y)))
        unknown = np.isnan(angle)
        return np.where(unknown, np.arctan2(y, x), angle) if unknown.any() else angle

    def select_greater(self, x: Floats, y: Floats, yes: Floats, no: Floats) -> Floats:
        return np.where(x > y, yes, no)

    def clamp(self, x: Floats, low: Floats, high: Floats) -> Floats:
        return np.asarray(x).clip(low, high)

    def to_integer(self, x: Floats, rounding: Rounding) -> Floats:
        cut = np.trunc if rounding == "toward zero" else np.floor
        whole: Floats = np.asarray(cut(np.add(x, 0.5) if rounding == "nearest" else x))
        unknown = np.isnan(whole)
        return np.where(unknown, 0.0, whole) if unknown.any() else whole
