"""The whole experiment: attitudes of truth, real sensors and emulator, and their differences.

real sensors --EKF-->  A   truth    B, C emulator, gyroscope as built and corrected --EKF-->
                       A - truth, B - truth, B - A, ...  in degrees, one row per round
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..attitude import Errors, NoAttitude, errors
from ..models.parameters import Rates
from ..rotations import Floats
from . import direct_computation as direct
from . import on_wires
from .lag import Lag, lag_between
from .readings import Readings, attitudes, truth
from .subject import EmulatorUnderTest

RATES: tuple[Rates, ...] = ("as built", "corrected")


@dataclass(frozen=True)
class Estimate:
    """readings: of the three chips. attitudes: the filter's results, float64[n, 4]."""

    readings: Readings
    attitudes: Floats


@dataclass(frozen=True)
class Bytes:
    """Bytes that the head read from the emulator, and how many differ from those computed without wires."""

    compared: int
    different: int


@dataclass(frozen=True)
class Outcome:
    """seconds: float64[n], due times of rounds. truth: float64[n, 4]. emulated: by the gyroscope's rates.

    bytes: None without wires.
    """

    subject: EmulatorUnderTest
    seconds: Floats
    truth: Floats
    real: Estimate
    emulated: dict[Rates, Estimate]
    bytes: Bytes | None

    def apart(self) -> dict[str, Errors]:
        """Return every comparison by name, in the order shown."""
        found = {"real sensors less truth": errors(self.real.attitudes, self.truth)}
        for rates, one in self.emulated.items():
            found[f"emulator {rates} less truth"] = errors(one.attitudes, self.truth)
            found[f"emulator {rates} less real sensors"] = errors(one.attitudes, self.real.attitudes)
        return found

    def behind(self, rates: Rates) -> Lag:
        """Return the delay of the emulator relative to the real sensors."""
        return lag_between(self.seconds, self.emulated[rates].attitudes, self.real.attitudes)


def run(subject: EmulatorUnderTest, wires: bool, progress: Callable[[float], None] | None = None) -> Outcome:
    """Run the experiment over SCI and I2C (`wires`) or computed directly. progress: called with the part done, 0 to 1.

    Raise NoAttitude if no round was complete, or the filter's library is missing.
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
        raise NoAttitude("no round of the three chips was complete before the end; run longer")
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
    """Count the bytes read by the head that differ from those of the model run."""
    found = 0
    for name, codes in came.readings.codes.items():
        apart = (codes ^ computed.codes[name][came.runs]) & 0xFFFF
        found += int(((apart & 0xFF) != 0).sum() + (apart >> 8 != 0).sum())
    return found


def _estimate(subject: EmulatorUnderTest, readings: Readings, seconds: Floats) -> Estimate:
    """Filter all rounds; keep the attitudes of the common rounds."""
    return Estimate(readings, attitudes(subject, readings)[np.isin(readings.seconds, seconds)])


def _common(read: list[Readings]) -> Floats:
    """Return the rounds that all of them have."""
    common = read[0].seconds
    for one in read[1:]:
        common = np.intersect1d(common, one.seconds)
    return common
