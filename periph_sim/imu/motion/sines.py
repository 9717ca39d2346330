"""Motion in which sine waves are added to any of the six values. Several waves can be added to the same value.

mean = { theta = "10 deg" }
angles = [ { of = "theta", amplitude = "20 deg", frequency = "0.5 Hz", phase = "90 deg" } ]
accelerations = [ { of = "ax", amplitude = "0.1 g", frequency = "2 Hz" } ]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, inf, pi, sin
from typing import Literal

from ...core.table import Table
from . import ANGLES, VALUES, BadMotion, Motion
from .quantities import LEVEL, Acceleration, Angle, Hertz, Pose, six_values


class AngleWave(Table, frozen=True):
    """A sine wave, amplitude * sin(2 pi frequency t + phase), that is added to the angle `of`."""

    of: Literal["phi", "theta", "psi"]
    amplitude: Angle
    frequency: Hertz
    phase: Angle = 0.0


class AccelerationWave(Table, frozen=True):
    """A sine wave, amplitude * sin(2 pi frequency t + phase), that is added to the acceleration `of`."""

    of: Literal["ax", "ay", "az"]
    amplitude: Acceleration
    frequency: Hertz
    phase: Angle = 0.0


@dataclass(frozen=True)
class Settings:
    """The settings of the motion.

    angles, accelerations: the sine waves, any number of which can be added to the same value.
    mean: the values to which the waves are added.
    """

    angles: tuple[AngleWave, ...] = ()
    accelerations: tuple[AccelerationWave, ...] = ()
    mean: Pose = LEVEL


class Sines(Motion):
    """A motion whose values are the sum of a mean and sine waves."""

    ends = inf

    def __init__(self, settings: Settings) -> None:
        self._mean = six_values(settings.mean)
        self._angles = settings.angles
        self._accelerations = settings.accelerations

    def at(self, seconds: float) -> Sequence[float]:
        added = [0.0] * len(VALUES)
        waves: tuple[AngleWave | AccelerationWave, ...] = (*self._angles, *self._accelerations)
        for wave in waves:
            added[VALUES.index(wave.of)] += wave.amplitude * sin(2 * pi * wave.frequency * seconds + wave.phase)
        return [mean + swing for mean, swing in zip(self._mean, added, strict=True)]

    def rates_at(self, seconds: float) -> Sequence[float]:
        rates = [0.0] * len(ANGLES)
        for wave in self._angles:
            omega = 2 * pi * wave.frequency
            rates[ANGLES.index(wave.of)] += wave.amplitude * omega * cos(omega * seconds + wave.phase)
        return rates


def motion(settings: Settings) -> Sines:
    """Build the motion. Raise BadMotion if there are no waves."""
    if not settings.angles and not settings.accelerations:
        raise BadMotion("it has no waves; give angles or accelerations, or use the motion static")
    return Sines(settings)
