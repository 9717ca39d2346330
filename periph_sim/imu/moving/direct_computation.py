"""Codes that are calculated without wires, from frames and their order, one run of the models after another.

    frames --> int16 counts --> models over arrays, in the firmware's arithmetic, with its noise --> codes

Run n of the models has the noise with number n. Run 0 is before the first frame and uses zeros. The frame that a run
uses depends on timing. It is given, or calculated from a schedule without jitter.
"""

from __future__ import annotations

from math import ceil
from typing import Any

import numpy as np

from ..host_frame import ACCELERATION, ANGLE
from ..host_frames import FRAME_BYTES, encode
from ..imu_noise import ImuNoise
from ..models.arrays import codes_of, cut
from ..models.imu import Codes, Noise
from ..models.sensed_motion import SensedMotion
from ..numeric import arithmetic_names as named
from ..numeric.arithmetic import Arithmetic, Triple
from ..rotations import Floats
from ..samples import Ints, Readings
from .subject import EmulatorUnderTest

BITS_OF_REQUEST = 3 + 9 * 9  # bits for START, repeated START and STOP; two addresses, a pointer, six bytes
BITS_OF_BYTE = 10  # number of bits of a character: start, eight, stop


def emulator(subject: EmulatorUnderTest, frames: Ints | None = None) -> Readings:
    """Return the readings of the emulator in each round.

    Runs of the models before the first frame do not affect later runs. The rates of the first frame are zero, as in the
    firmware.

    frames: the frame that each run of the models uses, -1 for none; then the readings are those of each run.
    """
    carried = frames_by_schedule(subject) if frames is None else frames
    counts = _counts(subject, carried)
    imu, runs = subject.sensors, len(carried)
    one, many = named.scalar(subject.arithmetic), named.arrays(subject.arithmetic)
    noise = None
    if subject.seed is not None:
        noise = Noise(*(_taken(one, chip) for chip in ImuNoise(imu, subject.seed).values(0, runs)))
    scales = 3 * [ANGLE] + 3 * [ACCELERATION]
    roll, pitch, yaw, x, y, z = (many.scaled(column, lsb) for column, lsb in zip(counts.T, scales, strict=True))
    began = int(np.argmax(carried >= 0)) if (carried >= 0).any() else runs
    parts = []
    for part in (slice(0, began), slice(began, runs)):
        added = None if noise is None else Noise(*(cut(chip, part) for chip in noise))
        parts.append(codes_of(imu, cut((roll, pitch, yaw), part), cut((x, y, z), part), added, arithmetic=many))
    whole = {
        name: np.concatenate([np.stack(getattr(codes, name), axis=1) for codes in parts]).astype(np.int64)
        for name in Codes._fields
    }
    return Readings(_due(subject, runs), whole, _scales(subject))


def sensors(subject: EmulatorUnderTest) -> Readings:
    """Return the readings of real sensors that sample when a round is due. Their noise is not that of the emulator."""
    seconds = _due(subject, subject.rounds)
    imu = subject.sensors
    noise = None if subject.seed is None else ImuNoise(imu, subject.seed + 1).values(0, subject.rounds)
    felt = SensedMotion(imu, subject.frames.motion).lsb(seconds, noise)
    return Readings(seconds, {name: np.rint(lsb).astype(np.int64) for name, lsb in felt.items()}, _scales(subject))


def frames_by_schedule(subject: EmulatorUnderTest) -> Ints:
    """Return the frame that the run before each round uses if nothing is late, int64[rounds]; -1 for none."""
    host, controller = subject.host, subject.controller
    request = BITS_OF_REQUEST / controller.rate + controller.gap
    over = controller.first + 3 * request - controller.gap  # end of round 0, at which the models begin
    sent = host.first + (FRAME_BYTES * BITS_OF_BYTE + (FRAME_BYTES - 1) * host.gap) / host.baud  # end of frame 0
    found = [-1]
    for number in range(1, subject.rounds):
        begun = over + (number - 1) * controller.period
        last = ceil((begun - sent) / host.period) - 1
        found.append(max(-1, last if host.frames is None else min(last, host.frames - 1)))
    return np.array(found[: subject.rounds], np.int64)


def _counts(subject: EmulatorUnderTest, carried: Ints) -> Ints:
    """Return the counts that the firmware reads from each frame, low byte first, int64[n, 6]; zeros for frame -1."""
    rows = {-1: np.zeros(6, np.int64)}
    for number in sorted(set(carried.tolist()) - {-1}):
        data = encode(subject.frames(number), subject.frames.byte_order)
        rows[number] = np.frombuffer(data, "<i2").astype(np.int64)
    return np.array([rows[number] for number in carried.tolist()], np.int64).reshape(-1, 6)


def _taken(a: Arithmetic[Any], chip: Triple[Floats]) -> Triple[Floats]:
    """Convert noise to the numbers of an arithmetic, as the firmware does."""
    x, y, z = (np.array([a.constant(value) for value in axis.tolist()]) for axis in chip)
    return x, y, z


def _due(subject: EmulatorUnderTest, rounds: int) -> Floats:
    controller = subject.controller
    return np.array([float(controller.first + n * controller.period) for n in range(rounds)])


def _scales(subject: EmulatorUnderTest) -> dict[str, float]:
    return {name: getattr(subject.sensors, name).scale for name in Codes._fields}
