"""The whole experiment: a subject goes in; attitudes of truth, real sensors and emulator, and how far they are apart.

real sensors --EKF-->  A   truth    B, C emulator, gyroscope as built and corrected --EKF-->
                       A - truth, B - truth, B - A, ...  in degrees, a row a round
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...devices.attitude import Errors, NoAttitude, errors
from ...sensors.models.parameters import Rates
from ...sensors.rotations import Floats
from . import direct_computation as direct
from . import on_wires
from .lag import Lag, lag_between
from .readings import Readings, attitudes, truth
from .subject import EmulatorUnderTest

RATES: tuple[Rates, ...] = ("as built", "corrected")


@dataclass(frozen=True)
class Estimate:
    """readings: of the three chips. attitudes: what the filter made of them, float64[n, 4]."""

    readings: Readings
    attitudes: Floats


@dataclass(frozen=True)
class Bytes:
    """Of what the head read from the emulator: how many bytes, and how many are not those computed without wires."""

    compared: int
    different: int


@dataclass(frozen=True)
class Outcome:
    """seconds: float64[n], when each round was due. truth: float64[n, 4]. emulated: by the gyroscope's rates.

    bytes: None where there were no wires.
    """

    subject: EmulatorUnderTest
    seconds: Floats
    truth: Floats
    real: Estimate
    emulated: dict[Rates, Estimate]
    bytes: Bytes | None

    def apart(self) -> dict[str, Errors]:
        """Every comparison by its name, in the order in which it is shown."""
        found = {"real sensors less truth": errors(self.real.attitudes, self.truth)}
        for rates, one in self.emulated.items():
            found[f"emulator {rates} less truth"] = errors(one.attitudes, self.truth)
            found[f"emulator {rates} less real sensors"] = errors(one.attitudes, self.real.attitudes)
        return found

    def behind(self, rates: Rates) -> Lag:
        """How late the emulator is behind the real sensors."""
        return lag_between(self.seconds, self.emulated[rates].attitudes, self.real.attitudes)


def run(subject: EmulatorUnderTest, wires: bool, progress: Callable[[float], None] | None = None) -> Outcome:
    """wires: over SCI and I2C, or all computed directly. progress: told the part done, 0 to 1.

    NoAttitude where no round was over, or the library of the filter is missing.
    """
    parts = len(RATES) + 1

    def part(number: int) -> Callable[[float], None] | None:
        return None if progress is None else lambda done: progress((number + done) / parts)

    real = on_wires.chips(subject, part(0)) if wires else direct.sensors(subject)
    read, different = {}, 0
    for number, rates in enumerate(RATES):
        one = subject.with_rates(rates)
        if wires:
            came = on_wires.emulator(one, part(number + 1))
            read[rates] = came.readings
            different += _different(came, direct.emulator(one, came.frames))
        else:
            read[rates] = direct.emulator(one)
    seconds = _common([real, *read.values()])
    if not len(seconds):
        raise NoAttitude("no round of the three chips was over before the end; run longer")
    estimates = {rates: _estimate(subject, readings, seconds) for rates, readings in read.items()}
    compared = sum(2 * codes.size for readings in read.values() for codes in readings.codes.values())
    return Outcome(
        subject,
        seconds,
        truth(subject, seconds),
        _estimate(subject, real, seconds),
        estimates,
        Bytes(compared, different) if wires else None,
    )


def _different(came: on_wires.Emulated, computed: Readings) -> int:
    """How many bytes the head read that are not those which the run of the models made."""
    found = 0
    for name, codes in came.readings.codes.items():
        apart = (codes ^ computed.codes[name][came.runs]) & 0xFFFF
        found += int(((apart & 0xFF) != 0).sum() + (apart >> 8 != 0).sum())
    return found


def _estimate(subject: EmulatorUnderTest, readings: Readings, seconds: Floats) -> Estimate:
    """Every round goes into the filter; of its attitudes those of the common rounds are kept."""
    return Estimate(readings, attitudes(subject, readings)[np.isin(readings.seconds, seconds)])


def _common(read: list[Readings]) -> Floats:
    """The rounds that all of them have."""
    common = read[0].seconds
    for one in read[1:]:
        common = np.intersect1d(common, one.seconds)
    return common
