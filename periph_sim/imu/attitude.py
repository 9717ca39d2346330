"""Attitude from samples of the chips: estimates of an extended Kalman filter, and their errors.

    first accel, mag --> start --+
    gyro, accel, mag ----------> EKF, sample by sample --> quaternions --> errors against the truth

The filter is the EKF of the library `ahrs`, which the extra `attitude` installs. The filter expects the direction of
gravity. An accelerometer at rest reads the opposite, (0, 0, -1 g) if it is level with z down, so the sign of accel is
inverted here. The filter has no model of biases, so the caller must subtract known biases from the samples.

Source: the conventions of the dissertation's chapter 4; documentation of ahrs.filters.EKF.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..core.input_error import InputError
from .firmware_model import resting_attitude
from .rotations import Floats, angle_between, angles, quaternions, wrapped

VARIANCES = 0.3**2, 0.5**2, 0.8**2  # default variances of the library for gyro, accel and mag
LEAST_ANGLE = 1e-6  # minimum angle in radians between gravity and field, below which yaw is undefined


class NoAttitude(InputError):
    """An attitude cannot be estimated, for example because samples have the wrong shape or the library is missing."""


@dataclass(frozen=True)
class AttitudeErrors:
    """Errors of n attitudes in degrees. Each attribute is float64[n].

    total: the angle of the rotation from truth to estimate, which is always unambiguous.
    roll, pitch, yaw: estimate minus truth, from -180 to 180. Near a pitch of +-90 degrees, roll and yaw are rotations
        about the same axis, so only their sum or difference, and `total`, are meaningful.
    """

    total: Floats
    roll: Floats
    pitch: Floats
    yaw: Floats


def estimate(
    seconds: ArrayLike,
    gyro: ArrayLike,
    accel: ArrayLike,
    mag: ArrayLike,
    field: ArrayLike,
    variances: tuple[float, float, float] = VARIANCES,
    start: ArrayLike | None = None,
) -> Floats:
    """Return the attitude at each sample as a quaternion (see `rotations`), float64[n, 4].

    seconds: the time of each sample, float64[n], increasing.
    gyro, accel, mag: samples in deg/s, g and gauss, float64[n, 3]. The filter ignores a sample of mag that is zero or
        not finite (NaN for an overflow). If a sample of accel is zero or not finite, it ignores accel and mag of this
        sample.
    field: the north, east and down components of the magnetic field at the body; only its direction counts.
    variances: the variances of gyro, accel and mag that the filter assumes. The variance of gyro is in (rad/s)^2; the
        variances of accel and mag refer to vectors that are scaled to length 1.
    start: the attitude at the first sample; None to calculate it from accel and mag, as if the body were at rest.

    Raise NoAttitude if the input is invalid or the library is missing.
    """
    times, rates, gravity, magnetic = _checked(seconds, gyro, accel, mag)
    reference = np.asarray(field, np.float64)
    if reference.shape != (3,) or not np.isfinite(reference).all() or not reference.any():
        raise NoAttitude(f"field is {reference.tolist()}; expected north, east, down, not all of them 0")
    if not len(times):
        return np.empty((0, 4))
    ekf = _filter(reference, variances)
    found = np.empty((len(times), 4))
    found[0] = _at_rest(-gravity[0], magnetic[0], reference) if start is None else np.asarray(start, np.float64)
    steps = np.diff(times)
    for n in range(1, len(times)):
        ekf.mag = magnetic[n] if _usable(magnetic[n]) else None
        if _usable(gravity[n]):
            found[n] = ekf.update(found[n - 1], rates[n], gravity[n], ekf.mag, float(steps[n - 1]))
        else:
            turned = ekf.f(found[n - 1], rates[n], float(steps[n - 1]))
            found[n] = turned / np.linalg.norm(turned)
    return found


def errors(estimated: ArrayLike, truth: ArrayLike) -> AttitudeErrors:
    """Return the errors of estimated attitudes. Both arguments are quaternions, float64[n, 4].

    Raise NoAttitude if their shapes are different, or are not those of quaternions.
    """
    one, other = np.atleast_2d(estimated), np.atleast_2d(truth)
    if one.shape != other.shape or one.shape[1] != 4:
        raise NoAttitude(f"estimate {one.shape} and truth {other.shape} must both be n quaternions")
    roll, pitch, yaw = np.degrees(wrapped(angles(one) - angles(other))).T
    return AttitudeErrors(np.degrees(angle_between(one, other)), roll, pitch, yaw)


def _at_rest(accel: Floats, mag: Floats, field: Floats) -> Floats:
    """Return the attitude of a resting body as a quaternion, float64[4], from one sample of accel and mag.

    Raise NoAttitude if accel or mag is zero or not finite, if they are parallel, or if `field` is vertical.
    """
    if not _usable(accel) or not _usable(mag):
        raise NoAttitude("the first sample has no usable accel and mag; omit it, or give start")
    for down, magnetic in ((accel, mag), (np.array([0.0, 0.0, 1.0]), field)):
        east = np.linalg.norm(np.cross(down, magnetic))
        if east < LEAST_ANGLE * np.linalg.norm(down) * np.linalg.norm(magnetic):
            raise NoAttitude("gravity and field are parallel, so yaw is undefined; give start")
    (attitude,) = quaternions(np.radians(resting_attitude(accel.tolist(), mag.tolist(), field.tolist())))
    return np.asarray(attitude, np.float64)


def _usable(vector: Floats) -> bool:
    return bool(np.isfinite(vector).all() and vector.any())


def _checked(seconds: ArrayLike, gyro: ArrayLike, accel: ArrayLike, mag: ArrayLike) -> tuple[Floats, ...]:
    """Return (seconds, gyro in rad/s, the direction of gravity, mag) as arrays float64 of the same length.

    The direction of gravity is -accel. Raise NoAttitude if a shape or a number is invalid.
    """
    times = np.asarray(seconds, np.float64)
    if times.ndim != 1 or not np.isfinite(times).all() or (np.diff(times) <= 0).any():
        raise NoAttitude("seconds must be one rising row of numbers")
    three = {name: np.asarray(data, np.float64) for name, data in (("gyro", gyro), ("accel", accel), ("mag", mag))}
    for name, data in three.items():
        if data.shape != (len(times), 3):
            raise NoAttitude(f"{name} has shape {data.shape}; expected ({len(times)}, 3), a row for each of seconds")
    if not np.isfinite(three["gyro"]).all():
        bad = int(np.argwhere(~np.isfinite(three["gyro"]))[0, 0])
        raise NoAttitude(f"gyro[{bad}] is {three['gyro'][bad].tolist()}; the filter needs every sample of it")
    return times, np.radians(three["gyro"]), -three["accel"], three["mag"]


def _filter(field: Floats, variances: tuple[float, float, float]) -> Any:
    """Return a new filter of the library. Raise NoAttitude if the library is missing."""
    try:
        from ahrs.filters import EKF
    except ImportError:
        raise NoAttitude(
            "attitude estimation needs the library ahrs; install it with: pip install 'periph-sim[attitude]'"
        ) from None
    return EKF(frame="NED", magnetic_ref=field.tolist(), noises=[*variances])
