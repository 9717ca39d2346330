"""The TMS320F28334, with half the flash of the F28335.

Source: SPRS439M Table 2-1, Table 3-12 (PARTID), Figure 3-3 (memory).
"""

from __future__ import annotations

from ..descriptor import Part
from .f28335 import MODULES

PART = Part("F28334", MODULES, flash=range(0x32_0000, 0x34_0000), part_id=0x00EE)
