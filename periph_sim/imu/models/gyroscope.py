"""Gyroscope: codes of the ITG-3200 from rates of the attitude angles.

    phi', theta', psi' --> p, q, r --> mounting --> deg/s --> + bias + noise + g_sens * a --> Output

Source: equation 4.5. As built, p, q, r are taken to be phi', theta', psi' (section 4.3.2). Corrected (appendix B):

    p = phi' - psi' sin(theta)
    q = theta' cos(phi) + psi' sin(phi) cos(theta)
    r = psi' cos(phi) cos(theta) - theta' sin(phi)
"""

from __future__ import annotations

from math import pi
from typing import Generic, TypeVar

from ..numeric.arithmetic import Arithmetic
from ..numeric.vectors import Triple, vectors_of
from . import parameters
from .angles import Angles
from .output import Output, triple

T = TypeVar("T")


class Gyroscope(Generic[T]):
    def __init__(self, a: Arithmetic[T], sensor: parameters.GyroscopeParameters) -> None:
        self._a, self._v = a, vectors_of(a)
        self._corrected = sensor.rates == "corrected"
        self._axes = tuple((abs(int(axis)) - 1, axis < 0) for axis in sensor.mounting)
        self._degrees = a.constant(180 / pi)
        self._bias = triple(a, sensor.bias)
        self._g_sens = a.constant(sensor.g_sens)
        self._output = Output(a, sensor)

    def body_rates(self, rates: Triple[T], angles: Angles[T]) -> Triple[T]:
        """Return p, q, r in rad/s, as built or corrected."""
        return body_rates(self._a, rates, angles) if self._corrected else rates

    def codes(self, body: Triple[T], acceleration: Triple[T], noise: Triple[T]) -> Triple[T]:
        """Return codes in LSB. body: p, q, r in rad/s; acceleration: linear, in g; noise in deg/s."""
        a, v = self._a, self._v
        x, y, z = [a.neg(body[axis]) if negative else body[axis] for axis, negative in self._axes]
        rate, pushed = v.times((x, y, z), self._degrees), v.times(acceleration, self._g_sens)
        return self._output.codes(v.plus(v.plus(v.plus(rate, self._bias), noise), pushed))


def body_rates(a: Arithmetic[T], rates: Triple[T], angles: Angles[T]) -> Triple[T]:
    """Return p, q, r of appendix B, in the unit of the rates phi', theta', psi'."""
    add, sub, mul = a.add, a.sub, a.mul
    roll, pitch, yaw = rates
    return (
        sub(roll, mul(yaw, angles.s_theta)),
        add(mul(pitch, angles.c_phi), mul(mul(yaw, angles.s_phi), angles.c_theta)),
        sub(mul(mul(yaw, angles.c_phi), angles.c_theta), mul(pitch, angles.s_phi)),
    )
