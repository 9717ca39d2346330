"""Equations 4.1 to 4.8 and appendix B of the dissertation in fractions: each sensor in LSB before the converter.

This module is written from the dissertation and imports nothing of the models. An angle is a point of the unit circle
with rational coordinates, its cosine and sine, because the equations contain angles in no other way. Rates are
differences of two attitudes in rad, divided by the period.
"""

from __future__ import annotations

from fractions import Fraction as F
from math import floor, isqrt, trunc
from typing import NamedTuple

Vector = tuple[F, F, F]
Matrix = tuple[Vector, Vector, Vector]

ZERO, ONE = F(0), F(1)
PI = F("3.14159265358979323846264338327950288419716939937510582")
G = F("9.81")  # m/s^2, section 4.3.2
PERIOD = F("0.02")  # s


class Turn(NamedTuple):
    """An angle, given by its cosine and sine."""

    c: F
    s: F


def vector(x: F | float, y: F | float, z: F | float) -> Vector:
    return F(x), F(y), F(z)


def turn(half_tangent: F) -> Turn:
    """Return the angle whose half has this tangent."""
    squared = half_tangent**2
    return Turn((1 - squared) / (1 + squared), 2 * half_tangent / (1 + squared))


def added(a: Turn, b: Turn) -> Turn:
    return Turn(a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s)


def rx(a: Turn) -> Matrix:
    return (ONE, ZERO, ZERO), (ZERO, a.c, a.s), (ZERO, -a.s, a.c)


def ry(a: Turn) -> Matrix:
    return (a.c, ZERO, -a.s), (ZERO, ONE, ZERO), (a.s, ZERO, a.c)


def rz(a: Turn) -> Matrix:
    return (a.c, a.s, ZERO), (-a.s, a.c, ZERO), (ZERO, ZERO, ONE)


def product(matrix: Matrix, v: Vector) -> Vector:
    x, y, z = (sum((a * b for a, b in zip(row, v, strict=True)), ZERO) for row in matrix)
    return x, y, z


def total(*vectors: Vector) -> Vector:
    x, y, z = (sum(axis, ZERO) for axis in zip(*vectors, strict=True))
    return x, y, z


def minus(u: Vector, v: Vector) -> Vector:
    return u[0] - v[0], u[1] - v[1], u[2] - v[2]


def times(k: F, v: Vector) -> Vector:
    return k * v[0], k * v[1], k * v[2]


def cross(u: Vector, v: Vector) -> Vector:
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


def root(square: F) -> F:
    """Return the exact square root of a fraction that has one."""
    found = F(isqrt(square.numerator), isqrt(square.denominator))
    assert found**2 == square
    return found


def s_matrix(scale: F, cross_axis: F) -> Matrix:
    off = scale * cross_axis
    return (scale, off, off), (off, scale, off), (off, off, scale)


def derivative(now: Vector, before: Vector, *, wrap: str) -> Vector:
    """Return y(k) = (u(k) - u(k-1)) / Ts of section 4.3.2; unwrapped, roll and yaw take the shorter direction."""
    steps = list(minus(now, before))
    for axis in (0, 2) if wrap == "unwrapped" else ():
        while abs(steps[axis]) > PI:
            steps[axis] -= 2 * PI if steps[axis] > 0 else -2 * PI
    return steps[0] / PERIOD, steps[1] / PERIOD, steps[2] / PERIOD


def body_rates(rates: Vector, phi: Turn, theta: Turn) -> Vector:
    """Return the sum of appendix B from phi', theta', psi'."""
    roll, pitch, yaw = rates
    return total(
        (roll, ZERO, ZERO),
        product(rx(phi), (ZERO, pitch, ZERO)),
        product(rx(phi), product(ry(theta), (ZERO, ZERO, yaw))),
    )


def accelerometer(
    phi: Turn,
    theta: Turn,
    a_cg: Vector,
    omega: Vector,
    change: Vector,
    noise: Vector,
    *,
    lever_arm: Vector,
    bias: Vector,
    scale: F,
    cross_axis: F,
) -> Vector:
    """Return the accelerometer in LSB.

    a_cg: in g.
    omega: in rad/s.
    change: in rad/s^2. The terms of the lever arm are in m/s^2 and are converted to g.
    """
    a_pig = (-theta.s, theta.c * phi.s, theta.c * phi.c)  # 4.2
    a_sys = minus(a_cg, a_pig)  # 4.1
    lever = total(cross(omega, cross(omega, lever_arm)), cross(change, lever_arm))
    a_med = total(a_sys, times(1 / G, lever))  # 4.3
    return product(s_matrix(scale, cross_axis), total(a_med, bias, noise))  # 4.4


def gyroscope(
    body: Vector, g_lin: Vector, noise: Vector, *, mounting: Vector, bias: Vector, g_sens: F, scale: F, cross_axis: F
) -> Vector:
    """Return the gyroscope in LSB.

    body: p, q, r in rad/s.
    mounting: for each axis of the chip the parallel axis of the body, 1 to 3, with a sign.
    """
    x, y, z = (body[abs(int(axis)) - 1] * (-1 if axis < 0 else 1) for axis in mounting)
    omega = times(180 / PI, (x, y, z))
    return product(s_matrix(scale, cross_axis), total(omega, bias, noise, times(g_sens, g_lin)))  # 4.5


def spherical_to_cartesian(rho: F, azimuth: Turn, elevation: Turn) -> Vector:
    return rho * elevation.c * azimuth.c, rho * elevation.c * azimuth.s, rho * elevation.s


def magnetometer(
    phi: Turn,
    theta: Turn,
    psi: Turn,
    noise: Vector,
    *,
    earth_field: Vector,
    hard_iron: Vector,
    azimuth_pcb: Turn,
    elevation_pcb: Turn,
    spherical: str,
    scale: F,
    cross_axis: F,
) -> Vector:
    """Return the magnetometer in LSB.

    spherical: with "plain" the azimuth is atan(Hy / Hx), as published, whose cosine is never negative.
    """
    turned = product(rx(phi), product(ry(theta), product(rz(psi), earth_field)))
    x, y, z = total(turned, hard_iron)  # 4.6
    level, rho = root(x * x + y * y), root(x * x + y * y + z * z)
    azimuth, elevation = Turn(x / level, y / level), Turn(level / rho, z / rho)
    if spherical == "plain" and x < 0:
        azimuth = Turn(-azimuth.c, -azimuth.s)
    azimuth, elevation = added(azimuth, azimuth_pcb), added(elevation, elevation_pcb)
    h_rp = spherical_to_cartesian(rho, azimuth, elevation)  # 4.7
    return product(s_matrix(scale, cross_axis), total(h_rp, noise))  # 4.8


def earth_field_of(seen: Vector, hard_iron: Vector, phi: Turn, theta: Turn, psi: Turn) -> Vector:
    """Return the earth's field that equation 4.6 transforms to `seen`; its three rotations are inverted one by one."""
    left = minus(seen, hard_iron)
    for back in (rx(Turn(phi.c, -phi.s)), ry(Turn(theta.c, -theta.s)), rz(Turn(psi.c, -psi.s))):
        left = product(back, left)
    return left


def code(lsb: F, bits: int, rounding: str) -> int:
    """Return the code of a converter with this number of bits."""
    held = max(F(-(2 ** (bits - 1))), min(F(2 ** (bits - 1) - 1), lsb))
    return {"nearest": floor(held + F(1, 2)), "floor": floor(held), "toward zero": trunc(held)}[rounding]
