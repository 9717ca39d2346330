"""The descriptor of the external interrupts. Sources: SPRS439M Table 3-10; SPRUFB0D section 8.6."""

from __future__ import annotations

from ..descriptor import Frame, Interrupt, ModuleDescriptor
from .register_map import BASE
from .register_map import XINT as REGISTERS

XINT = ModuleDescriptor(
    name="XINT",
    registers=REGISTERS,
    base=BASE,
    size=0x10,
    frame=Frame.PF2,
    header={"XIntruptRegs": 0},
    chip="xint.module.Xint",
    interrupts=(*(Interrupt(f"XINT{number}") for number in range(1, 8)), Interrupt("INT13", shared=True)),
    inputs=None,
)
