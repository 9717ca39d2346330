"""Codes that are calculated without wires, from frames and their order, one run of the models after another.

    frames --> int16 counts --> models in the firmware's arithmetic, with its noise --> codes

Run n of the models has the noise with number n. Run 0 is before the first frame and uses zeros. The frame that a run
uses depends on timing. It is given, or calculated from a schedule without jitter.
"""

from __future__ import annotations

from math import ceil

import numpy as np

from ..host_frames import FRAME_BYTES, decode, encode
from ..imu_noise import ImuNoise
from ..model_codes import model_codes
from ..models.sensed_motion import SensedMotion
from ..rotations import Floats
from ..samples import Ints, Readings
from ..sensors import SENSORS
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
    models = model_codes(subject.sensors, subject.arithmetic, subject.seed)
    shown, rows = models.at_rest, []
    for run, number in enumerate(carried.tolist()):
        values = None if number < 0 else decode(encode(subject.frames(number), subject.frames.byte_order))
        shown = models.run(run, values, shown)
        rows.append([chip.values(shown.data(chip.address)) for chip in SENSORS.values()])
    codes = dict(zip(SENSORS, np.array(rows, np.int64).reshape(-1, len(SENSORS), 3).swapaxes(0, 1), strict=True))
    return Readings(_due(subject, len(carried)), codes, _scales(subject))


def sensors(subject: EmulatorUnderTest) -> Readings:
    """Return the readings of real sensors that sample when a round is due. Their noise is not that of the emulator."""
    seconds = _due(subject, subject.rounds)
    felt = SensedMotion(subject.sensors, subject.frames.motion)
    noise = None if subject.seed is None else ImuNoise(subject.sensors, subject.seed + 1)
    rows = [felt.at(at, None if noise is None else noise.at(n)) for n, at in enumerate(seconds.tolist())]
    codes = {name: np.rint([row[name] for row in rows]).astype(np.int64).reshape(-1, 3) for name in SENSORS}
    return Readings(seconds, codes, _scales(subject))


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


def _due(subject: EmulatorUnderTest, rounds: int) -> Floats:
    controller = subject.controller
    return np.array([float(controller.first + n * controller.period) for n in range(rounds)])


def _scales(subject: EmulatorUnderTest) -> dict[str, float]:
    return {name: getattr(subject.sensors, name).scale for name in SENSORS}
