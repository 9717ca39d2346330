"""Motion by sine waves of any of the six values. Waves of the same value are added.

mean = { theta = "10 deg" }
angles = [ { of = "theta", amplitude = "20 deg", frequency = "0.5 Hz", phase = "90 deg" } ]
accelerations = [ { of = "ax", amplitude = "0.1 g", frequency = "2 Hz" } ]
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi, sin
from typing import TYPE_CHECKING, Literal

from ...core.table import Table
from . import VALUES, BadMotion, Motion
from .quantities import LEVEL, Acceleration, Angle, Hertz, Pose, row

if TYPE_CHECKING:
    from . import Floats


class AngleWave(Table, frozen=True):
    """A sine wave, amplitude * sin(2 pi frequency t + phase), that is added to the angle `of`."""

    of: Literal["phi", "theta", "psi"]
    amplitude: Angle
    frequency: Hertz
    phase: Angle = 0.0


class AccelerationWave(Table, frozen=True):
    """A sine wave that is added to the acceleration `of`."""

    of: Literal["ax", "ay", "az"]
    amplitude: Acceleration
    frequency: Hertz
    phase: Angle = 0.0


@dataclass(frozen=True)
class Settings:
    """The settings of the waves. mean: the values to which the waves are added."""

    angles: tuple[AngleWave, ...] = ()
    accelerations: tuple[AccelerationWave, ...] = ()
    mean: Pose = LEVEL


class Sines(Motion):
    """Sums of waves about a mean."""

    ends = inf

    def __init__(self, settings: Settings) -> None:
        self._mean = row(settings.mean)
        self._angles = settings.angles
        self._accelerations = settings.accelerations

    def at(self, seconds: float) -> tuple[float, ...]:
        """Return the six values at a time, rad and g, without numpy."""
        added = [0.0] * len(VALUES)
        waves: tuple[AngleWave | AccelerationWave, ...] = (*self._angles, *self._accelerations)
        for wave in waves:
            added[VALUES.index(wave.of)] += wave.amplitude * sin(2 * pi * wave.frequency * seconds + wave.phase)
        return tuple(mean + swing for mean, swing in zip(self._mean, added, strict=True))

    def attitude(self, times: Floats) -> Floats:
        return self._mean[:3] + _sum(self._angles, times)

    def acceleration(self, times: Floats) -> Floats:
        return self._mean[3:] + _sum(self._accelerations, times)

    def rates(self, times: Floats) -> Floats:
        import numpy as np

        rates = np.zeros((len(times), 3))
        for wave in self._angles:
            omega = 2 * pi * wave.frequency
            rates[:, _column(wave)] += wave.amplitude * omega * np.cos(omega * times + wave.phase)
        return rates


def motion(settings: Settings) -> Sines:
    """Build the motion. Raise BadMotion if there are no waves."""
    if not settings.angles and not settings.accelerations:
        raise BadMotion("it has no waves; give angles or accelerations, or use the motion static")
    return Sines(settings)


def _sum(waves: tuple[AngleWave, ...] | tuple[AccelerationWave, ...], times: Floats) -> Floats:
    import numpy as np

    values = np.zeros((len(times), 3))
    for wave in waves:
        values[:, _column(wave)] += wave.amplitude * np.sin(2 * pi * wave.frequency * times + wave.phase)
    return values


def _column(wave: AngleWave | AccelerationWave) -> int:
    return VALUES.index(wave.of) % 3
