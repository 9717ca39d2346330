"""The whole experiment: attitudes of truth, real sensors and emulator, and their differences.

real sensors                   --EKF--> attitudes A
emulator, gyroscope as built   --EKF--> attitudes B     A - truth, B - truth, B - A, C - truth, C - A:
emulator, gyroscope corrected  --EKF--> attitudes C     in degrees, one row per round

EKF is the extended Kalman filter of `attitude`.

The emulator's readings are older than a chip's samples, because a frame waits until the models run, and the results of
the models wait until the next round. While the body turns, this delay causes an angle error that is not due to the
models. The report therefore contains the delay, if it is not 0, by which the attitudes of the real sensors must be
shifted to fit those of the emulator best, and the differences that remain.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from math import ceil

import numpy as np

from ..attitude import AttitudeErrors, NoAttitude, errors, estimate
from ..host_frames import FRAME_BYTES, decode, encode
from ..model_codes import model_codes
from ..models.parameters import Rates
from ..models.sensed_motion import SensedMotion
from ..noise import ImuNoise
from ..rotations import Floats, quaternions
from ..samples import Ints, Readings
from ..sensors import SENSORS
from . import on_wires
from .subject import EmulatorUnderTest

STEP, MOST = 0.001, 0.1  # resolution of the search for a lag, and the longest lag that is tried, in seconds


@dataclass(frozen=True)
class Lag:
    """The lag of a late series of attitudes behind another series.

    seconds: the delay of the late series.
    apart: the differences between both series that remain if the other series is delayed by `seconds`.
    """

    seconds: float
    apart: AttitudeErrors


def lag_between(times: Floats, late: Floats, other: Floats) -> Lag:
    """Find the delay of `late` relative to `other`.

    The result is the delay from 0 to 0.1 s with the least mean square of the angle between the attitudes. All delays
    are compared at the same instants, from 0.1 s after the first instant on. If there are no such instants, the delay
    is 0 and the differences are empty.

    times: the times of the attitudes in seconds, increasing, float64[n].
    late, other: the attitudes at these times, float64[n, 4].
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
    """Return the attitudes at the times `instants`, float64[n, 4].

    Quaternions are interpolated linearly and normalised, which is accurate enough for steps of a few degrees.

    times, attitudes: the times and quaternions between which the function interpolates.
    """
    between = np.stack([np.interp(instants, times, column) for column in attitudes.T], axis=1)
    return np.asarray(between / np.linalg.norm(between, axis=1, keepdims=True), np.float64)


def _continuous(attitudes: Floats) -> Floats:
    """Return the same attitudes with signs that make each quaternion as near as possible to the previous quaternion."""
    turns = np.sign(np.sum(attitudes[1:] * attitudes[:-1], axis=1))
    signs = np.concatenate([[1.0], np.cumprod(np.where(turns == 0, 1.0, turns))])
    return np.asarray(attitudes * signs[:, np.newaxis], np.float64)


# Duration of a request in I2C bit times: START, repeated START and STOP take one each. Two addresses, the register
# pointer and six data bytes take nine each.
BITS_OF_REQUEST = 3 + 9 * 9
BITS_OF_BYTE = 10  # number of bits of a character: start bit, eight data bits, stop bit


def computed_emulator(subject: EmulatorUnderTest, frames: Ints | None = None) -> Readings:
    """Return the readings of the emulator, calculated without wires.

    Run n of the models uses sample n of the noise. A run before the first frame uses zeros and does not affect later
    runs. The run with the first frame calculates with rates of zero, as in the firmware.

    frames: for each run of the models, the number of the frame that the run uses, -1 for none; the result then has one
        row per run. If it is None, the frames follow from a schedule without jitter, and the result has one row per
        round.
    """
    carried = frames_by_schedule(subject) if frames is None else frames
    models = model_codes(subject.sensors, subject.arithmetic, subject.seed)
    shown, rows = models.at_rest, []
    for run, number in enumerate(carried.tolist()):
        values = None if number < 0 else decode(encode(subject.frames(number), subject.frames.encoding.byte_order))
        shown = models.run(run, values, shown)
        rows.append([chip.values(shown.data(chip.address)) for chip in SENSORS.values()])
    codes = dict(zip(SENSORS, np.array(rows, np.int64).reshape(-1, len(SENSORS), 3).swapaxes(0, 1), strict=True))
    return Readings(_due(subject, len(carried)), codes, subject.scales)


