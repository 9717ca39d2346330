"""The classes of options by the names under which commands show them: `i2c`, `sci`, `system`, and the chips' models."""

from __future__ import annotations

from ..devices.chips.adxl345 import Adxl345Options
from ..devices.chips.hmc5883l import Hmc5883lOptions
from ..devices.chips.itg3200 import Itg3200Options
from ..f28335.i2c.options import I2cOptions
from ..f28335.sci.options import SciOptions
from ..f28335.system.options import SystemOptions

OPTIONS: dict[str, type] = {
    "i2c": I2cOptions,
    "sci": SciOptions,
    "system": SystemOptions,
    "adxl345": Adxl345Options,
    "itg3200": Itg3200Options,
    "hmc5883l": Hmc5883lOptions,
}
