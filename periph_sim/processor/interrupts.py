"""Interrupt lines of one unit, from its modules to the PIE and the CPU.

    module --its interrupt lines--> PIE --INT1 to INT12--> Processor
    CPU timers 1 and 2 --INT13, INT14--> Processor

Source: SPRUFB0D sections 8.1 to 8.5.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from ..core.socket import Socket
from ..f28335.cpu.interrupts import int13_source
from ..f28335.descriptor import ModuleDescriptor
from ..f28335.pie.module import Pie
from ..f28335.pie.register_map import CPU_VECTORS, LINES
from .processor import Processor

INT13 = 13


Handler = Callable[[int, int], None]  # called with a cycle and a mask of the interrupt lines of a module
Places = tuple[tuple[int, int], ...]  # (group, line) in the PIE, for each interrupt line of a module to the PIE


class InterruptLines:
    """The interrupt lines from the modules of a unit to its PIE and CPU.

    processor: the CPU. It must be set before time passes.
    """

    processor: Processor

    def __init__(self, pie: Pie, sockets: Mapping[str, Socket]) -> None:
        """sockets: the modules of the unit, by name."""
        self._pie = pie
        self._sockets = sockets

    def request_handler(self, descriptor: ModuleDescriptor) -> Handler:
        """Return the function that passes the interrupt requests of a module to the PIE, or directly to the CPU."""
        lines = pie_lines(descriptor)
        if lines or not descriptor.interrupts:
            return partial(self._requested, lines)
        return partial(self._cpu_requested, CPU_VECTORS[descriptor.interrupts[0].vector])

    def follow_pie(self, cycle: int) -> None:
        """Pass to the CPU the pulses that the PIE has made on the lines INT1 to INT12."""
        pulses, self._pie.pulses = self._pie.pulses, 0
        number = 1
        while pulses:
            if pulses & 1:
                self.processor.request(cycle, number)
            pulses >>= 1
            number += 1

    def _cpu_requested(self, interrupt: int, cycle: int, lines: int) -> None:
        """Request INT13 or INT14. INT13 belongs to timer 1 unless XNMICR selects the XNMI pin [SPRUFB0D Table 123]."""
        xint = self._sockets.get("XINT")
        xnmicr = 0 if xint is None else xint.chip.peek(cycle, xint.chip.MAP["XNMICR"].offset)
        if interrupt != INT13 or int13_source(xnmicr) == "TINT1":
            self.processor.request(cycle, interrupt)

    def _requested(self, places: Places, cycle: int, lines: int) -> None:
        for i, (group, line) in enumerate(places):
            if lines >> i & 1:
                self._pie.request(cycle, group, line)
        self._sockets["PIE"].publish(cycle)

    def held(self, places: Places, cycle: int, held: int) -> None:
        """Pass the levels of a module's interrupt lines to the PIE. held: mask of the lines that are active."""
        for i, (group, line) in enumerate(places):
            self._pie.hold(cycle, group, line, bool(held >> i & 1))
        self._sockets["PIE"].publish(cycle)


def pie_lines(descriptor: ModuleDescriptor) -> Places:
    """Return (group, line) in the PIE for each interrupt line of a module that leads to the PIE, in order.

    The lines of INT13 and INT14, which lead directly to the CPU, are left out.
    """
    return tuple(LINES[one.vector] for one in descriptor.interrupts if one.vector in LINES)
