"""The descriptor of the PIE. Sources: SPRS439M Table 3-8; SPRUFB0D section 8."""

from __future__ import annotations

from ..descriptor import Frame, ModuleDescriptor
from .register_map import BASE, MAP

PIE = ModuleDescriptor(
    name="PIE",
    registers=MAP,
    base=BASE,
    size=0x20,
    frame=Frame.PF0,
    header={"PieCtrlRegs": 0},
    inputs=None,
)
