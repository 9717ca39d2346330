"""Conversion of host frames to the nine codes in any arithmetic, which all extremes use.

A sample needs an acceleration and three attitudes: the last two for the rates, and the first for the change of the
rates. They are int16 counts of host frames, so every arithmetic receives the same whole numbers.

    counts int64[12, n]: attitude before last, last, now (roll, pitch, yaw in 1e-4 rad), acceleration (1e-3 g)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..host_frame import ACCELERATION, ANGLE
from ..models import parameters
from ..models.counts import Counting
from ..models.imu import Imu
from ..numeric.arithmetic import Arithmetic, Rounding, Triple
from ..numeric.q import Q
from ..numeric.q_arrays import Ints, QArrays

INT16 = 0x8000
SENSORS = ("gyroscope", "accelerometer", "magnetometer")
REFERENCE = "float64"


@dataclass(frozen=True)
class Codes:
    """The codes of n samples.

    codes: LSB as the chips return them, float64[9, n].
    exact: the same before saturation and rounding.
    overflown: True if an intermediate value exceeded its Q format, bool[n].
    """

    codes: NDArray[np.float64]
    exact: NDArray[np.float64]
    overflown: NDArray[np.bool_]


class Exact(Counting):
    """An arithmetic without saturation and rounding, which are its last two steps. It returns the exact LSB."""

    def clamp(self, x: Any, low: Any, high: Any) -> Any:
        return x

    def to_integer(self, x: Any, rounding: Rounding) -> Any:
        return x


def codes_of(a: Arithmetic[Any], imu: parameters.ImuParameters, counts: Any) -> Codes:
    """Return nine codes for each of n samples.

    a: a new instance of an arithmetic, because a Q format stores its overflows.
    counts: int64[12, n], or twelve ints for scalar arithmetics.
    """
    with np.errstate(all="ignore"):
        model = Imu(Exact(a), imu)
        before, last, now = (_scaled(a, counts[i : i + 3], ANGLE) for i in (0, 3, 6))
        _, body_before = model.motion(last, before)
        turned, body = model.motion(now, last)
        exact = model.codes(turned, _scaled(a, counts[9:12], ACCELERATION), body, body_before, model.silence)
        values, codes = [], []
        for chip, name in zip(exact, SENSORS, strict=True):
            sensor: parameters.SensorParameters = getattr(imu, name)
            low, high = (a.constant(limit) for limit in sensor.limits)
            values += [a.value(x) for x in chip]
            codes += [a.to_integer(a.clamp(x, low, high), sensor.rounding) for x in chip]
    length = np.shape(counts[0]) or (1,)
    return Codes(_table(codes, length), _table(values, length), np.broadcast_to(_overflown(a), length))


def _overflown(a: Arithmetic[Any]) -> NDArray[np.bool_]:
    if isinstance(a, QArrays):
        return a.overflown
    return np.asarray(isinstance(a, Q) and a.overflows > 0)


def _table(rows: list[Any], length: tuple[int, ...]) -> NDArray[np.float64]:
    return np.array([np.broadcast_to(row, length) for row in rows], dtype=np.float64)


def _scaled(a: Arithmetic[Any], rows: Ints, lsb: float) -> Triple[Any]:
    return a.scaled(rows[0], lsb), a.scaled(rows[1], lsb), a.scaled(rows[2], lsb)


def counted(radians: Any) -> Ints:
    """Return angles as the counts in a frame of a host without range checks, which are int16 that wrap."""
    counts: Ints = (np.rint(np.asarray(radians) / ANGLE).astype(np.int64) + INT16) % (2 * INT16) - INT16
    return counts
