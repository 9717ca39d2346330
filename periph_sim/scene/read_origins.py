"""Origins of the bytes that a scene's controller reads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

from ..core.sampler import watch
from ..devices.host_frames import host_frames
from ..timing.derived.origins import FrameOrigins, ModelOrigins, Origins

if TYPE_CHECKING:
    from ..core.wire import Wire
    from ..processor.dsp import Dsp
    from .case.model import BadCase, Case
    from .firmware_model import FirmwareModel

MODEL_PIN = "MODEL"  # what a case calls the pin that firmware raises while its models run


class Parts(Protocol):
    """The parts of a scene that the origins need. model: the model with which firmware computes the data of chips."""

    @property
    def case(self) -> Case: ...

    @property
    def wires(self) -> Mapping[str, Wire]: ...

    @property
    def units(self) -> Mapping[str, Dsp]: ...

    @property
    def model(self) -> FirmwareModel | None: ...


def origins_of(scene: Parts) -> Origins:
    """Return the origins of a scene's reads. BadCase if values of sensor models could not be recognized."""
    if scene.model is None:
        return FrameOrigins(host_frames())
    codes = scene.model.codes()
    if codes is None:
        raise _mistake(scene.case, "the firmware has sensor models, but no setting says their arithmetic")
    if MODEL_PIN not in scene.wires:
        what = "what sensor models show can be checked only with the pin that is high while they run"
        raise _mistake(scene.case, f"{what}; give the unit pins = {{ {MODEL_PIN} = 34 }}")
    origins = ModelOrigins(codes)
    watch([scene.wires[MODEL_PIN]], origins.model_pin)
    for dsp in scene.units.values():
        dsp.on_reset.append(origins.reset)
    return origins


def _mistake(case: Case, what: str) -> BadCase:
    """Return an error about the key `check` of [rounds] or [controller], the table that defines the rounds."""
    return case.mistake(what, "rounds" if case.line("rounds") else "controller", "check")
