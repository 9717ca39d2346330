"""A CPU with one flag chip and a PIE on a kernel, and a log in which firmware notes what it sees."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.socket import Socket
from periph_sim.core.time import Clock, Timebase
from periph_sim.f28335.cpu.code_costs import BARE, CodeCosts
from periph_sim.f28335.cpu.interrupts import CpuInterrupts
from periph_sim.f28335.descriptor import Frame
from periph_sim.f28335.memory.memory_map import AddressMap, ModuleRange
from periph_sim.f28335.pie.module import Pie
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.processor.dsp import Dsp, DspPlan
from periph_sim.processor.processor import Processor
from periph_sim.processor.python.cpu import Cpu
from periph_sim.processor.python.register_view import ModulePort
from periph_sim.processor.python.waits import Waits
from tests.processor.flag_chip import FlagChip


def recorder_of(*kinds: Kind) -> tuple[Recorder, list[Record]]:
    """Return a recorder of these kinds, and the list that it fills."""
    recorder = Recorder()
    records: list[Record] = []
    recorder.subscribe(kinds, records.append)
    return recorder, records


def unit(*modules: str, recorder: Recorder | None = None, **plan: Any) -> tuple[Dsp, Kernel]:
    """Return a unit with these modules and no wires, and its kernel. plan: further values of its `DspPlan`."""
    kernel = Kernel()
    return Dsp(kernel, Timebase(150_000_000), recorder or Recorder(), DspPlan("dsp", modules, {}, **plan)), kernel


class Bench:
    """A processor with one `FlagChip`, whose two interrupt lines are PIE 1.1 (SEQ1INT) and PIE 1.2 (SEQ2INT).

    hz: SYSCLKOUT.
    beside: another bench, whose kernel and recorder this one shares.
    """

    def __init__(
        self,
        changes: list[tuple[int, int, int]],
        *,
        hz: Fraction = Fraction(150_000_000),
        options: SystemOptions | None = None,
        code: CodeCosts = BARE,
        frame: Frame = Frame.PF2,
        skip_polls: bool = True,
        recorder: Recorder | None = None,
        base: int = 0x7100,
        beside: Bench | None = None,
        name: str = "dsp",
    ) -> None:
        options = options or SystemOptions()
        self.kernel = Kernel() if beside is None else beside.kernel
        self.timebase = Timebase(150_000_000)
        self.recorder = recorder or (Recorder() if beside is None else beside.recorder)
        self.clock = Clock(self.timebase, hz)
        self.chip = FlagChip(changes)
        self.pie = Pie(options)
        self.core = CpuInterrupts(options)
        self.socket = Socket(self.kernel, self.clock, self.recorder, f"{name}.FLAGS", self.chip, self._asked)
        self.memory = memory = AddressMap()
        memory.places["FLAGS"] = ModuleRange("FLAGS", base, 2, frame, self.socket)
        self.pie_socket = Socket(self.kernel, self.clock, self.recorder, f"{name}.PIE", self.pie, lambda c, a: None)
        self.pie_socket.after = self._pulse
        memory.places["PIE"] = ModuleRange("PIE", 0x0CE0, 0x20, Frame.PF0, self.pie_socket)
        self.processor = Processor(self.kernel, self.clock, self.recorder, name, memory, self.core, self.pie, options)
        self.cpu = Cpu(self.processor, self.clock, self.recorder, code)
        self.waits = Waits(self.cpu, options.pf2_read_ws, code.poll_pass, skip_polls)
        self.flags = ModulePort(self.cpu, memory.places["FLAGS"])
        self.pie_regs = ModulePort(self.cpu, memory.places["PIE"])
        self.log: list[tuple[str, int]] = []
        self.socket.publish(0)

    def _asked(self, cycle: int, asked: int) -> None:
        for line in (0, 1):
            if asked >> line & 1:
                self.pie.request(cycle, 1, line + 1)
        self.pie_socket.publish(cycle)

    def _pulse(self, cycle: int) -> None:
        pulses, self.pie.pulses = self.pie.pulses, 0
        for n in range(12):
            if pulses >> n & 1:
                self.processor.request(cycle, n + 1)

    def note(self, what: str) -> None:
        """Note a name and the current cycle in the log."""
        self.log.append((what, self.cpu.cycle))

    def enable(self) -> None:
        """Enable the PIE, both of its lines and INT1, at no cost, before anything runs."""
        for offset, value in ((0x0, 1), (0x2, 3), (0x1, 0xFFF)):
            self.pie.write(0, offset, value)
        self.core.ier = 1
        self.core.st1 &= ~1

    def run(self, firmware: Callable[[], None], cycles: int) -> list[tuple[str, int]]:
        self.cpu.start(firmware)
        self.kernel.run_until(self.clock.tick(cycles))
        return self.log
