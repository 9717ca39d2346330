"""Origins of the bytes that a scene's controller reads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

from ..core.sampler import watch
from ..timing.derived.origins import FrameOrigins, ModelOrigins, Origins

if TYPE_CHECKING:
    from ..core.wire import Wire
    from ..devices.model_codes import Computed
    from ..imu.models.parameters import ImuParameters
    from ..processor.dsp import Dsp
    from .case.model import BadCase, Case

MODEL_PIN = "MODEL"  # what a case calls the pin that firmware raises while its models run


class Parts(Protocol):
    """sensors: whose values firmware computes, where it has models. computed: and how it computes them."""

    @property
    def case(self) -> Case: ...

    @property
    def wires(self) -> Mapping[str, Wire]: ...

    @property
    def units(self) -> Mapping[str, Dsp]: ...

    @property
    def sensors(self) -> ImuParameters | None: ...

    @property
    def computed(self) -> Computed | None: ...


def origins_of(scene: Parts) -> Origins:
    """Return the origins of a scene's reads. BadCase if values of sensor models could not be recognized."""
    if scene.sensors is None:
        return FrameOrigins()
    if scene.computed is None:
        raise _mistake(scene.case, "the firmware has sensor models, but no setting says their arithmetic")
    if MODEL_PIN not in scene.wires:
        what = "what sensor models show can be checked only with the pin that is high while they run"
        raise _mistake(scene.case, f"{what}; give the unit pins = {{ {MODEL_PIN} = 34 }}")
    origins = ModelOrigins(scene.computed)
    watch([scene.wires[MODEL_PIN]], origins.model_pin)
    for dsp in scene.units.values():
        dsp.on_reset.append(origins.reset)
    return origins


def _mistake(case: Case, what: str) -> BadCase:
    """Return an error about the key that asks for origins: `check` of the table that says the rounds."""
    return case.mistake(what, "rounds" if case.line("rounds") else "controller", "check")
