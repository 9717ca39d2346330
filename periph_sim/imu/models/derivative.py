"""The discrete derivative that gyroscope and accelerometer share: three rates from two attitudes.

    u(k), u(k-1) --> (u(k) - u(k-1)) / Ts --> phi', theta', psi' in rad/s

Source: the dissertation's section 4.3.2 (y(k) = (u(k) - u(k-1)) / Ts, Ts constant) and 4.3.5 (computed once for both).
It takes plain differences, so a yaw that continues from +180 to -180 degrees counts as a step of nearly -360: "as
built". "unwrapped" adds or subtracts one turn if a step of roll or yaw is longer than half a turn.

1/Ts is a constant, as in a block with a fixed sample time. Ts = 0 has no derivative: such parameters are
rejected, so no arithmetic ever divides by it.
"""

from __future__ import annotations

from math import pi
from typing import Generic, TypeVar

from ..numeric.arithmetic import Arithmetic
from ..numeric.q import DoesNotFit
from ..numeric.vectors import Triple, vectors_of
from .parameters import Wrap

COARSEST = 0.01  # of 1/Ts: every rate is off by the same part
T = TypeVar("T")


class Derivative(Generic[T]):
    """period: Ts in seconds. DoesNotFit for a period whose 1/Ts is more than 1 % off in a Q format."""

    def __init__(self, a: Arithmetic[T], period: float, wrap: Wrap = "as built") -> None:
        self._a, self._v = a, vectors_of(a)
        self._wrap = wrap
        self._per_second = a.constant(1 / period)
        held = float(a.value(self._per_second))
        if abs(held * period - 1) > COARSEST:
            off = f"{abs(held * period - 1):.2%}"
            raise DoesNotFit(f"{1 / period:g} is {off} off in {a.name}; take more fraction bits, or a shorter period")
        self._half_turn, self._turn = a.constant(pi), a.constant(2 * pi)
        self._minus_half_turn = a.constant(-pi)

    def rates(self, now: Triple[T], before: Triple[T]) -> Triple[T]:
        """Return phi', theta', psi' in rad/s from two attitudes in rad."""
        step = self._v.minus(now, before)
        if self._wrap == "unwrapped":
            roll, pitch, yaw = step
            step = self._short_way(roll), pitch, self._short_way(yaw)
        return self._v.times(step, self._per_second)

    def change(self, now: Triple[T], before: Triple[T]) -> Triple[T]:
        """Return the change of three rates per second: rad/s^2 from rad/s."""
        return self._v.times(self._v.minus(now, before), self._per_second)

    def _short_way(self, step: T) -> T:
        a = self._a
        down = a.select_greater(step, self._half_turn, a.sub(step, self._turn), step)
        return a.select_greater(self._minus_half_turn, step, a.add(step, self._turn), down)
