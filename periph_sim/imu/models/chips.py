"""Equations of the three sensor chips, for any arithmetic.

The chips share the derivatives of the attitude angles (`Derivative`), and their sines and cosines (`angles`).
"""

from __future__ import annotations

from math import cos, pi, radians, sin
from typing import Generic, NamedTuple, TypeVar

from ..numeric.arithmetic import Arithmetic, Triple, Vectors, vectors_of
from ..numeric.q import DoesNotFit
from . import parameters
from .parameters import SensorParameters, Wrap

T = TypeVar("T")

COARSEST = 0.01  # maximum relative error of 1/Ts as a number of the arithmetic; this error scales all rates


class Angles(NamedTuple, Generic[T]):
    """Sines (s) and cosines (c) of roll phi, pitch theta and yaw psi."""

    s_phi: T
    c_phi: T
    s_theta: T
    c_theta: T
    s_psi: T
    c_psi: T


def angles(a: Arithmetic[T], attitude: tuple[T, T, T]) -> Angles[T]:
    """Return the sines and cosines of an attitude. attitude: roll, pitch, yaw in rad."""
    phi, theta, psi = attitude
    return Angles(*a.sincos(phi), *a.sincos(theta), *a.sincos(psi))


class Derivative(Generic[T]):
    """The discrete derivative that gyroscope and accelerometer share: three rates from two attitudes.

        u(k), u(k-1) --> (u(k) - u(k-1)) / Ts --> phi', theta', psi' in rad/s

    Source: the dissertation's section 4.3.2 (y(k) = (u(k) - u(k-1)) / Ts, Ts constant) and 4.3.5 (calculated once for
    both).

    1/Ts is a constant, as in a block with a fixed sample time, so no arithmetic ever divides by Ts. Parameters with
    Ts = 0 are rejected.

    period: Ts in seconds.
    wrap: "as built" for plain differences, with which a yaw that continues from +180 to -180 degrees is a step of
        nearly -360. "unwrapped" to add or subtract one turn if a step of roll or yaw is longer than half a turn.

    Raise DoesNotFit if a Q format cannot hold 1/Ts or 2 pi, or holds 1/Ts with an error of more than 1 %.
    """

    def __init__(self, a: Arithmetic[T], period: float, wrap: Wrap = "as built") -> None:
        self._a, self._v = a, vectors_of(a)
        self._wrap = wrap
        try:
            self._per_second = a.constant(1 / period)
        except DoesNotFit as error:
            raise DoesNotFit(f"1 / period: {error}") from None
        held = float(a.value(self._per_second))
        if abs(held * period - 1) > COARSEST:
            off = f"{abs(held * period - 1):.2%}"
            shown = f"1 / period: {1 / period:g} is {off} off in {a.name}"
            raise DoesNotFit(f"{shown}; take more fraction bits, or a shorter period")
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
        """Return the derivatives of three rates in rad/s^2. now, before: the rates of two samples in rad/s."""
        return self._v.times(self._v.minus(now, before), self._per_second)

    def _short_way(self, step: T) -> T:
        a = self._a
        down = a.select_greater(step, self._half_turn, a.sub(step, self._turn), step)
        return a.select_greater(self._minus_half_turn, step, a.add(step, self._turn), down)


class SensorEquations(Generic[T]):
    """The last blocks of every sensor, from the sensed quantity to the codes of its converter.

        quantity + noise --> matrix S --> limits of the converter's codes --> rounding to whole LSB

    Source: equations 4.4, 4.5, 4.8 (S) and the saturation block at the end of each model in section 4.3.
    """

    def __init__(self, a: Arithmetic[T], sensor: SensorParameters) -> None:
        self._a, self._v = a, vectors_of(a)
        self._rows = tuple(triple(a, row) for row in sensor.matrix)
        self._low, self._high = (a.constant(limit) for limit in sensor.limits)
        self._rounding = sensor.rounding

    def converted(self, lsb: Triple[T]) -> Triple[T]:
        """Convert values in LSB to codes: limit them to the range of the converter and round them to whole numbers."""
        return self._v.whole(lsb, self._low, self._high, self._rounding)


def triple(a: Arithmetic[T], values: tuple[float, float, float]) -> Triple[T]:
    """Return three values as constants of an arithmetic."""
    return a.constant(values[0]), a.constant(values[1]), a.constant(values[2])


