"""The descriptors of the three CPU timers. Sources: SPRS439M Table 3-8; SPRUFB0D section 5.5."""

from __future__ import annotations

from ..descriptor import Frame, Interrupt, ModuleDescriptor
from .register_map import BASES, MAP

VECTORS = ("TINT0", "INT13", "INT14")  # SPRUFB0D Figure 32


def timer(number: int) -> ModuleDescriptor:
    """Return the descriptor of CPU timer 0, 1 or 2. Timer 1 shares INT13 with the pin XNMI."""
    return ModuleDescriptor(
        name=f"TIMER{number}",
        registers=MAP,
        base=BASES[number],
        size=8,
        frame=Frame.PF0,
        header={f"CpuTimer{number}Regs": 0},
        chip="cpu_timer.module.CpuTimer",
        takes=("options",),
        gate=f"CPUTIMER{number}ENCLK",
        interrupts=(Interrupt(VECTORS[number], ("TCR.TIF", "TCR.TIE"), shared=VECTORS[number] == "INT13"),),
    )


TIMERS = tuple(map(timer, range(3)))
