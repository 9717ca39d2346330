"""The TMS320F28335. Source: SPRS439M Tables 3-8 to 3-11; Figure 3-2 (memory), Table 3-12 (PARTID)."""

from __future__ import annotations

from ..cpu_timer.descriptor import TIMERS
from ..descriptor import Part
from ..gpio.descriptor import GPIO
from ..i2c.descriptor import I2C_A
from ..pie.descriptor import PIE
from ..sci.descriptor import SCIS
from ..spi.descriptor import SPI_A
from ..system_control.descriptor import SYS
from ..xint.descriptor import XINT

MODULES = (*SCIS, I2C_A, SPI_A, GPIO, XINT, SYS, PIE, *TIMERS)
PART = Part("F28335", MODULES, flash=range(0x30_0000, 0x34_0000), part_id=0x00EF)
