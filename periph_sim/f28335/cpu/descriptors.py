"""The descriptors of the PIE and of the external interrupts. Sources: SPRS439M Tables 3-8, 3-10; SPRUFB0D section 8."""

from __future__ import annotations

from ..descriptor import Frame, Interrupt, ModuleDescriptor
from . import pie_map, xint_map

PIE = ModuleDescriptor(
    name="PIE",
    registers=pie_map.MAP,
    base=pie_map.BASE,
    size=0x20,
    frame=Frame.PF0,
    header={"PieCtrlRegs": 0},
    inputs=None,
)
XINT = ModuleDescriptor(
    name="XINT",
    registers=xint_map.XINT,
    base=xint_map.BASE,
    size=0x10,
    frame=Frame.PF2,
    header={"XIntruptRegs": 0},
    chip="cpu.xint.Xint",
    interrupts=(*(Interrupt(f"XINT{number}") for number in range(1, 8)), Interrupt("INT13", shared=True)),
    inputs=None,
)
