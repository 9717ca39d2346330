"""Accelerometer: codes of the ADXL345 from attitude, linear acceleration and body rates.

    A_sys = A_CG - A_pig                                     A_pig = [-sin(theta), cos(theta) sin(phi),
    A_med = A_sys + w x (w x d) + w' x d                              cos(theta) cos(phi)]  in g
    code  = S (A_med + bias + noise)

Source: equations 4.1 to 4.4. At rest and level: 0, 0, -1 g. The products with w in rad/s and d in m are in m/s^2 and
are divided by g = 9.81 m/s^2 at the end. Dividing d instead would save three products, but would leave a lever arm of
centimetres too few bits in Q16.
"""

from __future__ import annotations

from typing import Generic, TypeVar

from ..numeric.arithmetic import Arithmetic
from ..numeric.vectors import Triple, vectors_of
from . import parameters
from .angles import Angles
from .output import Output, triple

T = TypeVar("T")


class Accelerometer(Generic[T]):
    def __init__(self, a: Arithmetic[T], sensor: parameters.AccelerometerParameters) -> None:
        self._a, self._v = a, vectors_of(a)
        self._arm = triple(a, sensor.lever_arm)
        self._per_g = a.constant(1 / parameters.STANDARD_GRAVITY)
        self._bias = triple(a, sensor.bias)
        self._output = Output(a, sensor)

    def codes(
        self, angles: Angles[T], acceleration: Triple[T], body: Triple[T], change: Triple[T], noise: Triple[T]
    ) -> Triple[T]:
        """Return codes in LSB. acceleration: linear, in g; body: p, q, r in rad/s; change: in rad/s^2; noise in g."""
        v = self._v
        system = v.minus(acceleration, gravity(self._a, angles))
        measured = v.plus(system, self._lever(body, change))
        return self._output.codes(v.plus(v.plus(measured, self._bias), noise))

    def _lever(self, body: Triple[T], change: Triple[T]) -> Triple[T]:
        """Return w x (w x d) + w' x d, in g."""
        v, arm = self._v, self._arm
        return v.times(v.plus(v.cross(body, v.cross(body, arm)), v.cross(change, arm)), self._per_g)


def gravity(a: Arithmetic[T], angles: Angles[T]) -> Triple[T]:
    """Return A_pig of equation 4.2, in g."""
    return (
        a.neg(angles.s_theta),
        a.mul(angles.c_theta, angles.s_phi),
        a.mul(angles.c_theta, angles.c_phi),
    )
