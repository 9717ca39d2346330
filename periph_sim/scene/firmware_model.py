"""Interface of firmware that computes the data of chips from host frames by a model of its own.

settings with `sensors` --firmware_model_of--> FirmwareModel --> check of the case, true values, right bytes
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Protocol, cast

from ..core.registered import registered

if TYPE_CHECKING:
    from ..devices.chip_model import ChipModel
    from ..devices.truth import Truth
    from .case.model import Case


class FirmwareModel(Protocol):
    """Firmware with a model, as a scene uses it."""

    def check(self, case: Case, unit: str) -> None:
        """Raise BadCase if the case does not run the model as the model needs it."""

    def codes(self) -> ChipModel | None:
        """Return the model of the bytes that the chips should show; None if the settings do not determine it."""

    def truth(self, motion: Any, first: Fraction) -> Truth:
        """Return the true values during a motion. first: seconds of the motion's time at which frame 0 is due."""

    def attitude(self, readings: Mapping[str, Sequence[float]]) -> list[float] | None:
        """Return roll, pitch, yaw in degrees from the last readings by chip; None if they do not suffice."""


def firmware_model_of(settings: object) -> FirmwareModel | None:
    """Return the model of a firmware with these settings; None if it has none, since they name no `sensors`."""
    if getattr(settings, "sensors", None) is None:
        return None
    return cast("FirmwareModel | None", registered("firmware model").firmware_model(settings))
