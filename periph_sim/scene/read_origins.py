"""Where the bytes that a scene's controller reads come from: a scene goes in, the origins of its reads come out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

from ..timing.measures.origins import FrameOrigins, ModelOrigins, Origins, Sources

if TYPE_CHECKING:
    from ..core.wire import Wire
    from ..devices.model_codes import Computed
    from ..processor.dsp import Dsp
    from ..sensors.models.parameters import ImuParameters
    from .case.model import Case

MODEL_PIN = "MODEL"  # what a case calls the pin that firmware raises while its models run


class Parts(Sources, Protocol):
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
    """BadCase where the values of sensor models could not be told from others."""
    if scene.sensors is None:
        return FrameOrigins(scene)
    place = ("rounds" if scene.case.line("rounds") else "controller", "check")
    if scene.computed is None:
        raise scene.case.mistake("the firmware has sensor models, but no setting says their arithmetic", *place)
    if MODEL_PIN not in scene.wires:
        what = "what sensor models show can be checked only with the pin that is high while they run"
        raise scene.case.mistake(f"{what}; give the unit pins = {{ {MODEL_PIN} = 34 }}", *place)
    origins = ModelOrigins(scene, scene.computed)
    scene.wires[MODEL_PIN].watch(origins.model_pin)
    for dsp in scene.units.values():
        dsp.on_reset.append(origins.reset)
    return origins
