"""The descriptors of system control and of the CPU timers. Sources: SPRS439M Tables 3-8, 3-10; SPRUFB0D section 5."""

from __future__ import annotations

from ..descriptor import Frame, Interrupt, ModuleDescriptor
from . import clocks_map, cpu_timer_map

VECTORS = ("TINT0", "INT13", "INT14")  # SPRUFB0D Figure 32


def timer(number: int) -> ModuleDescriptor:
    """Return the descriptor of CPU timer `number`. Timer 1 shares INT13 with the pin XNMI."""
    return ModuleDescriptor(
        name=f"TIMER{number}",
        registers=cpu_timer_map.MAP,
        base=cpu_timer_map.BASES[number],
        size=8,
        frame=Frame.PF0,
        header={f"CpuTimer{number}Regs": 0},
        chip="system.cpu_timer.CpuTimer",
        takes=("number", "options"),
        gate=f"CPUTIMER{number}ENCLK",
        interrupts=(Interrupt(VECTORS[number], ("TCR.TIF", "TCR.TIE"), shared=VECTORS[number] == "INT13"),),
    )


SYS = ModuleDescriptor(
    name="SYS",
    registers=clocks_map.MAP,
    base=clocks_map.BASE,
    size=0x20,
    frame=Frame.PF2,
    header={"SysCtrlRegs": 0},
    interrupts=(Interrupt("WAKEINT"),),
)
TIMERS = tuple(map(timer, range(3)))
