"""Exact readings, in LSB, of the sensors of a moving body at any instant.

    motion.truth --attitude, rates, acceleration at t--> models in float64 --> LSB, saturated, not rounded

Rates are those of the motion at the instant and not differences of two samples. They are always body rates (appendix
B), because a gyroscope that is fixed to the body measures these, even if an emulator calculates others. At a corner of
the motion, the values after it count.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from ..motion import Motion
from ..numeric.arithmetic import Triple
from ..numeric.float64 import Float64
from .chips import Angles, angles
from .imu import Codes, Imu, Inputs, Noise
from .parameters import ImuParameters

Floats = NDArray[np.float64]

STEP = 1e-4  # seconds over which the change of the body rates is calculated, which only a lever arm needs


class SensedMotion:
    """Exact readings of the sensors on a moving body.

    imu: the parameters of the sensors.
    motion: the motion of the body, from time 0 on.
    """

    def __init__(self, imu: ImuParameters, motion: Motion) -> None:
        self._motion = motion.truth
        self._imu = imu
        self._model = Imu(Float64(), replace(imu, gyroscope=replace(imu.gyroscope, rates="corrected")))

    def at(self, seconds: float, noise: Noise[float] | None = None) -> dict[str, tuple[float, ...]]:
        """Return x, y, z of each chip in LSB. noise: the noise at this instant, from `imu_noise`."""
        turned, body = self._turning(seconds)
        _, later = self._turning(seconds + STEP)
        # The models calculate the change of the rates from two samples.
        part = self._imu.period / STEP
        p, q, r = (now - (then - now) * part for now, then in zip(body, later, strict=True))
        pushed = _triple(self._motion.acceleration, seconds)
        inputs = Inputs(turned, pushed, body, (p, q, r), noise or self._model.silence)
        found = {}
        for name in Codes._fields:
            low, high = getattr(self._imu, name).limits
            found[name] = tuple(min(max(x, low), high) for x in self._model.lsb_of(name, inputs))
        return found

    def _turning(self, seconds: float) -> tuple[Angles[float], Triple[float]]:
        """Return the sines and cosines of the attitude, and p, q, r in rad/s."""
        turned = angles(self._model.a, _triple(self._motion.attitude, seconds))
        return turned, self._model.gyroscope.body_rates(_triple(self._motion.rates, seconds), turned)


def _triple(values: Callable[[Floats], Floats], seconds: float) -> Triple[float]:
    x, y, z = values(np.array([seconds]))[0].tolist()
    return x, y, z
