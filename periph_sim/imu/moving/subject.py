"""The subject of a moving experiment: motion, sensors and frames of a case.

The host of the case must have a motion, the firmware must have sensor models, and the controller must read the three
chips of `sensors.SENSORS`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

from msgspec import structs

from ...scene.case.model import Case
from ...scene.case.party_tables import Controller, HostTable
from ...scene.scene import Scene
from ..firmware_model import ImuFirmware
from ..host_frame import MotionFrames
from ..models.parameters import ImuParameters, Rates
from ..motion import Motion
from ..sensors import SENSORS


@dataclass(frozen=True)
class EmulatorUnderTest:
    """The case of a moving experiment, and the parts of it that the experiment uses.

    unit: the case's name for the F28335 that runs the emulator.
    sensors: the parameters of the emulator's sensor models.
    arithmetic: the name of the emulator's arithmetic.
    seed: the seed of the emulator's noise; None for no noise.
    runs_per_frame: True if the emulator runs its models once per host frame instead of once per round.
    host, controller: the tables [host] and [controller] of the case.
    frames: the frames of the host.
    duration: the duration of the experiment in seconds.
    """

    case: Case
    unit: str
    sensors: ImuParameters
    arithmetic: str
    seed: int | None
    runs_per_frame: bool
    host: HostTable
    controller: Controller
    frames: MotionFrames
    duration: Fraction

    @property
    def scales(self) -> dict[str, float]:
        """The number of LSB per unit of each emulated chip, by the name of the chip."""
        return {name: getattr(self.sensors, name).scale for name in SENSORS}

    @property
    def motion(self) -> Motion:
        """The true motion of the body."""
        return self.frames.motion.truth

    def with_rates(self, rates: Rates) -> EmulatorUnderTest:
        """Return a copy of the subject whose gyroscope measures the rates `rates`: "as built" or "corrected"."""
        sensors = structs.replace(self.sensors, gyroscope=structs.replace(self.sensors.gyroscope, rates=rates))
        unit = self.case.unit[self.unit]
        unit = unit.model_copy(update={"settings": {**unit.settings, "parameters": sensors}})
        case = self.case.model_copy(update={"unit": {**self.case.unit, self.unit: unit}})
        return replace(self, case=case, sensors=sensors)

    @property
    def rounds(self) -> int:
        """The number of rounds that are due before the end of the experiment."""
        left = self.duration - self.controller.first
        most = max(0, -(-left // self.controller.period))
        return most if self.controller.rounds is None else min(most, self.controller.rounds)


def subject_of(case: Case, duration: Fraction | None = None) -> EmulatorUnderTest:
    """Return the subject of a case. Raise BadCase, with file and line, if the case is unsuitable.

    duration: the duration of the experiment in seconds; None for the duration of the case.
    """
    # The experiment judges no budgets, so the keys `budget` and `breaks` are emptied. The copy still contains the name
    # of the file, for messages.
    case = case.model_copy(update={"budget": (), "breaks": ()})
    scene = Scene(case)
    if case.host is None or not isinstance(scene.frames, MotionFrames):
        raise case.mistake("a moving experiment needs a motion; give host.motion", "host")
    if case.host.lose:
        raise case.mistake("a lost byte shifts all others; a moving experiment needs whole frames", "host", "lose")
    if case.inputs is not None and not (case.inputs.rounds is None and case.inputs.frames is None):
        what = (
            "a moving experiment has its rounds and frames by the schedules of [controller] and [host]; leave them out"
        )
        raise case.mistake(what, "inputs")
    names = {request.name for request in scene.requests}
    if case.controller is None or names != set(SENSORS) or len(scene.requests) != len(SENSORS):
        raise case.mistake(f"a moving experiment reads {', '.join(SENSORS)} in each round", "controller", "order")
    if not isinstance(scene.model, ImuFirmware) or len(case.unit) != 1 or scene.model.arithmetic is None:
        raise case.mistake('a moving experiment needs one unit with sensor models; give it arithmetic = "q16"', "unit")
    sensors = scene.model.parameters
    if sensors.magnetometer.board_azimuth or sensors.magnetometer.board_elevation:
        raise case.mistake("the sensor head does not support an inclined magnetometer board; make it 0", "unit")
    if (case.duration if duration is None else duration) <= case.controller.first:
        raise case.mistake("no round is due before the end; run longer, or start the first one earlier", "controller")
    (unit,) = case.unit
    return EmulatorUnderTest(
        case,
        unit,
        sensors,
        scene.model.arithmetic,
        scene.model.noise_seed,
        scene.model.runs_per_frame,
        case.host,
        case.controller,
        scene.frames,
        case.duration if duration is None else duration,
    )
