"""Magnetometer: codes of the HMC5883L from the attitude.

    H_rm = Rx(phi) Ry(theta) Rz(psi) H_rt + V
    H_rp = sph2cart(cart2sph(H_rm) + [0, azimuth, elevation of the board])
    code = S (H_rp + noise)

Source: equations 4.6 to 4.8. Section 4.3.3 writes azimuth = atan(Hy/Hx) and elevation = atan(Hz/sqrt(Hx^2 + Hy^2)):
"plain". Half of all azimuths are then off by half a turn, and 0/0 is undefined, so "four-quadrant" with atan2 is
the intended form. "rotation" needs no angle: with r = sqrt(Hx^2 + Hy^2), rho = sqrt(r^2 + Hz^2), board angles a and e,

    rho cos(elevation + e) = r cos e - Hz sin e        rho sin(elevation + e) = Hz cos e + r sin e
    r cos(azimuth + a) = Hx cos a - Hy sin a           r sin(azimuth + a) = Hy cos a + Hx sin a

It gives the same as "four-quadrant" except on the z axis itself (r = 0), where atan2(0, 0) = 0 puts the vector on the
side of x: there "rotation" uses that side too.
"""

from __future__ import annotations

from math import cos, radians, sin
from typing import Generic, TypeVar

from ..numeric.arithmetic import Arithmetic
from ..numeric.vectors import Triple, Vectors, vectors_of
from . import parameters
from .angles import Angles
from .output import Output, triple

T = TypeVar("T")


class Magnetometer(Generic[T]):
    def __init__(self, a: Arithmetic[T], sensor: parameters.MagnetometerParameters) -> None:
        self._a, self._v = a, vectors_of(a)
        self._earth = triple(a, sensor.earth_field)
        self._hard_iron = triple(a, sensor.hard_iron)
        self._spherical, self._norm = sensor.spherical, sensor.norm
        azimuth, elevation = radians(sensor.board_azimuth), radians(sensor.board_elevation)
        self._azimuth, self._elevation = a.constant(azimuth), a.constant(elevation)
        self._s_azimuth, self._c_azimuth = a.constant(sin(azimuth)), a.constant(cos(azimuth))
        self._s_elevation, self._c_elevation = a.constant(sin(elevation)), a.constant(cos(elevation))
        self._one, self._zero = a.constant(1.0), a.constant(0.0)
        self._output = Output(a, sensor)

    def codes(self, angles: Angles[T], noise: Triple[T]) -> Triple[T]:
        """Return codes in LSB. noise in gauss."""
        v = self._v
        seen = v.plus(rotated(v, angles, self._earth), self._hard_iron)
        return self._output.codes(v.plus(self.on_board(seen), noise))

    def on_board(self, field: Triple[T]) -> Triple[T]:
        """Return H_rp from H_rm: the field in the axes of the inclined board."""
        return self._turned(field) if self._spherical == "rotation" else self._by_angles(field)

    def _by_angles(self, field: Triple[T]) -> Triple[T]:
        a, (x, y, z) = self._a, field
        level, rho = self._lengths(field)
        if self._spherical == "plain":
            azimuth, elevation = a.atan(a.div(y, x)), a.atan(a.div(z, level))
        else:
            azimuth, elevation = a.atan2(y, x), a.atan2(z, level)
        azimuth, elevation = a.add(azimuth, self._azimuth), a.add(elevation, self._elevation)
        s_azimuth, c_azimuth = a.sincos(azimuth)
        s_elevation, c_elevation = a.sincos(elevation)
        flat = a.mul(rho, c_elevation)
        return a.mul(flat, c_azimuth), a.mul(flat, s_azimuth), a.mul(rho, s_elevation)

    def _turned(self, field: Triple[T]) -> Triple[T]:
        a, mul, (x, y, z) = self._a, self._a.mul, field
        if self._norm == "mag":
            level = a.mag(x, y)
        else:
            level = a.sqrt(a.add(mul(x, x), mul(y, y)))
        flat = a.sub(mul(level, self._c_elevation), mul(z, self._s_elevation))
        up = a.add(mul(z, self._c_elevation), mul(level, self._s_elevation))
        safe = a.select_greater(level, self._zero, level, self._one)
        east, north = a.div(y, safe), a.select_greater(level, self._zero, a.div(x, safe), self._one)
        return (
            mul(flat, a.sub(mul(north, self._c_azimuth), mul(east, self._s_azimuth))),
            mul(flat, a.add(mul(east, self._c_azimuth), mul(north, self._s_azimuth))),
            up,
        )

    def _lengths(self, field: Triple[T]) -> tuple[T, T]:
        """Return sqrt(Hx^2 + Hy^2) and rho."""
        a, mul, (x, y, z) = self._a, self._a.mul, field
        if self._norm == "mag":
            level = a.mag(x, y)
            return level, a.mag(level, z)
        squared = a.add(mul(x, x), mul(y, y))
        return a.sqrt(squared), a.sqrt(a.add(squared, mul(z, z)))


def rotated(v: Vectors[T], angles: Angles[T], field: Triple[T]) -> Triple[T]:
    """Return Rx(phi) Ry(theta) Rz(psi) times a vector, one axis after the other, as in section 4.3.3."""
    x, y, z = field
    x, y = v.turned(angles.c_psi, angles.s_psi, x, y)
    z, x = v.turned(angles.c_theta, angles.s_theta, z, x)
    y, z = v.turned(angles.c_phi, angles.s_phi, y, z)
    return x, y, z
