"""Conversion of the counts in host frames to the nine codes of the chips, in any arithmetic, to examine extremes.

A sample needs an acceleration and three attitudes: the last two attitudes for the rates, and all three for the change
of the rates. All values are whole counts, as in host frames, so every arithmetic receives the same numbers. Some sweeps
have counts beyond int16.

    counts int64[12, n]: the attitudes two samples ago, one sample ago and now (roll, pitch, yaw in 1e-4 rad);
                         the acceleration (1e-3 g)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..host_frame import ACCELERATION, ANGLE
from ..models import parameters
from ..models.chips import SensorEquations
from ..models.imu import Imu, Inputs
from ..numeric import arithmetic_names as named
from ..numeric.arithmetic import Arithmetic, Triple

Ints = NDArray[np.int64]

SENSORS = ("gyroscope", "accelerometer", "magnetometer")
REFERENCE = "float64"


@dataclass(frozen=True)
class CodesOfSamples:
    """The codes of n samples.

    codes: the codes that the chips return, in LSB, float64[9, n].
    exact: the values in LSB before saturation and rounding, float64[9, n].
    overflown: for each sample, True if an intermediate value exceeded the range of the Q format, bool[n].
    """

    codes: NDArray[np.float64]
    exact: NDArray[np.float64]
    overflown: NDArray[np.bool_]


def codes_of(name: str, imu: parameters.ImuParameters, counts: Ints) -> CodesOfSamples:
    """Return nine codes for each of n samples.

    name: the name of the arithmetic.
    counts: the counts of the samples, int64[12, n], in the order that the head of this module shows.
    """
    a = named.scalar(name)
    model = Imu(a, imu)
    with np.errstate(all="ignore"):
        if name == "float32":  # Float32 calculates all samples as one array; the others calculate sample by sample.
            codes, exact = np.array(_sample(model, counts), np.float64)
            return CodesOfSamples(codes, exact, np.zeros(counts.shape[1], np.bool_))
        rows, overflows = [], []
        for column in counts.T.tolist():
            rows.append(_sample(model, column))
            overflows.append(model.overflows)
    codes, exact = np.array(rows, np.float64).transpose(1, 2, 0)
    return CodesOfSamples(codes, exact, np.diff(overflows, prepend=0) > 0)


def _sample(model: Imu[Any], counts: Any) -> tuple[list[Any], list[Any]]:
    """Return a sample's codes, and its values in LSB before saturation and rounding. counts: the twelve counts."""
    a = model.a
    before, last, now = (_scaled(a, counts[i : i + 3], ANGLE) for i in (0, 3, 6))
    _, body_before = model.motion(last, before)
    turned, body = model.motion(now, last)
    inputs = Inputs(turned, _scaled(a, counts[9:12], ACCELERATION), body, body_before, model.silence)
    codes: list[Any] = []
    exact: list[Any] = []
    for name in SENSORS:
        lsb = model.lsb_of(name, inputs)
        equations: SensorEquations[Any] = getattr(model, name)
        exact += [a.value(x) for x in lsb]
        codes += equations.converted(lsb)
    return codes, exact


def _scaled(a: Arithmetic[Any], rows: Any, lsb: float) -> Triple[Any]:
    return a.scaled(rows[0], lsb), a.scaled(rows[1], lsb), a.scaled(rows[2], lsb)
