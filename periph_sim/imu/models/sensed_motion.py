"""Exact readings, in LSB, of the sensors of a moving body at any instant.

    motion.truth --attitude, rates, acceleration at t--> models in float64 --> LSB, saturated, not rounded

Rates are derivatives of the motion at the instant, and not differences of two samples. They are always converted to
body rates (appendix B), because a gyroscope that is fixed to the body measures body rates, even if an emulator
calculates other rates. At a corner of the motion, the rates after the corner are used.
"""

from __future__ import annotations

from msgspec.structs import replace

from ..motion import Motion
from ..numeric.arithmetic import Triple
from ..numeric.float64 import Float64
from .chips import Angles, angles
from .imu import Codes, Imu, Inputs, Noise
from .parameters import ImuParameters

# Time in seconds over which the derivatives of the body rates are calculated. Only a lever arm needs these derivatives.
STEP = 1e-4


class SensedMotion:
    """Exact readings of the sensors on a moving body, saturated but not rounded.

    imu: the parameters of the sensors.
    motion: the motion of the body, from time 0 on. The sensors sense its `truth`.
    """

    def __init__(self, imu: ImuParameters, motion: Motion) -> None:
        self._motion = motion.truth
        self._imu = imu
        self._model = Imu(Float64(), replace(imu, gyroscope=replace(imu.gyroscope, rates="corrected")))

    def at(self, seconds: float, noise: Noise[float] | None = None) -> dict[str, tuple[float, ...]]:
        """Return x, y, z of each chip in LSB, by the name of the chip.

        noise: the noise of the sensors at this instant; None for no noise.
        """
        turned, body = self._turning(seconds)
        *_, x, y, z = self._motion.at(seconds)
        _, later = self._turning(seconds + STEP)
        # The models calculate the derivatives of the body rates from the rates of this sample and of the previous one.
        # Here, p, q, r are the rates of a previous sample that is chosen so that the models get the derivatives at this
        # instant.
        part = self._imu.period / STEP
        p, q, r = (now - (then - now) * part for now, then in zip(body, later, strict=True))
        inputs = Inputs(turned, (x, y, z), body, (p, q, r), noise or self._model.silence)
        found = {}
        for name in Codes._fields:
            low, high = getattr(self._imu, name).limits
            found[name] = tuple(min(max(lsb, low), high) for lsb in self._model.lsb_of(name, inputs))
        return found

    def _turning(self, seconds: float) -> tuple[Angles[float], Triple[float]]:
        """Return the sines and cosines of the attitude, and p, q, r in rad/s."""
        roll, pitch, yaw, *_ = self._motion.at(seconds)
        phi, theta, psi = self._motion.rates_at(seconds)
        turned = angles(self._model.a, (roll, pitch, yaw))
        return turned, self._model.gyroscope.body_rates((phi, theta, psi), turned)
