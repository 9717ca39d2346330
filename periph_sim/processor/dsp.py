"""One F28335 of a scene: its clock, the requested modules, interrupts, and the CPU that runs the firmware.

    modules --> sockets --> address map --> Processor <-- program: Cpu <-- firmware
                   |  requests --> PIE --> CPU interrupts
                   pins --> Router --> wires

Only requested modules are built: a unit without SCI has no SCI object, events or cost.
System control, PIE and the CPU's interrupt logic belong to every unit.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from msgspec import Struct, field

from ..core.chip import Chip, Note
from ..core.kernel import CHIP, PADS, Kernel
from ..core.options import Answers
from ..core.records import Recorder
from ..core.sampler import watch
from ..core.socket import Socket
from ..core.state import State
from ..core.time import Clock, Timebase
from ..core.wire import Wire
from ..f28335.cpu.code_costs import CodeCosts
from ..f28335.cpu.interrupts import CpuInterrupts
from ..f28335.descriptor import ModuleDescriptor, Part
from ..f28335.memory.memory_map import AddressMap, ModuleRange
from ..f28335.parts.f28335 import PART
from ..f28335.pie.module import Pie
from ..f28335.system_control import register_map as clocks_map
from ..f28335.system_control.module import WDRST_CYCLES, SystemControl
from ..f28335.system_options import SystemOptions
from .interrupts import InterruptLines, pie_lines
from .processor import Processor, Program
from .python.cpu import Cpu
from .python.firmware_view import FirmwareView
from .python.waits import Waits
from .source_location import SourceLocation

if TYPE_CHECKING:
    from .host_code.firmware import HostFirmware
    from .image.boot import Boot, Stub
    from .image.program import ImageProgram
    from .image_files.model import Image
    from .pin_router import Port, Router


WATCHDOG_OFF = 0x68  # value of WDCR that disables the watchdog: WDDIS = 1 with the right check bits


class DspPlan(Struct):
    """Description of a unit, from which `Dsp` builds it.

    name: the name of the unit.
    modules: the names of the modules that the case requests.
    wires: the wires at the pins, by GPIO number.
    oscclk_hz, ppm: the nominal frequency of the crystal, and its error in parts per million.
    pll: the multiplier in PLLCR that the start-up code sets.
    from_boot: True if the firmware begins with the state after a reset, False if TI's start-up code has run before.
    skip_polls: True if passes of a wait that repeat the previous pass are skipped.
    keeps_decoded: True if an image decodes each instruction only once, False if it decodes it at each execution.
    strict: True if the run ends when the firmware violates a rule of the manuals (a note with the code "duty").
    seed: the seed of the durations that are drawn from spreads.
    costs: the durations, in seconds, of the first computations whose cost is a spread. Later durations are drawn.
    stall_limit: seconds of host CPU time that firmware may take at one instant of simulated time; 0 if unlimited.
    pulled_down: the GPIO numbers of the pins with an external pull-down resistor.
    part: the member of the F2833x family.
    code: the cycles that Python firmware takes for the code that a C compiler would place around its accesses.
    system: answers to open questions about the CPU and system control.
    options: for each group of options, the answers to open questions about modules. If a group is missing, its modules
        use the default answers.
    """

    name: str
    modules: tuple[str, ...]
    wires: dict[int, Wire]
    oscclk_hz: int = 30_000_000
    pll: int = 10
    ppm: Fraction = Fraction(0)
    from_boot: bool = False
    skip_polls: bool = True
    keeps_decoded: bool = True
    strict: bool = False
    seed: int = 0
    costs: tuple[Fraction, ...] = ()
    stall_limit: float = 0.0
    pulled_down: frozenset[int] = frozenset()
    part: Part = PART
    code: CodeCosts = field(default_factory=CodeCosts)
    system: SystemOptions = field(default_factory=SystemOptions)
    options: dict[str, Answers] = field(default_factory=dict)


class Dsp(FirmwareView):
    """A running F28335. Python firmware receives it as a `FirmwareView`.

    resets: the number of resets since the start.
    clock_history: (tick, frequency in Hz) of SYSCLKOUT at the start and after each change.
    note_places: by (socket's name, tick), the first statement that violated a rule of the manuals or wrote a word that
        was lost; see `_noted`.
    lost_counts: for each note on a lost word, for example in a full transmit FIFO, the number of its occurrences.
    watchdog_resets: (tick, statement) of each reset by the watchdog; the statement is None if it is unknown.
    on_reset: functions that are called at each reset.
    sources: the C sources that the unit runs; None for other firmware.
    """

    STATE = State("resets _held_in_reset _random _drawn")

    def __init__(self, kernel: Kernel, timebase: Timebase, recorder: Recorder, plan: DspPlan) -> None:
        super().__init__(plan.name, plan.seed, plan.costs)
        self.plan = plan
        self._kernel = kernel
        self.recorder = recorder
        self.control = SystemControl(plan.oscclk_hz, plan.system)
        began = 0 if plan.from_boot else start_up(self.control, plan.pll)
        self._nominal_hz = self.control.sysclk_hz  # SYSCLKOUT without the error of the crystal
        self.clock = Clock(timebase, self._sysclk_hz(), tick0=kernel.now, cycle0=began)
        self.clock_history = [(kernel.now, self.clock.hz)]
        self.memory = AddressMap()
        self.pie = Pie(plan.system)
        self.core = CpuInterrupts(plan.system)
        self._modules: list[tuple[ModuleDescriptor, Socket]] = []
        self._lines = InterruptLines(self.pie, self.sockets)
        self._firmware: Callable[[], None] = lambda: None
        self._restart: Callable[[int], None] = lambda delay: self.cpu.start(self._from_reset, delay)
        self._gates = self.control.gates
        self._lspclk = (self.control.lspclk_divider, self.control.lspclk_phase)
        self.resets, self._held_in_reset = 0, False  # `_held_in_reset` is True while XRS is low
        self.note_places: dict[tuple[str, int], SourceLocation] = {}
        self.lost_counts: Counter[Note] = Counter()
        self.watchdog_resets: list[tuple[int, SourceLocation | None]] = []
        self.on_reset: list[Callable[[], None]] = []
        # SYS and PIE belong to every unit. The code of the other modules is imported only if the plan names them.
        self._add(plan.part.by_name["SYS"], self.control)
        self._add(plan.part.by_name["PIE"], self.pie)
        self.sockets["SYS"].after = self._follow_control
        self.sockets["PIE"].after = self._lines.follow_pie
        options = {"system": plan.system, **plan.options}
        for descriptor in (plan.part.by_name[name] for name in plan.modules):
            chip = descriptor.build(options)
            chip.set_sysclk(0, self.control.sysclk_hz)
            self._add(descriptor, chip)
            if descriptor.clock == "LSPCLK":
                chip.set_lspclk(self.clock.cycle_at(kernel.now), *self._lspclk)
        self.processor = Processor(
            kernel, self.clock, recorder, plan.name, self.memory, self.core, self.pie, plan.system, strict=plan.strict
        )
        self._lines.processor = self.processor
        self.cpu = Cpu(self.processor, self.clock, recorder, plan.code)
        self.waits = Waits(self.cpu, plan.system.pf2_read_ws, plan.code.poll_pass, plan.skip_polls)
        self.cpu.program.stall_limit = plan.stall_limit
        self.program: Program = self.cpu.program
        self.sources: HostFirmware | None = None
        self.router = self._route(plan)
        cycle = self.clock.cycle_at(kernel.now)
        for socket in self.sockets.values():
            socket.publish(cycle)  # schedules the first wake-ups of the modules, for example of a running watchdog

    # Start and end -------------------------------------------------------------

    def start(self, firmware: Callable[[], None]) -> None:
        """Run Python firmware."""
        self._firmware = firmware
        self.cpu.start(firmware)

    def start_image(self, image: Image, boot: Boot = "entry", stubs: Iterable[Stub] = ()) -> ImageProgram:
        """Run an image instead of Python firmware, and return its program. A reset restarts the image.

        stubs: values that reads of unmodelled registers return. Raise BadImage if the image does not fit the chip.
        """
        from .image.boot import entry_of
        from .image.program import ImageProgram
        from .image_files.load import require_loadable, shared_memory

        require_loadable(image, self.plan.part)
        entry = entry_of(image, boot)
        plan = self.plan
        program = self.program = ImageProgram(
            self.processor, self.clock, image, entry, plan.system, plan.skip_polls, plan.keeps_decoded
        )
        self.processor.notes.placed = True
        program.cpu.elsewhere.set_part(self.plan.part)
        program.load()
        for sentence in shared_memory(image):
            self.processor.notes.note(0, Note("unknown", sentence, "SPRU513, UNION"))
        # A program may wait for the value of a stub. It is woken when a stub changes its value.
        program.cpu.elsewhere.changed = lambda: program.cpu.polls.resume(self.clock.cycle_at(self._kernel.now))
        for stub in stubs:
            program.cpu.elsewhere.to_come.append(stub.address)
            self._kernel.call_at(stub.tick, partial(program.cpu.elsewhere.answer, stub.address, stub.value))

        def begin(delay: int = 0) -> None:
            program.begin()
            if boot != "entry":
                cycle = self.clock.cycle_at(self._kernel.now)
                self.control.boot(cycle)  # sets the clock as the boot ROM does
                self.sockets["SYS"].publish(cycle)
            self.processor.start(program, delay)

        self._restart = begin
        begin()
        return program

    def _sysclk_hz(self) -> Fraction:
        return self.control.sysclk_hz * (1 + self.plan.ppm / 1_000_000)

    @property
    def touched(self) -> set[str]:
        """The open questions whose answers have affected the run so far, as "group.option"."""
        found = {f"system.{name}" for name in self.core.touched}
        for descriptor, socket in self._modules:
            found |= {f"{descriptor.options}.{option}" for option in socket.chip.touched}
        return found

    # Building ------------------------------------------------------------------

    def _add(self, descriptor: ModuleDescriptor, chip: Chip) -> None:
        name = descriptor.name
        phase = PADS if name == "GPIO" else CHIP
        on_request = self._lines.request_handler(descriptor)
        socket = Socket(self._kernel, self.clock, self.recorder, f"{self.name}.{name}", chip, on_request, phase)
        socket.on_held = partial(self._lines.held, pie_lines(descriptor))
        socket.on_note = partial(self._noted, socket)
        self.sockets[name] = socket
        self._modules.append((descriptor, socket))
        self.memory.places[name] = ModuleRange(name, descriptor.base, descriptor.size, descriptor.frame, socket)

    def _noted(self, socket: Socket, cycle: int, note: Note) -> None:
        """Count lost words, and keep the statement that violates a rule of the manuals or writes a word that is lost.

        If `FirmwareNotes.placed` is False, keep only the statement of the first occurrence of each note on a lost word.
        """
        placed = self.processor.notes.placed
        if note.code == "lost" and "was written" in note.text:
            self.lost_counts[note] += 1
            placed = placed or self.lost_counts[note] == 1
        elif note.code == "duty":
            self.processor.notes.raise_if_strict(note, socket.name, self._kernel.now)
        else:
            return
        if placed and (where := self.processor.causing_statement()) is not None:
            self.note_places.setdefault((socket.name, self.clock.tick(cycle)), where)

    def restored(self) -> None:
        """Treat the clocks and gates of a restored snapshot as already applied."""
        control = self.control
        self._nominal_hz, self._gates = control.sysclk_hz, control.gates
        self._lspclk = (control.lspclk_divider, control.lspclk_phase)

    def _follow_control(self, cycle: int) -> None:
        """Apply clocks, clock gates and resets that system control has changed."""
        control = self.control
        lspclk = (control.lspclk_divider, control.lspclk_phase)
        retuned = control.sysclk_hz != self._nominal_hz
        if retuned or lspclk != self._lspclk or control.gates != self._gates:
            self._kernel.materialize()
        if retuned:
            self._nominal_hz = control.sysclk_hz
            self.clock.retune(cycle, self._sysclk_hz())
            self.clock_history.append((self.clock.tick(cycle), self.clock.hz))
            for socket in self.sockets.values():
                socket.reclock()
            self.processor.time.reclock()
            for socket in self.sockets.values():
                if socket.chip.set_sysclk(cycle, control.sysclk_hz):
                    socket.publish(cycle)
        if lspclk != self._lspclk:
            self._lspclk = lspclk
            for descriptor, socket in self._modules:
                if descriptor.clock == "LSPCLK":
                    socket.chip.set_lspclk(cycle, *lspclk)
                    socket.publish(cycle)
        if control.gates != self._gates:
            self._gates = control.gates
            self.gate(cycle)
        if control.reset_requested:
            self._kernel.call_at(self._kernel.now, self._reset)

    def gate(self, cycle: int) -> None:
        """Enable or disable the clock of every module that has a clock gate, as PCLKCR selects."""
        for descriptor, socket in self._modules:
            if gate := descriptor.gate or descriptor.input_gate:
                socket.chip.gate(cycle, self.control.enabled(gate))
                socket.publish(cycle)

    def _route(self, plan: DspPlan) -> Router | None:
        inputs: dict[str, Port] = {}
        outputs: dict[str, Port] = {}
        for descriptor, socket in self._modules:
            inputs |= {signal: (socket, pin) for pin, signal in enumerate(descriptor.inputs or ())}
            outputs |= {signal: (socket, pin) for pin, signal in enumerate(descriptor.outputs)}
        gpio = self.sockets.get("GPIO")
        if gpio is not None:
            from ..f28335.gpio.module import Gpio
            from .pin_router import Router

            assert isinstance(gpio.chip, Gpio)
            xint = self.sockets.get("XINT")
            kernel, clock, recorder = self._kernel, self.clock, self.recorder
            return Router(
                kernel, clock, recorder, gpio.chip, gpio, plan.name, plan.wires, plan.pulled_down, inputs, outputs, xint
            )
        for signal, (socket, index) in inputs.items():
            wire = plan.wires.get(self.plan.part.pins[signal])
            if wire is not None:
                socket.inputs.listen(index, wire)  # the module samples the wire at each SYSCLKOUT edge
        for signal, (socket, index) in outputs.items():
            wire = plan.wires.get(self.plan.part.pins[signal])
            if wire is not None:
                socket.connect(index, [wire.attach(f"{plan.name}.{signal}")])
        return None

    # Reset -------------------------------------------------------------------------

    def connect_reset(self, xrs: Wire) -> None:
        """Connect the XRS pin to a wire. A low level holds this unit in reset."""
        watch([xrs], self._xrs_changed)

    def _xrs_changed(self, tick: int, level: int) -> None:
        """Begin or end the reset at the next cycle, since clocks change only at the start of a cycle."""
        self._kernel.call_at(self.clock.tick(self.clock.cycle_at(tick)), partial(self._hold_in_reset, not level))

    def _hold_in_reset(self, held: bool) -> None:
        """Begin or end a reset by XRS. At its end, reset the modules again, because timers count during it."""
        self._held_in_reset = held
        if held:
            self._enter_reset()
        else:
            self._reset_modules()
            self._restart(0)

    def _reset(self) -> None:
        """Reset the unit by the watchdog, which asserts XRS. If XRS is low already, reset only the modules."""
        if self.control.reset_requested and self._held_in_reset:
            self._reset_modules()
        elif self.control.reset_requested:
            self.watchdog_resets.append((self._kernel.now, self.program.place()))
            self._enter_reset()
            self._restart(WDRST_CYCLES)

    def _enter_reset(self) -> None:
        """Reset the CPU and every module, and stop the firmware at its present position."""
        self._kernel.materialize()
        self.resets += 1
        for callback in self.on_reset:
            callback()
        self.processor.kill()
        self._reset_modules()

    def _reset_modules(self) -> None:
        """Reset the interrupt logic of the CPU, and every module."""
        self._kernel.materialize()
        cycle = self.clock.cycle_at(self._kernel.now)
        self.core.reset(cycle)
        for socket in self.sockets.values():
            socket.chip.reset(cycle)
        for socket in self.sockets.values():
            socket.publish(cycle)  # after all resets, because the reset of SYS changes the clock
        self.gate(cycle)

    def _from_reset(self) -> None:
        """Run the firmware after a reset. If it has no start-up code of its own, run TI's start-up code first."""
        if not self.plan.from_boot:
            control = self.module("SYS")
            self.eallow()
            control.WDCR.all = WATCHDOG_OFF
            control.PLLSTS.MCLKOFF = 1
            control.PLLCR.all = self.plan.pll
            self.spin(lambda: control.PLLSTS.PLLLOCKS == 1)
            control.PLLSTS.MCLKOFF = 0
            control.PLLSTS.DIVSEL = 2
            self.edis()
        self._firmware()


def start_up(control: SystemControl, pll: int) -> int:
    """Set system control as TI's start-up code does: watchdog off, SYSCLKOUT = OSCCLK * `pll` / 2.

    Return the cycle at which main begins.
    """

    def write(cycle: int, register: str, value: int) -> None:
        control.write(cycle, clocks_map.MAP[register].offset, value)

    write(1, "WDCR", WATCHDOG_OFF)
    write(2, "PLLSTS", 1 << 6)
    write(3, "PLLCR", pll)
    locked = control.next_wake
    control.wake(locked)
    write(locked + 1, "PLLSTS", 0)
    write(locked + 2, "PLLSTS", 2 << 7)
    control.touched.clear()  # options that were used only before main do not affect the run
    return locked + 100