class Gyroscope(SensorEquations[T]):
    """Gyroscope: codes of the ITG-3200 from rates of the attitude angles.

        phi', theta', psi' --> p, q, r --> mounting --> deg/s --> + bias + noise + g_sens * a --> codes

    Source: equation 4.5. a is the linear acceleration in g, and g_sens the sensitivity of the rates to a. "As built",
    the model uses phi', theta', psi' as p, q, r (section 4.3.2). "Corrected", p, q, r are the body rates (appendix B):

        p = phi' - psi' sin(theta)
        q = theta' cos(phi) + psi' sin(phi) cos(theta)
        r = psi' cos(phi) cos(theta) - theta' sin(phi)
    """

    def __init__(self, a: Arithmetic[T], sensor: parameters.GyroscopeParameters) -> None:
        super().__init__(a, sensor)
        self._corrected = sensor.rates == "corrected"
        self._axes = tuple((abs(int(axis)) - 1, axis < 0) for axis in sensor.mounting)
        self._degrees = a.constant(180 / pi)
        self._bias = triple(a, sensor.bias)
        self._g_sens = a.constant(sensor.g_sens)

    def body_rates(self, rates: Triple[T], angles: Angles[T]) -> Triple[T]:
        """Return p, q, r in rad/s, "as built" or "corrected". rates: phi', theta', psi' in rad/s."""
        return body_rates(self._a, rates, angles) if self._corrected else rates

    def lsb(self, body: Triple[T], acceleration: Triple[T], noise: Triple[T]) -> Triple[T]:
        """Return the values in LSB, before saturation and rounding.

        body: p, q, r in rad/s.
        acceleration: the linear acceleration in g.
        noise: the noise in deg/s.
        """
        a, v = self._a, self._v
        x, y, z = [a.neg(body[axis]) if negative else body[axis] for axis, negative in self._axes]
        rate, pushed = v.times((x, y, z), self._degrees), v.times(acceleration, self._g_sens)
        return v.transformed(self._rows, v.plus(v.plus(v.plus(rate, self._bias), noise), pushed))


def body_rates(a: Arithmetic[T], rates: Triple[T], angles: Angles[T]) -> Triple[T]:
    """Return p, q, r of appendix B from the rates phi', theta', psi', in the same unit."""
    add, sub, mul = a.add, a.sub, a.mul
    roll, pitch, yaw = rates
    return (
        sub(roll, mul(yaw, angles.s_theta)),
        add(mul(pitch, angles.c_phi), mul(mul(yaw, angles.s_phi), angles.c_theta)),
        sub(mul(mul(yaw, angles.c_phi), angles.c_theta), mul(pitch, angles.s_phi)),
    )


class Accelerometer(SensorEquations[T]):
    """Accelerometer: codes of the ADXL345 from attitude, linear acceleration and body rates.

        A_sys = A_CG - A_pig                                     A_pig = [-sin(theta), cos(theta) sin(phi),
        A_med = A_sys + w x (w x d) + w' x d                              cos(theta) cos(phi)]  in g
        code  = S (A_med + bias + noise)

    Source: equations 4.1 to 4.4. A_CG is the linear acceleration, w the vector of the body rates p, q, r in rad/s, w'
    its derivative, and d the lever arm in m. A level chip at rest reads 0, 0, -1 g. The products of w and d are in
    m/s^2 and are divided by g = 9.81 m/s^2 at the end. Dividing d by g first would save three products, but a lever arm
    of centimetres would have too few bits in Q16.
    """

    def __init__(self, a: Arithmetic[T], sensor: parameters.AccelerometerParameters) -> None:
        super().__init__(a, sensor)
        self._arm = triple(a, sensor.lever_arm)
        self._per_g = a.constant(1 / parameters.STANDARD_GRAVITY)
        self._bias = triple(a, sensor.bias)

    def lsb(
        self, angles: Angles[T], acceleration: Triple[T], body: Triple[T], change: Triple[T], noise: Triple[T]
    ) -> Triple[T]:
        """Return the values in LSB, before saturation and rounding.

        acceleration: the linear acceleration in g.
        body: p, q, r in rad/s.
        change: the derivatives of p, q, r in rad/s^2.
        noise: the noise in g.
        """
        v = self._v
        system = v.minus(acceleration, gravity(self._a, angles))
        measured = v.plus(system, self._lever(body, change))
        return v.transformed(self._rows, v.plus(v.plus(measured, self._bias), noise))

    def _lever(self, body: Triple[T], change: Triple[T]) -> Triple[T]:
        """Return w x (w x d) + w' x d, in g."""
        v, arm = self._v, self._arm
        return v.times(v.plus(v.cross(body, v.cross(body, arm)), v.cross(change, arm)), self._per_g)


