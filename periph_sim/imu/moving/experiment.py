"""The whole experiment: attitudes of truth, real sensors and emulator, and their differences.

real sensors --EKF-->  A   truth    B, C emulator, gyroscope as built and corrected --EKF-->
                       A - truth, B - truth, B - A, ...  in degrees, one row per round

The emulator's answers are older than a chip's samples, because a frame waits for the models and their values wait for
the next round. While the body turns, this causes an angle error that is not due to the models. So the lag at which both
series of attitudes fit best is reported separately.
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

STEP, MOST = 0.001, 0.1  # resolution and range of the search for the lag, in seconds


@dataclass(frozen=True)
class Lag:
    """The lag between two series of attitudes.

    seconds: the delay.
    apart: the difference that remains when the other series is delayed by it.
    """

    seconds: float
    apart: Errors


def lag_between(times: Floats, late: Floats, other: Floats) -> Lag:
    """Find the delay of `late` relative to `other`.

    It is the delay from 0 to 0.1 s with the least mean square of the whole angle. All delays are compared over the same
    instants, from 0.1 s after the first instant on. If there are no such instants, the delay and the difference are 0.

    times: increasing, float64[n]. late, other: the attitudes at these times, float64[n, 4].
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
    """Interpolate quaternions linearly and normalise them, which is accurate enough for steps of a few degrees."""
    between = np.stack([np.interp(instants, times, column) for column in attitudes.T], axis=1)
    return np.asarray(between / np.linalg.norm(between, axis=1, keepdims=True), np.float64)


def _continuous(attitudes: Floats) -> Floats:
    """Return the attitudes with signs such that each quaternion, q or -q, is the one nearer to the previous one."""
    turns = np.sign(np.sum(attitudes[1:] * attitudes[:-1], axis=1))
    signs = np.concatenate([[1.0], np.cumprod(np.where(turns == 0, 1.0, turns))])
    return np.asarray(attitudes * signs[:, np.newaxis], np.float64)


RATES: tuple[Rates, ...] = ("as built", "corrected")


@dataclass(frozen=True)
class Estimate:
    """The readings of the three chips and the attitudes that the filter estimates from them, float64[n, 4]."""

    readings: Readings
    attitudes: Floats


@dataclass(frozen=True)
class Bytes:
    """The number of bytes that the head read from the emulator, and how many differ from those without wires."""

    compared: int
    different: int


@dataclass(frozen=True)
class Outcome:
    """The results of the experiment.

    seconds: the times at which rounds are due, float64[n].
    truth: the true attitudes, float64[n, 4].
    emulated: the estimates from the emulator, for each kind of the gyroscope's rates.
    bytes: None if the experiment had no wires.
    """

    subject: EmulatorUnderTest
    seconds: Floats
    truth: Floats
    real: Estimate
    emulated: dict[Rates, Estimate]
    bytes: Bytes | None

    def apart(self) -> dict[str, Errors]:
        """Return all comparisons, indexed by name, in the order in which they are shown."""
        found = {"real sensors less truth": errors(self.real.attitudes, self.truth)}
        for rates, one in self.emulated.items():
            found[f"emulator {rates} less truth"] = errors(one.attitudes, self.truth)
            found[f"emulator {rates} less real sensors"] = errors(one.attitudes, self.real.attitudes)
        return found

    def behind(self, rates: Rates) -> Lag:
        """Return the delay of the emulator relative to the real sensors."""
        return lag_between(self.seconds, self.emulated[rates].attitudes, self.real.attitudes)


def attitudes(subject: EmulatorUnderTest, readings: Readings) -> Floats:
    """Return the attitudes that the filter estimates from readings, float64[n, 4].

    It starts with the true attitude, because the experiment began at a known one.
    """
    s = readings.samples(subject.sensors)
    start = truth(subject, readings.seconds[:1])[0] if len(readings.seconds) else None
    return estimate(s.seconds, s.gyro, s.accel, s.mag, subject.sensors.magnetometer.earth_field, start=start)


def truth(subject: EmulatorUnderTest, seconds: Floats) -> Floats:
    """Return the true attitudes at some times, float64[n, 4]."""
    return quaternions(subject.motion.attitude(seconds))


def run(subject: EmulatorUnderTest, wires: bool, progress: Callable[[float], None] | None = None) -> Outcome:
    """Run the experiment.

    wires: True to simulate SCI and I2C; False to calculate the codes directly.
    progress: a function that is called with the completed share, 0 to 1.

    Raise NoAttitude if no round was complete, or if the library of the filter is missing.
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
    """Count the bytes that the head read and that differ from those of the run of the models."""
    found = 0
    for name, codes in came.readings.codes.items():
        apart = (codes ^ computed.codes[name][came.runs]) & 0xFFFF
        found += int(((apart & 0xFF) != 0).sum() + (apart >> 8 != 0).sum())
    return found


def _estimate(subject: EmulatorUnderTest, readings: Readings, seconds: Floats) -> Estimate:
    """Filter the readings of all rounds. Return the readings and attitudes of the common rounds at `seconds`."""
    return Estimate(readings, attitudes(subject, readings)[np.isin(readings.seconds, seconds)])


def _common(read: list[Readings]) -> Floats:
    """Return the times of the rounds that all readings contain."""
    common = read[0].seconds
    for one in read[1:]:
        common = np.intersect1d(common, one.seconds)
    return common