def computed_sensors(subject: EmulatorUnderTest) -> Readings:
    """Return the readings of real sensors that sample when a round is due, calculated without wires.

    The noise of the real sensors is independent of the emulator's noise.
    """
    seconds = _due(subject, subject.rounds)
    felt = SensedMotion(subject.sensors, subject.frames.motion)
    noise = None if subject.seed is None else ImuNoise(subject.sensors, subject.seed + 1)
    rows = [felt.at(at, None if noise is None else noise.at(n)) for n, at in enumerate(seconds.tolist())]
    codes = {name: np.rint([row[name] for row in rows]).astype(np.int64).reshape(-1, 3) for name in SENSORS}
    return Readings(seconds, codes, subject.scales)


def frames_by_schedule(subject: EmulatorUnderTest) -> Ints:
    """Return, for each round, the number of the frame whose values are read if nothing is late; -1 for no frame.

    Raise BadCase if the emulator runs its models once per frame, because then the values of a round follow from the
    times at which the runs end.
    """
    if subject.runs_per_frame:
        what = 'without wires, the models run once a round, but models_run is "frame"; run over wires, without --direct'
        raise subject.case.mistake(what, "unit", subject.unit, "settings", "models_run")
    host, controller = subject.host, subject.controller
    request = BITS_OF_REQUEST / controller.rate + controller.gap
    over = controller.first + 3 * request - controller.gap  # time at which round 0 ends, and the models begin, in s
    # The time at which frame 0 ends, in s.
    sent = host.first + (FRAME_BYTES * BITS_OF_BYTE + (FRAME_BYTES - 1) * host.gap) / host.baud
    found = [-1]
    for number in range(1, subject.rounds):
        begun = over + (number - 1) * controller.period
        last = ceil((begun - sent) / host.period) - 1
        found.append(max(-1, last if host.frames is None else min(last, host.frames - 1)))
    return np.array(found[: subject.rounds], np.int64)


def _due(subject: EmulatorUnderTest, rounds: int) -> Floats:
    controller = subject.controller
    return np.array([float(controller.first + n * controller.period) for n in range(rounds)])


RATES: tuple[Rates, ...] = ("as built", "corrected")


@dataclass(frozen=True)
class FilteredReadings:
    """Readings of the real sensors or of the emulator, and the attitudes that the filter estimates from them.

    readings: the readings in all rounds in which all three chips were read.
    attitudes: the quaternions that the filter estimates, float64[n, 4]. They are given only for the rounds in
        `MovingOutcome.seconds`, which were completed with the real sensors and with both emulators.
    """

    readings: Readings
    attitudes: Floats


@dataclass(frozen=True)
class Bytes:
    """Comparison of the bytes that were read from the emulator over wires with the bytes calculated without wires.

    compared: the number of bytes that were compared.
    different: the number of bytes that differ.
    """

    compared: int
    different: int


