"""float64 for single numbers, the reference for the other kinds of arithmetic.

Operations follow IEEE 754: x/0 is infinite, and 0/0 and similar operations give NaN, without exceptions. A NaN cannot
be rounded to a whole number, so `to_integer` returns 0 for a NaN. A model must therefore check for NaN before it
rounds.
"""

from __future__ import annotations

import math
import operator

from .arithmetic import Rounding


class Float64:
    """The arithmetic of float64. T is float."""

    name = "float64"
    constant = staticmethod(float)
    value = staticmethod(float)
    scaled = staticmethod(operator.mul)
    add = staticmethod(operator.add)
    sub = staticmethod(operator.sub)
    mul = staticmethod(operator.mul)
    neg = staticmethod(operator.neg)
    mag = staticmethod(math.hypot)
    atan = staticmethod(math.atan)
    atan2 = staticmethod(math.atan2)

    def div(self, x: float, y: float) -> float:
        if y:
            return x / y
        return math.nan if x == 0 or x != x else math.copysign(math.inf, x) * math.copysign(1.0, y)

    def sqrt(self, x: float) -> float:
        return math.sqrt(x) if x >= 0 else math.nan

    def sincos(self, x: float) -> tuple[float, float]:
        return (math.sin(x), math.cos(x)) if math.isfinite(x) else (math.nan, math.nan)

    def select_greater(self, x: float, y: float, yes: float, no: float) -> float:
        return yes if x > y else no

    def clamp(self, x: float, low: float, high: float) -> float:
        return low if x < low else high if x > high else x

    def to_integer(self, x: float, rounding: Rounding) -> float:
        if not math.isfinite(x):
            return 0.0 if x != x else x
        if rounding == "nearest":
            return float(math.floor(x + 0.5))
        return float(math.floor(x) if rounding == "floor" else math.trunc(x))