def gravity(a: Arithmetic[T], angles: Angles[T]) -> Triple[T]:
    """Return the acceleration of gravity in the axes of the body, A_pig of equation 4.2, in g."""
    return (
        a.neg(angles.s_theta),
        a.mul(angles.c_theta, angles.s_phi),
        a.mul(angles.c_theta, angles.c_phi),
    )


class Magnetometer(SensorEquations[T]):
    """Magnetometer: codes of the HMC5883L from the attitude.

        H_rm = Rx(phi) Ry(theta) Rz(psi) H_rt + V
        H_rp = sph2cart(cart2sph(H_rm) + [0, azimuth, elevation of the board])
        code = S (H_rp + noise)

    Source: equations 4.6 to 4.8. H_rt is the earth field in north, east, down; V is the hard iron. H_rm is the field in
    the axes of the body, and H_rp in the axes of the board, which is inclined in the body. There are three methods for
    H_rp:

    "plain" is as written in section 4.3.3: azimuth = atan(Hy/Hx) and elevation = atan(Hz/sqrt(Hx^2 + Hy^2)). Half of
    all azimuths are then off by half a turn, and 0/0 is undefined.

    "four-quadrant" uses atan2, which is the intended form.

    "rotation" does not calculate the azimuth and the elevation of the field. With r = sqrt(Hx^2 + Hy^2),
    rho = sqrt(r^2 + Hz^2), and the azimuth a and the elevation e of the board,

        rho cos(elevation + e) = r cos e - Hz sin e        rho sin(elevation + e) = Hz cos e + r sin e
        r cos(azimuth + a) = Hx cos a - Hy sin a           r sin(azimuth + a) = Hy cos a + Hx sin a

    "rotation" gives the same values as "four-quadrant". For a field along the z axis (r = 0), both use an azimuth of 0,
    because atan2(0, 0) = 0.
    """

    def __init__(self, a: Arithmetic[T], sensor: parameters.MagnetometerParameters) -> None:
        super().__init__(a, sensor)
        self._earth = triple(a, sensor.earth_field)
        self._hard_iron = triple(a, sensor.hard_iron)
        self._spherical, self._norm = sensor.spherical, sensor.norm
        azimuth, elevation = radians(sensor.board_azimuth), radians(sensor.board_elevation)
        self._azimuth, self._elevation = a.constant(azimuth), a.constant(elevation)
        self._s_azimuth, self._c_azimuth = a.constant(sin(azimuth)), a.constant(cos(azimuth))
        self._s_elevation, self._c_elevation = a.constant(sin(elevation)), a.constant(cos(elevation))
        self._one, self._zero = a.constant(1.0), a.constant(0.0)

    def lsb(self, angles: Angles[T], noise: Triple[T]) -> Triple[T]:
        """Return the values in LSB, before saturation and rounding. noise: the noise in gauss."""
        v = self._v
        seen = v.plus(rotated(v, angles, self._earth), self._hard_iron)
        return v.transformed(self._rows, v.plus(self.on_board(seen), noise))

    def on_board(self, field: Triple[T]) -> Triple[T]:
        """Return H_rp, the field in the axes of the board, from H_rm, the field in the axes of the body."""
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
        """Return r and rho, the lengths of a field's horizontal part and of the whole field (see the class)."""
        a, mul, (x, y, z) = self._a, self._a.mul, field
        if self._norm == "mag":
            level = a.mag(x, y)
            return level, a.mag(level, z)
        squared = a.add(mul(x, x), mul(y, y))
        return a.sqrt(squared), a.sqrt(a.add(squared, mul(z, z)))


def rotated(v: Vectors[T], angles: Angles[T], field: Triple[T]) -> Triple[T]:
    """Return Rx(phi) Ry(theta) Rz(psi) times a vector, calculated as rotations about z, y and x (section 4.3.3)."""
    x, y, z = field
    x, y = v.turned(angles.c_psi, angles.s_psi, x, y)
    z, x = v.turned(angles.c_theta, angles.s_theta, z, x)
    y, z = v.turned(angles.c_phi, angles.s_phi, y, z)
    return x, y, z
