"""The classes of options by the names under which commands show them: `i2c`, `sci`, `system`, and the chips' models."""

from __future__ import annotations

from ..core.options import Answers
from ..devices.chips import chip_models
from ..f28335.i2c.options import I2cOptions
from ..f28335.sci.options import SciOptions
from ..f28335.system.options import SystemOptions

OPTIONS: dict[str, type[Answers]] = {
    "i2c": I2cOptions,
    "sci": SciOptions,
    "system": SystemOptions,
    **{model: chip.OPTIONS for model, chip in chip_models().items()},
}