@dataclass(frozen=True)
class MovingOutcome:
    """The results of the experiment.

    seconds: the due times of the rounds that were completed with real sensors and with both emulators, float64[n].
    truth: the true attitudes at these times, float64[n, 4].
    real: the readings of the real sensors, with the estimated attitudes.
    emulated: the readings of each emulator, with the estimated attitudes, by the kind of the gyroscope's rates: "as
        built" or "corrected".
    bytes: the comparison of the bytes; None if the experiment had no wires.
    """

    subject: EmulatorUnderTest
    seconds: Floats
    truth: Floats
    real: FilteredReadings
    emulated: dict[Rates, FilteredReadings]
    bytes: Bytes | None

    def apart(self) -> dict[str, AttitudeErrors]:
        """Return the differences of each comparison, by its name, such as "real sensors less truth" (real minus truth).

        The comparisons have the order in which reports show them.
        """
        found = {"real sensors less truth": errors(self.real.attitudes, self.truth)}
        for rates, one in self.emulated.items():
            found[f"emulator {rates} less truth"] = errors(one.attitudes, self.truth)
            found[f"emulator {rates} less real sensors"] = errors(one.attitudes, self.real.attitudes)
        return found

    def behind(self, rates: Rates) -> Lag:
        """Return the lag of the emulator's attitudes, with this kind of rates, behind those of the real sensors."""
        return lag_between(self.seconds, self.emulated[rates].attitudes, self.real.attitudes)


def attitudes(subject: EmulatorUnderTest, readings: Readings) -> Floats:
    """Return the attitudes that the filter estimates from readings, float64[n, 4].

    The filter starts with the true attitude, because the dissertation's experiment began at a known attitude.
    """
    s = readings.samples(subject.sensors)
    start = truth(subject, readings.seconds[:1])[0] if len(readings.seconds) else None
    return estimate(s.seconds, s.gyro, s.accel, s.mag, subject.sensors.magnetometer.earth_field, start=start)


def truth(subject: EmulatorUnderTest, seconds: Floats) -> Floats:
    """Return the true attitudes at the times `seconds` as quaternions, float64[n, 4]."""
    return quaternions([subject.motion.at(at)[:3] for at in seconds.tolist()])


def run(subject: EmulatorUnderTest, wires: bool, progress: Callable[[float], None] | None = None) -> MovingOutcome:
    """Run the experiment.

    wires: True to simulate SCI and I2C; False to calculate the codes directly.
    progress: a function that is called with the completed share, 0 to 1, if `wires` is True.

    Raise NoAttitude if no round was complete, or if the filter cannot be used (see `estimate`). Raise BadCase if
    `wires` is False and the emulator runs its models once per frame.
    """
    parts = len(RATES) + 1

    def part(number: int) -> Callable[[float], None] | None:
        return None if progress is None else lambda done: progress((number + done) / parts)

    real = on_wires.chips(subject, part(0)) if wires else computed_sensors(subject)
    read, different = {}, 0
    for number, rates in enumerate(RATES):
        one = subject.with_rates(rates)
        if wires:
            came = on_wires.emulator(one, part(number + 1))
            read[rates] = came.readings
            different += _different(came, computed_emulator(one, came.frames))
        else:
            read[rates] = computed_emulator(one)
    seconds: Floats = reduce(np.intersect1d, [one.seconds for one in (real, *read.values())])
    if not len(seconds):
        raise NoAttitude("no round of the three chips was complete before the end; run longer")
    estimates = {rates: _estimate(subject, readings, seconds) for rates, readings in read.items()}
    compared = sum(2 * codes.size for readings in read.values() for codes in readings.codes.values())
    return MovingOutcome(
        subject,
        seconds,
        truth(subject, seconds),
        _estimate(subject, real, seconds),
        estimates,
        Bytes(compared, different) if wires else None,
    )


def _different(came: on_wires.Emulated, computed: Readings) -> int:
    """Return the number of bytes that were read over wires and differ from the bytes calculated without wires.

    came: the readings over wires, one row per round.
    computed: the calculated readings, one row per run of the models.
    """
    found = 0
    for name, codes in came.readings.codes.items():
        apart = (codes ^ computed.codes[name][came.runs]) & 0xFFFF
        found += int(((apart & 0xFF) != 0).sum() + (apart >> 8 != 0).sum())
    return found


def _estimate(subject: EmulatorUnderTest, readings: Readings, seconds: Floats) -> FilteredReadings:
    """Filter the readings of all rounds. Return all readings, and the attitudes in the rounds due at `seconds`."""
    return FilteredReadings(readings, attitudes(subject, readings)[np.isin(readings.seconds, seconds)])
