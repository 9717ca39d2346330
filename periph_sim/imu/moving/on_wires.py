"""The moving experiment over simulated wires: the codes that the sensor head reads in each round.

emulator   host --SCI--> firmware --I2C--> sensor head
chips      motion --> ITG-3200, ADXL345, HMC5883L --I2C--> sensor head
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...core.records import Kind, Record, Recorder
from ...core.time import Timebase
from ...devices.chips.register_chip import Source
from ...devices.sensor_rounds import Round
from ...scene.case.party_tables import ChipTable
from ...scene.scene import Scene
from ...timing.derived.read_records import MODEL
from ..models.sensed_motion import SensedMotion
from ..noise import ImuNoise
from ..samples import Ints, Readings, SampleLog
from ..sensors import SENSORS
from .subject import EmulatorUnderTest

Progress = Callable[[float], None]

# For each sensor, its model and the contents of its registers before the run. The contents are the values that the
# start-up requests in `sensors.SENSORS` write.
REAL: dict[str, dict[str, Any]] = {
    "gyroscope": {"model": "itg3200", "registers": {"PWR_MGM": 0x01, "SMPLRT_DIV": 0x00, "DLPF_FS": 0x1B}},
    "accelerometer": {"model": "adxl345", "registers": {"BW_RATE": 0x0A, "DATA_FORMAT": 0x08, "POWER_CTL": 0x08}},
    "magnetometer": {"model": "hmc5883l", "registers": {"CRA": 0x18, "CRB": 0x60, "Mode": 0x00}},
}


@dataclass(frozen=True)
class Emulated:
    """The readings of the emulator.

    readings: the codes that the sensor head read in each round in which all three chips were read.
    frames: for each run of the models, the number of the last host frame that the firmware had read when the run began,
        int64[runs]; -1 for none.
    runs: for each round without a NACK, the number of the models' run whose values were read, int64[rounds]; -1 if no
        run had ended.
    """

    readings: Readings
    frames: Ints
    runs: Ints


class ModelRuns:
    """An observer of a scene (a simulated case) that finds the frame used by each run of the models.

    A frame counts as read when the receive FIFO becomes empty, which may be some bits before the end of the frame's
    last stop bit.

    runs: for each round without a NACK, the number of the models' run whose values were read; -1 if no run had ended.
    """

    def __init__(self) -> None:
        self.runs: list[int] = []
        self._sent = [-1]  # numbers of the frames that were sent; -1 before the first frame
        self._taken = 0  # number of frames that firmware has read
        self._waiting = 0  # number of words in the receive FIFO
        self._begun_with: list[int] = []  # for each model run, the number of frames read when the run began
        self._ended = 0  # number of runs of the models that have ended

    @property
    def frames(self) -> list[int]:
        """For each run of the models, the number of the frame that the run used; -1 for no frame."""
        # The scene may end after firmware has read the last frame, but before the last stop bit of this frame ends.
        # Then `_sent` lacks the number of this frame.
        sent = [*self._sent, self._sent[-1] + 1]
        return [sent[taken] for taken in self._begun_with]

    def subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe([Kind.SPAN], self._record)
        recorder.subscribe([Kind.RECEIVER], self._words_wait, things={(Kind.RECEIVER, "words")})

    def on_frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        self._sent.append(number)

    def _words_wait(self, record: Record) -> None:
        """Process a change of the number of words in the receive FIFO."""
        self._taken += not record.value and self._waiting > 0
        self._waiting = record.value

    def _record(self, record: Record) -> None:
        if record.what == MODEL and record.value:
            self._begun_with.append(self._taken)
        elif record.what == MODEL:
            self._ended += 1

    def on_round(self, over: Round) -> None:
        if not over.nacked:
            self.runs.append(self._ended - 1)


def emulator(subject: EmulatorUnderTest, progress: Progress | None = None) -> Emulated:
    """Simulate the host, the emulator and the sensor head. Return the readings of the emulator."""
    observer = ModelRuns()
    scene = Scene(subject.case, observer.subscribe)
    scene.on_frame(observer.on_frame)
    scene.on_round(observer.on_round)
    readings = replace(_read(scene, subject, progress), lsb_per_unit=subject.scales, overflow=None)
    return Emulated(readings, np.array(observer.frames, np.int64), np.array(observer.runs, np.int64))


def chips(subject: EmulatorUnderTest, progress: Progress | None = None) -> Readings:
    """Simulate the three real chips, each of which samples the true motion with its own clock. Return the readings."""
    values = {"values": {"fixed": [0, 0, 0]}}
    tables = {name: ChipTable.model_validate({**table, **values}) for name, table in REAL.items()}
    case = subject.case.model_copy(update={"unit": {}, "host": None, "chip": tables})
    clock = Timebase()
    scene = Scene(case, sources=sources(subject, clock.per_second, clock.ticks(case.start, "nearest")))
    assert scene.timebase.per_second == clock.per_second
    return _read(scene, subject, progress)


def sources(subject: EmulatorUnderTest, ticks: int, start: int) -> dict[str, Source]:
    """Return, by the name of each chip, a function that returns the chip's input x, y, z at a tick, in the chip's unit.

    The input includes cross-axis sensitivity, bias and noise. Sample n of the noise is used from time n * Ts to time
    (n + 1) * Ts, because the density of the noise refers to the sample rate of the models. Ts is the models' period.

    ticks: the number of ticks per second.
    start: the tick at which the motion is at time 0.
    """
    imu = subject.sensors
    felt = SensedMotion(imu, subject.frames.motion)
    noise = None if subject.seed is None else ImuNoise(imu, subject.seed + 1)

    def source(name: str) -> Source:
        scale = getattr(imu, name).scale

        def at(tick: int) -> list[float]:
            seconds = (tick - start) / ticks
            added = None if noise is None else noise.at(max(0, int(seconds / imu.period)))
            return [lsb / scale for lsb in felt.at(seconds, added)[name]]

        return at

    return {name: source(name) for name in SENSORS}


def _read(scene: Scene, subject: EmulatorUnderTest, progress: Progress | None) -> Readings:
    assert scene.head is not None
    log = SampleLog(scene.head, scene.start, scene.timebase.per_second)
    scene.run(subject.duration, progress)
    return log.readings()
