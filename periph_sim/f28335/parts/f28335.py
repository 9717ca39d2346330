"""The TMS320F28335. Source: SPRS439M Tables 3-8 to 3-11; Figure 3-2 (memory), Table 3-12 (PARTID)."""

from __future__ import annotations

from ..cpu.descriptors import PIE, XINT
from ..descriptor import Part
from ..gpio.descriptor import GPIO
from ..i2c.descriptor import I2C_A
from ..sci.descriptor import SCIS
from ..spi.descriptor import SPI_A
from ..system.descriptors import SYS, TIMERS

MODULES = (*SCIS, I2C_A, SPI_A, GPIO, XINT, SYS, PIE, *TIMERS)
PART = Part("F28335", MODULES, flash=range(0x30_0000, 0x34_0000), part_id=0x00EF)
