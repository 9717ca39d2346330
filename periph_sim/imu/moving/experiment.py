"""The whole experiment: attitudes of truth, real sensors and emulator, and their differences.

real sensors --EKF-->  A   truth    B, C emulator, gyroscope as built and corrected --EKF-->
                       A - truth, B - truth, B - A, ...  in degrees, one row per round

The emulator's answers are older than a chip's samples: the frame waits for the models, their values wait for the
next round. While the body turns this causes an angle error that is not the models'; so the lag between the two series
of attitudes with the best fit is reported separately.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..attitude import Errors, NoAttitude, errors, estimate
from ..models.parameters import Rates
from ..rotations import Floats, quaternions
from ..samples import Readings
from . import direct_computation as direct
from . import on_wires
from .subject import EmulatorUnderTest

STEP, MOST = 0.001, 0.1  # seconds: resolution and range of the search


@dataclass(frozen=True)
class Lag:
    """seconds: the delay; apart: remaining difference when the other one is shifted by it."""

    seconds: float
    apart: Errors


def lag_between(times: Floats, late: Floats, other: Floats) -> Lag:
    """Find the delay of `late` relative to `other`; both float64[n, 4], at ascending times float64[n].

    The one from 0 to 0.1 s with the least mean square of the whole angle. All are compared over the same instants,
    from 0.1 s after the first on. Without such instants: no delay, and no difference.
    """
    begins = int(np.searchsorted(times, times[0] + MOST)) if len(times) else 0
    least, found = np.inf, Lag(0.0, errors(late[begins:], other[begins:]))
    if begins == len(times):
        return found
    signed = _continuous(other)
    for number in range(round(MOST / STEP) + 1):
        earlier = _at(times[begins:] - number * STEP, times, signed)
        apart = errors(late[begins:], earlier)
        squares = float(np.sum(apart.total**2))
        if squares < least:
            least, found = squares, Lag(number * STEP, apart)
    return found


def _at(instants: Floats, times: Floats, attitudes: Floats) -> Floats:
    """Interpolate quaternions linearly and normalise them; accurate enough for steps of a few degrees."""
    between = np.stack([np.interp(instants, times, column) for column in attitudes.T], axis=1)
    return np.asarray(between / np.linalg.norm(between, axis=1, keepdims=True), np.float64)


def _continuous(attitudes: Floats) -> Floats:
    """Choose of q and -q the one nearer to the previous attitude."""
    turns = np.sign(np.sum(attitudes[1:] * attitudes[:-1], axis=1))
    signs = np.concatenate([[1.0], np.cumprod(np.where(turns == 0, 1.0, turns))])
    return np.asarray(attitudes * signs[:, np.newaxis], np.float64)


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


def attitudes(subject: EmulatorUnderTest, readings: Readings) -> Floats:
    """Filter the readings, from the true attitude on, as the experiment began at 0: float64[n, 4]."""
    s = readings.samples(subject.sensors)
    start = truth(subject, readings.seconds[:1])[0] if len(readings.seconds) else None
    return estimate(s.seconds, s.gyro, s.accel, s.mag, subject.sensors.magnetometer.earth_field, start=start)


def truth(subject: EmulatorUnderTest, seconds: Floats) -> Floats:
    """Return the true attitude: float64[n, 4]."""
    return quaternions(subject.motion.attitude(seconds))


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
