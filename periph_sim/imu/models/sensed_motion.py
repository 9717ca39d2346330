"""Exact readings, in LSB, of the sensors of a moving body at any instants.

    motion.truth --attitude, rates, acceleration at t--> models in float64 --> LSB, saturated, not rounded

Rates are those of the motion itself at that instant, not differences of two samples, and always body rates (appendix
B): a gyroscope fixed to the body measures these, however an emulator computes them. At a corner of the motion, the
values after it count.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from ..motion import Motion
from ..numeric.arithmetic import Rounding, Triple
from ..numeric.float64_arrays import Float64Arrays
from .chips import Angles, angles
from .imu import Imu, Noise
from .parameters import ImuParameters

Floats = NDArray[np.float64]

STEP = 1e-4  # seconds for the change of the body rates; it matters with a lever arm only


class Unrounded(Float64Arrays):
    """float64 whose codes keep their fractions."""

    def to_integer(self, x: Floats, rounding: Rounding) -> Floats:
        return x


@lru_cache(maxsize=16)
def _model_of(imu: ImuParameters) -> Imu[Floats]:
    """Return the model. It is stateless, so scenes with equal parameters share it."""
    return Imu(Unrounded(), replace(imu, gyroscope=replace(imu.gyroscope, rates="corrected")))


class SensedMotion:
    """imu: its parameters. motion: of the body, from time 0 on."""

    def __init__(self, imu: ImuParameters, motion: Motion) -> None:
        self._motion = motion.truth
        self._period = imu.period
        self._model = _model_of(imu)

    def lsb(self, times: Floats, noise: Noise[Floats] | None = None) -> dict[str, Floats]:
        """Return by chip x, y, z in LSB, float64[n, 3], at times in seconds, float64[n]. noise: from `imu_noise`."""
        turned, body = self._turning(times)
        _, later = self._turning(times + STEP)
        # The models take the change of the rates from one sample to the next.
        part = self._period / STEP
        before = tuple(now - (then - now) * part for now, then in zip(body, later, strict=True))
        pushed = _columns(self._motion.acceleration(times))
        codes = self._model.codes(turned, pushed, body, (before[0], before[1], before[2]), noise or self._model.silence)
        return {name: np.stack(getattr(codes, name), axis=1) for name in codes._fields}

    def _turning(self, times: Floats) -> tuple[Angles[Floats], Triple[Floats]]:
        """Return sines and cosines; p, q, r in rad/s."""
        turned = angles(self._model.a, _columns(self._motion.attitude(times)))
        return turned, self._model.gyroscope.body_rates(_columns(self._motion.rates(times)), turned)


def _columns(values: Floats) -> Triple[Floats]:
    return values[:, 0], values[:, 1], values[:, 2]
