"""Exact readings, in LSB, of the sensors of a moving body at any instants.

    motion.truth --attitude, rates, acceleration at t--> models in float64 --> LSB, saturated, not rounded

Rates are those of the motion at the instant and not differences of two samples. They are always body rates (appendix
B), because a gyroscope that is fixed to the body measures these, even if an emulator calculates others. At a corner of
the motion, the values after it count.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from ..motion import Motion
from ..numeric.arithmetic import Triple
from ..numeric.float64_arrays import Float64Arrays
from .chips import Angles, angles
from .imu import Codes, Imu, Inputs, Noise
from .parameters import ImuParameters

Floats = NDArray[np.float64]

STEP = 1e-4  # seconds over which the change of the body rates is calculated, which only a lever arm needs


@lru_cache(maxsize=16)
def _model_of(imu: ImuParameters) -> Imu[Floats]:
    """Return the model for a parameter set. It is stateless, so scenes with equal parameters share it."""
    return Imu(Float64Arrays(), replace(imu, gyroscope=replace(imu.gyroscope, rates="corrected")))


class SensedMotion:
    """Exact readings of the sensors on a moving body.

    imu: the parameters of the sensors.
    motion: the motion of the body, from time 0 on.
    """

    def __init__(self, imu: ImuParameters, motion: Motion) -> None:
        self._motion = motion.truth
        self._imu = imu
        self._model = _model_of(imu)

    def lsb(self, times: Floats, noise: Noise[Floats] | None = None) -> dict[str, Floats]:
        """Return x, y, z of each chip in LSB, float64[n, 3].

        times: the instants in seconds, float64[n].
        noise: the noise at these instants, from `imu_noise`.
        """
        turned, body = self._turning(times)
        _, later = self._turning(times + STEP)
        # The models calculate the change of the rates from two samples.
        part = self._imu.period / STEP
        before = tuple(now - (then - now) * part for now, then in zip(body, later, strict=True))
        pushed = _columns(self._motion.acceleration(times))
        inputs = Inputs(turned, pushed, body, (before[0], before[1], before[2]), noise or self._model.silence)
        return {
            name: np.stack(self._model.lsb_of(name, inputs), axis=1).clip(*getattr(self._imu, name).limits)
            for name in Codes._fields
        }

    def _turning(self, times: Floats) -> tuple[Angles[Floats], Triple[Floats]]:
        """Return the sines and cosines of the attitude, and p, q, r in rad/s."""
        turned = angles(self._model.a, _columns(self._motion.attitude(times)))
        return turned, self._model.gyroscope.body_rates(_columns(self._motion.rates(times)), turned)


def _columns(values: Floats) -> Triple[Floats]:
    return values[:, 0], values[:, 1], values[:, 2]
