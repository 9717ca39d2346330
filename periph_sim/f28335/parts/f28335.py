"""The TMS320F28335. Source: SPRS439M Tables 3-8 to 3-11."""

from __future__ import annotations

from ..cpu.descriptors import PIE, XINT
from ..descriptor import Part
from ..gpio.descriptor import GPIO
from ..i2c.descriptor import I2C_A
from ..sci.descriptor import SCIS
from ..spi.descriptor import SPI_A
from ..system.descriptors import SYS, TIMERS

PART = Part("F28335", (*SCIS, I2C_A, SPI_A, GPIO, XINT, SYS, PIE, *TIMERS))
