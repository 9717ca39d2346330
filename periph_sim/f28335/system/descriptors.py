"""The descriptors of system control and of the CPU timers. Sources: SPRS439M Tables 3-8, 3-10; SPRUFB0D section 5."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ...core.options import Answers
from ..descriptor import Frame, Interrupt, ModuleDescriptor
from . import clocks_map, cpu_timer_map
from .options import SystemOptions

if TYPE_CHECKING:
    from .cpu_timer import CpuTimer

VECTORS = ("TINT0", "INT13", "INT14")  # SPRUFB0D Figure 32


def build_timer(name: str, options: Mapping[str, Answers]) -> CpuTimer:
    from .cpu_timer import CpuTimer

    given = options.get("system")
    return CpuTimer(int(name[-1]), given if isinstance(given, SystemOptions) else SystemOptions())


def timer(number: int) -> ModuleDescriptor:
    """The descriptor of CPU timer `number`. Timer 1 shares INT13 with the pin XNMI."""
    return ModuleDescriptor(
        name=f"TIMER{number}",
        registers=cpu_timer_map.MAP,
        base=cpu_timer_map.BASES[number],
        size=8,
        frame=Frame.PF0,
        header={f"CpuTimer{number}Regs": 0},
        build=build_timer,
        gate=f"CPUTIMER{number}ENCLK",
        interrupts=(Interrupt(VECTORS[number], ("TCR.TIF", "TCR.TIE"), shared=VECTORS[number] == "INT13"),),
    )


def options_class() -> type[Answers]:
    return SystemOptions


SYS = ModuleDescriptor(
    name="SYS",
    registers=clocks_map.MAP,
    base=clocks_map.BASE,
    size=0x20,
    frame=Frame.PF2,
    header={"SysCtrlRegs": 0},
    options_class=options_class,
    interrupts=(Interrupt("WAKEINT"),),
)
TIMERS = tuple(map(timer, range(3)))
