"""The descriptor of system control. Sources: SPRS439M Table 3-10; SPRUFB0D section 5."""

from __future__ import annotations

from ..descriptor import Frame, Interrupt, ModuleDescriptor
from .register_map import BASE, MAP

SYS = ModuleDescriptor(
    name="SYS",
    registers=MAP,
    base=BASE,
    size=0x20,
    frame=Frame.PF2,
    header={"SysCtrlRegs": 0},
    interrupts=(Interrupt("WAKEINT"),),
)
