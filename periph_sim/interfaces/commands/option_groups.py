"""The classes of options by their names in commands: `i2c`, `sci`, `system`, and the chips' models."""

from __future__ import annotations

from ...core.options import Answers
from ...devices.chips import chip_models
from ...f28335.parts.f28335 import PART

OPTIONS: dict[str, type[Answers]] = {
    **PART.options_classes(),
    **{model: chip.OPTIONS for model, chip in chip_models().items()},
}
