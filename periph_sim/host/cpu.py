"""Runs firmware written as plain Python functions, and makes it pay its cycles.

    firmware --> access, compute, spin --> cycles on this CPU's clock --> kernel, chips
                                      ^--- interrupts at instruction boundaries

Firmware runs in a greenlet of its own: every call below may let simulated time pass and
returns when it has. As long as nothing else can happen (`Kernel.quiet_until`) the CPU
moves time itself; else it gives way to the kernel and is resumed by an event.

A service routine is called on the firmware's own stack, where an instruction boundary
meets a pending request, exactly as on the chip.

Waiting is skipped: a pass of a spin whose reads have no side effect is made once; it
cannot come out otherwise before a register that it read changes or an interrupt is due.
At that moment the pass in progress is replayed from its start, reads that lie in the
past answering with what was read before, and goes on for real from there. So a spin ends
at the cycle at which polling pass by pass would have ended, at the cost of one event.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from greenlet import getcurrent, greenlet

from ..core.chip import NEVER, Note
from ..core.kernel import CPU, Kernel
from ..core.records import Kind, Recorder
from ..core.registers import Field, Register
from ..core.socket import Socket
from ..core.time import Clock
from ..f28335 import cpu_costs
from ..f28335.cpu import CpuInterrupts
from ..f28335.memory import WRITE_TO_READ, AddressMap, Frame, Place, WaitStates
from ..f28335.pie import Pie
from ..f28335.pie_map import GROUPS, PIEACK, VECTORS
from ..f28335.system_options import SystemOptions
from .place import PACKAGE, Places

FIRMWARE_VIEW = (str(Path("host", "registers.py")), str(Path("board", "dsp.py")))  # they refuse wrong names

READ_TO_WRITE = 2  # cycles from the read of a read-modify-write to its write: R2 to W of one instruction

NAME_OF = {address: name for name, address in VECTORS.items()}

Handler = Callable[[], None]
Peek = Callable[[int, int], int]  # cycle and offset to what a debugger reads


class FirmwareError(Exception):
    """Firmware that cannot go on: it raised, or it did what a scene with `strict` does not allow."""


class Poll(NamedTuple):
    """One read made in a pass of a spin: where, what, and when its value was taken."""

    place: Place
    register: Register
    half: int
    field: Field | None  # what firmware looked at; None: all of it
    cycle: int
    value: int

    @property
    def mask(self) -> int:
        """The bits that firmware looked at."""
        return self.field.mask if self.field is not None else (1 << self.register.width) - 1

    def __str__(self) -> str:
        return f"{self.place.name}.{self.register.name}.{self.field.name if self.field is not None else 'all'}"


@dataclass(slots=True)
class Spin:
    """A wait in progress. since: the cycle at which it began. polls: reads of the present pass."""

    since: int
    where: str
    polls: list[Poll] = field(default_factory=list)
    pure: bool = True  # no write, no read with a side effect, no interrupt, no stall in this pass
    start: int = 0  # cycle at which the present pass began
    replay: list[Poll] = field(default_factory=list)
    replayed: int = 0
    live_from: int = 0  # reads before this cycle are answered from `replay`

    def waits_for(self) -> str:
        return " and ".join(dict.fromkeys(str(poll) for poll in self.polls))


class Lease:
    """As long as no bit that a pass looked at has changed, every further pass comes out the same."""

    __slots__ = ("_cpu", "_first", "_seen", "sockets")

    def __init__(self, cpu: Cpu, spin: Spin) -> None:
        self._cpu = cpu
        self._first = cpu.cycle
        self._seen: list[tuple[Peek, int, int, int]] = []  # of what, offset, bits that count, what they were
        self.sockets: list[Socket] = []
        for poll in spin.polls:
            socket, offset, mask, value = poll.place.socket, poll.register.offset + poll.half, poll.mask, poll.value
            peek = socket.chip.peek if socket.before is None else socket.peek
            if socket not in self.sockets:
                self.sockets.append(socket)
            if mask & 0xFFFF:
                self._seen.append((peek, offset, mask & 0xFFFF, value & mask & 0xFFFF))
            if mask >> 16:
                self._seen.append((peek, offset + 1, mask >> 16, (value & mask) >> 16))

    def broken(self, cycle: int) -> bool:
        """Whether a pass begun at `cycle` could come out otherwise."""
        for peek, offset, mask, value in self._seen:  # noqa: SIM110 (a generator would cost more than the looks)
            if peek(cycle, offset) & mask != value:
                return True
        return False

    def look(self, cycle: int) -> None:
        """A module that was read has had an input."""
        if self.broken(cycle):
            self._cpu.resume_by(max(cycle, self._first))


class Cpu:
    """One C28x with its firmware. cycle: how many SYSCLKOUT cycles have passed for it.

    skip_polls: False makes every pass of every spin for real (the brute force that the
    skipping is proven against).
    """

    __slots__ = (
        "_branch",
        "_clock",
        "_free_from",
        "_greenlet",
        "_hub",
        "_interruptible",
        "_kernel",
        "_last_pf1_write",
        "_lease",
        "_options",
        "_pie",
        "_places",
        "_recorded",
        "_recorder",
        "_records_access",
        "_records_irq",
        "_records_span",
        "_records_wait",
        "_skip_polls",
        "_waits",
        "_wake",
        "_wake_cycle",
        "_wake_tick",
        "busy_cycles",
        "core",
        "cycle",
        "finished",
        "handlers",
        "memory",
        "name",
        "notes",
        "polls_skipped",
        "spin_now",
        "strict",
    )

    def __init__(
        self,
        kernel: Kernel,
        clock: Clock,
        recorder: Recorder,
        name: str,
        memory: AddressMap,
        core: CpuInterrupts,
        pie: Pie,
        options: SystemOptions,
        *,
        skip_polls: bool = True,
        strict: bool = False,
    ) -> None:
        self.name = name
        self.memory = memory
        self.core = core
        self.strict = strict
        self.cycle = 0
        self.handlers: dict[str, Handler] = {}
        self.notes: dict[Note, int] = {}
        self.spin_now: Spin | None = None
        self.polls_skipped = 0
        self.busy_cycles = 0  # spent in compute and service routines, not in spins
        self._kernel = kernel
        self._clock = clock
        self._recorder = recorder
        self._records_access = recorder.wants(Kind.ACCESS)
        wanted = recorder.subjects(Kind.ACCESS)
        self._recorded = None if wanted is None else frozenset(subject.rpartition(".")[2] for subject in wanted)
        self._records_irq = recorder.wants(Kind.IRQ)
        self._records_span = recorder.wants(Kind.SPAN)
        self._records_wait = recorder.wants(Kind.WAIT)
        self._places = Places()
        self._pie = pie
        self._waits = WaitStates(options)
        self._options = options
        self._branch = max(0, options.poll_loop_cycles - 1 - options.pf2_read_ws)
        self._skip_polls = skip_polls
        self._free_from = 0  # from this cycle on reads in the protected block need not wait for a write
        self._last_pf1_write = -NEVER
        self._greenlet: greenlet | None = None
        self._hub: greenlet | None = None
        self._wake = 0  # the promise by which this CPU is resumed, 0 when there is none
        self._wake_tick = 0
        self._wake_cycle = 0
        self._lease = 0  # before this cycle nothing but this CPU can act; 0: not known
        self._interruptible = False  # asleep at an instruction boundary
        self.finished = False

    # Life --------------------------------------------------------------------

    def start(self, firmware: Callable[[], None], delay: int = 0) -> None:
        """Run `firmware` from `delay` cycles after now on."""
        self.cycle = self._clock.cycle_at(self._kernel.now) + delay
        self.finished = False

        def body() -> None:
            try:
                firmware()
            except Exception as error:
                blamed = raised_at(error)
                if not blamed or isinstance(error, FirmwareError):
                    raise
                text = str(error.args[0]) if error.args else "no message"
                raise FirmwareError(f"{self.name}: {type(error).__name__} at {blamed}: {text}") from error
            self.finished = True

        self._greenlet = greenlet(body)
        self._wake_at(self.cycle)

    def kill(self, how: type[BaseException]) -> None:
        """Stop the firmware where it stands: `how` is raised in it, so that its `finally` blocks run."""
        if self._wake:
            self._kernel.cancel(self._wake)
            self._wake = 0
        self.spin_now = None
        self._interruptible = False
        dying, self._greenlet = self._greenlet, None
        if dying is not None and not dying.dead:
            dying.throw(how)

    def reclock(self) -> None:
        """The clock was retuned: a resumption promised for a cycle moves to that cycle's new tick."""
        if self._wake:
            self._kernel.cancel(self._wake)
            self._wake_at(self._wake_cycle)

    def _wake_at(self, cycle: int) -> None:
        tick, now = self._clock.tick(cycle), self._kernel.now
        self._wake_cycle = cycle
        self._wake_tick = tick = tick if tick > now else now
        self._wake = self._kernel.at(tick, self._resume, CPU)

    def _resume(self) -> None:
        self._wake = 0
        self._lease = 0
        self._hub = getcurrent()
        assert self._greenlet is not None
        outer = self._recorder.cause
        self._greenlet.switch()
        self._recorder.cause = outer

    @property
    def sleeps_in_spin(self) -> bool:
        """A spin is being skipped: it goes on when a register that it reads changes, or an interrupt is due."""
        return self.spin_now is not None and self._interruptible and not self._wake

    def _sleep(self) -> None:
        """Give way to the kernel; returns when `_resume` runs."""
        assert self._hub is not None, "firmware calls the CPU only from inside a run"
        own = self._recorder.cause  # what happens meanwhile is not of our making
        self._hub.switch()
        self._recorder.cause = own

    # Time --------------------------------------------------------------------

    def _go_to(self, cycle: int) -> None:
        """Let time pass to `cycle`, which no interrupt cuts short. The past is where a replay moves: free."""
        if cycle >= self._lease:
            self._lease = self._clock.cycle_at(self._kernel.quiet_until())
            if cycle >= self._lease and self._clock.tick(cycle) > self._kernel.now:
                self._wake_at(cycle)
                self._sleep()
        self.cycle = cycle

    def instruction(self, cycles: int) -> None:
        """One instruction, or an inseparable few: interrupts wait for its end."""
        cycle = self.cycle + cycles
        if cycle >= self._lease:
            self._go_to(cycle)
        self.cycle = cycle
        core = self.core
        if core.ifr or core.next_wake <= cycle or core.owes_instruction:
            self._serve()

    def compute(self, cycles: int, name: str = "") -> None:
        """A stretch of single-cycle instructions; interrupts cut in at any of them. A name makes it a span."""
        if name:
            self.mark_span(name, 1)
        left = cycles
        self.busy_cycles += cycles
        while left > 0:
            began = self.cycle
            self._rest_until(began + left)
            left -= self.cycle - began
            if self.core.ifr or self.core.next_wake <= self.cycle:
                self._serve()
        if name:
            self.mark_span(name, 0)

    def mark_span(self, name: str, begins: int) -> None:
        """Record that a named stretch of firmware begins (1) or ends (0) at this cycle."""
        if self._records_span:
            where = self._places.now(1) if begins else ""
            self._recorder.emit(self._clock.tick(self.cycle), Kind.SPAN, self.name, name, begins, where)

    def idle(self) -> None:
        """IDLE: nothing until an interrupt that IER enables; with INTM = 0 it is served first."""
        self.core.idle(self.cycle)
        if self._records_wait:
            self._record_wait(self.cycle, "IDLE", 1)
        self._go_to(self.cycle + cpu_costs.IDLE)
        while not self.core.idle_ends(self.cycle):
            self._rest_until(max(self.cycle, self.core.next_wake))
        if self._records_wait:
            self._record_wait(self.cycle, "IDLE", 0)
        self._serve()

    def _rest_until(self, cycle: int) -> None:
        """Sleep to `cycle`, or to the boundary at which an interrupt can be taken."""
        kernel = self._kernel
        cycle = min(cycle, max(self.cycle, self.core.earliest()))
        if cycle < NEVER:
            tick = self._clock.tick(cycle)
            if tick < kernel.quiet_until():
                kernel.now = max(kernel.now, tick)
                self.cycle = cycle
                return
            self._wake_at(cycle)
        self._interruptible = True
        self._sleep()
        self._interruptible = False
        self.cycle = max(self.cycle, min(cycle, self._clock.cycle_at(kernel.now)))

    # Interrupts --------------------------------------------------------------

    def request(self, cycle: int, number: int) -> None:
        """INTn was pulsed at `cycle`."""
        self.core.raise_line(cycle, number)
        if self._interruptible:
            due = self.core.next_wake if self.core.idlestat else self.core.earliest()
            if due < NEVER:
                self.resume_by(max(due, cycle))

    def resume_by(self, cycle: int) -> None:
        """Be resumed at `cycle`, or sooner if that is settled already."""
        if not self._wake or self._wake_tick > self._clock.tick(cycle):
            if self._wake:
                self._kernel.cancel(self._wake)
            self._wake_at(cycle)

    def _serve(self) -> None:
        """Take every interrupt that can be taken at this instruction boundary."""
        if self.core.owes_instruction:
            self.core.instruction_done()
        number = self.core.next_taken(self.cycle)
        while number:
            self._enter(number)
            number = self.core.next_taken(self.cycle)

    def _enter(self, number: int) -> None:
        spin, self.spin_now = self.spin_now, None
        if spin is not None:
            spin.pure = False
        began = self.cycle
        core = self.core
        core.enter(began, number)
        self._go_to(began + core.vector_delay)
        vector = self._fetch_vector(number)
        self._go_to(began + core.entry_cycles)
        handler = self.handlers.get(vector)
        if handler is None:
            raise FirmwareError(
                f"{self.name}: interrupt {vector} was taken at cycle {self.cycle}, but firmware gave it no handler; "
                f"it has {', '.join(self.handlers) or 'none'}. Give it one with dsp.handle({vector!r}, routine)."
            )
        outer = self._recorder.cause
        if self._records_irq:
            tick, where = self._clock.tick(self.cycle), self._places.of(handler) or ""
            self._recorder.cause = self._recorder.emit(tick, Kind.IRQ, self.name, vector, 1, where)
        self.compute(self._options.context_save)
        handler()
        core.iret(self.cycle)
        self._go_to(self.cycle + cpu_costs.IRET)
        if self._records_irq:
            self._recorder.emit(self._clock.tick(self.cycle), Kind.IRQ, self.name, vector, 0)
        self._recorder.cause = outer
        self.busy_cycles += self.cycle - began
        self.spin_now = spin
        self._take_notes()

    def _fetch_vector(self, number: int) -> str:
        """The name of the vector taken for INTn at this cycle."""
        if number > GROUPS:
            address = self._pie.cpu_vector(self.cycle, number)
        else:
            _, address = self._pie.vector(self.cycle, number)
        name = NAME_OF.get(address)
        if name is None:
            raise FirmwareError(
                f"{self.name}: INT{number} was taken at cycle {self.cycle} with PIECTRL.ENPIE = 0, so its vector "
                f"comes from boot ROM ({address:#x}), where no routine of this firmware is; "
                "set ENPIE before interrupts are enabled."
            )
        return name

    def _take_notes(self) -> None:
        for note in self.core.notes:
            self.note(note)
        self.core.notes.clear()

    def note(self, note: Note) -> None:
        """Tell something about the firmware; with `strict` it ends the run."""
        if self.strict and note.code == "duty":
            at = self._clock.timebase.show(self._kernel.now)
            raise FirmwareError(f"{self.name}, {at}: {note.text} [{note.source}]")
        self.notes[note] = self.notes.get(note, 0) + 1
        if self._recorder.wants(Kind.NOTE):
            tick = self._clock.tick(self.cycle)
            self._recorder.emit(tick, Kind.NOTE, self.name, note.code, self.notes[note], note.text)

    # Instructions about interrupts and protection -------------------------------

    def eint(self) -> None:
        self._core_instruction(self.core.clrc_intm, cpu_costs.CLRC_INTM)

    def dint(self) -> None:
        self._core_instruction(self.core.setc_intm, cpu_costs.SETC_INTM)

    def eallow(self) -> None:
        self.core.set_eallow(self.cycle, True)
        self.instruction(cpu_costs.EALLOW)

    def edis(self) -> None:
        self.core.set_eallow(self.cycle, False)
        self.instruction(cpu_costs.EDIS)

    def or_ier(self, mask: int) -> None:
        self.core.or_ier(self.cycle, mask)
        self.instruction(cpu_costs.OR_IER)

    def and_ier(self, mask: int) -> None:
        self.core.and_ier(self.cycle, mask)
        self.instruction(cpu_costs.AND_IER)

    def nop(self) -> None:
        self.instruction(cpu_costs.SIMPLE)

    def _core_instruction(self, begin: Callable[[int], None], cycles: int) -> None:
        begin(self.cycle)
        self._take_notes()
        self.instruction(cycles)

    # Accesses ----------------------------------------------------------------

    def read(self, place: Place, register: Register, looked_at: Field | None = None, half: int = 0) -> int:
        """The register's value as a CPU read sees it; costs one cycle and the frame's wait states."""
        spin = self.spin_now
        if spin is not None and spin.polls:
            self.instruction(cpu_costs.SB_NOT_TAKEN)  # the test of the value before, in the same pass
        if self.cycle < self._free_from and place.protected_block:
            self._wait_for_write(spin)
        at = self.cycle + self._waits.read[place.frame]
        if spin is not None and at < spin.live_from:
            value = spin.replay[spin.replayed].value
            spin.replayed += 1
            self.cycle = at
        else:
            if at < self._lease:
                self.cycle = at
            else:
                self._go_to(at)
            socket = place.socket
            if self._records_access and self._wanted(register):
                value = self._fetch_recorded(place, register, half)
            elif register.plain and socket.before is None:
                value = socket.chip.peek(at, register.offset)
            else:
                value = self._fetch(socket, register, half)
        if spin is not None:
            spin.polls.append(Poll(place, register, half, looked_at, at, value))
            if register.free_running or not register.reads_are_harmless:
                spin.pure = False
        self.instruction(1)
        return value

    def _wait_for_write(self, spin: Spin | None) -> None:
        """A read in the protected block waits until a write there has completed."""
        self._go_to(self._free_from)
        if spin is not None:
            spin.pure = False

    def _now(self) -> None:
        """The kernel's time is this CPU's: an access happens. It may promise new events, so the lease ends."""
        kernel = self._kernel
        tick = self._clock.tick(self.cycle)
        if tick > kernel.now:
            kernel.now = tick
        self._lease = 0

    def _fetch_recorded(self, place: Place, register: Register, half: int) -> int:
        outer = self._recorder.cause
        seen = self._peek(place.socket, register, half)  # recorded before the read, which causes what it sets off
        self._recorder.cause = self._record_access("R", place, register, seen)
        value = self._fetch(place.socket, register, half)
        self._recorder.cause = outer
        return value

    def _peek(self, socket: Socket, register: Register, half: int) -> int:
        offset = register.offset + half
        value = socket.peek(self.cycle, offset)
        if register.width == 32 and not half:
            value |= socket.peek(self.cycle, offset + 1) << 16
        return value

    def _fetch(self, socket: Socket, register: Register, half: int) -> int:
        if register.reads_are_harmless:
            return self._peek(socket, register, half)
        self._now()
        offset = register.offset + half
        value = socket.read(self.cycle, offset)
        return value | socket.read(self.cycle, offset + 1) << 16 if register.width == 32 and not half else value

    def write(self, place: Place, register: Register, value: int, half: int = 0) -> None:
        """Write a register; costs one cycle and the frame's wait states. Ignored where EALLOW protects it."""
        spin = self.spin_now
        if spin is not None:
            spin.pure = False
        at = self.cycle + self._waits.write[place.frame]
        if place.frame is Frame.PF1:
            if self._last_pf1_write == self.cycle - 1:
                at += self._waits.pf1_after_pf1
            self._last_pf1_write = at
        self._go_to(at)
        if register.protected and not self.core.eallow:
            text = f"{register.name} of {place.name} was written without EALLOW; the write is ignored"
            self.note(Note("duty", text, "SPRUFB0D section 7.2"))
        elif self._records_access and self._wanted(register):
            outer = self._recorder.cause
            self._recorder.cause = self._record_access("W", place, register, value)
            self._store(place, register, value, half)
            self._recorder.cause = outer
        else:
            self._store(place, register, value, half)
        if place.protected_block:
            self._free_from = at + 1 + WRITE_TO_READ
        if register is PIEACK:
            self.core.wrote_pieack(at)
        self.instruction(1)

    def load(self, address: int, width: int = 16) -> int:
        """What a 16- or 32-bit read of an address sees. NoSuchAddress where no register is."""
        place, register, half = self.memory.find(address)
        if width == 32 and self._too_wide(place, register):
            return 0
        return self.read(place, register, half=half) & (1 << width) - 1

    def store(self, address: int, value: int, width: int = 16) -> None:
        """A 16- or 32-bit write to an address. NoSuchAddress where no register is."""
        place, register, half = self.memory.find(address)
        if width == 32 and self._too_wide(place, register):
            return
        if width == 16 and register.width == 32 and not half:
            value |= self._peek(place.socket, register, 0) & 0xFFFF0000  # the other half stays
        self.write(place, register, value, half)

    def _too_wide(self, place: Place, register: Register) -> bool:
        """Frame 2 has 16-bit accesses only: a wider one is not performed, and noted."""
        if place.frame is not Frame.PF2:
            return False
        self.instruction(1 + self._waits.read[place.frame])
        text = f"{register.name} of {place.name} was accessed with 32 bits; peripheral frame 2 takes 16 only"
        self.note(Note("duty", text, "SPRUFB0D Table 88"))
        return True

    def _store(self, place: Place, register: Register, value: int, half: int) -> None:
        self._now()
        socket, offset = place.socket, register.offset + half
        socket.write(self.cycle, offset, value & 0xFFFF)
        if register.width == 32 and not half:
            socket.write(self.cycle, offset + 1, value >> 16 & 0xFFFF)
        self._kernel.settled()

    def modify(self, place: Place, register: Register, f: Field, number: int) -> None:
        """A bit-field write as the compiler makes it: read the whole register, then write it, two cycles apart."""
        if self.spin_now is not None:
            self.spin_now.pure = False
        if self.cycle < self._free_from and place.protected_block:
            self._wait_for_write(None)
        self._go_to(self.cycle + self._waits.read[place.frame])
        if self._records_access and self._wanted(register):
            value = self._fetch_recorded(place, register, 0)
        else:
            value = self._fetch(place.socket, register, 0)
        self._go_to(self.cycle + READ_TO_WRITE)
        self.write(place, register, f.put(value, number))

    def _wanted(self, register: Register) -> bool:
        """Whether somebody wants to hear of accesses to registers of this name."""
        return self._recorded is None or register.name in self._recorded

    def _record_access(self, way: str, place: Place, register: Register, value: int) -> int:
        where, tick = self._places.now(2), self._clock.tick(self.cycle)
        return self._recorder.emit(tick, Kind.ACCESS, self.name, f"{way} {place.name}.{register.name}", value, where)

    # Waiting -----------------------------------------------------------------

    def spin(self, condition: Callable[[], object]) -> None:
        """`while (!condition()) ;` as the compiler makes it: a pass is its reads and the branch back."""
        spin = Spin(self.cycle, "")
        outer, self.spin_now = self.spin_now, spin
        polled = ""
        while True:
            spin.polls = []
            spin.pure = True
            spin.start = self.cycle
            if condition():
                break
            if self._records_wait and not polled:
                polled = spin.waits_for() or "nothing"
                self._record_wait(spin.since, polled, 1)
            self.instruction(self._branch)
            if self._skip_polls and spin.pure and spin.polls:
                self._skip(spin)
        if polled:
            self._record_wait(self.cycle, polled, 0)
        self.instruction(cpu_costs.SB_NOT_TAKEN)
        self.spin_now = outer

    def _record_wait(self, cycle: int, what: str, begins: int) -> None:
        where = self._places.now(2) if begins else ""
        self._recorder.emit(self._clock.tick(cycle), Kind.WAIT, self.name, what, begins, where)

    def _skip(self, spin: Spin) -> None:
        """Sleep over the passes that must come out as this one did, and set up the replay of the one in progress."""
        if self.core.earliest() < NEVER:
            return
        lease = Lease(self, spin)
        if lease.broken(self.cycle):
            return
        first = self.cycle
        period = first - spin.start
        for socket in lease.sockets:
            socket.watch(lease.look)
        self._interruptible = True
        self._sleep()
        self._interruptible = False
        for socket in lease.sockets:
            socket.unwatch(lease.look)
        woken = max(first, self._clock.cycle_at(self._kernel.now))
        skipped = (woken - first) // period
        self.polls_skipped += skipped
        self.cycle = first + skipped * period
        spin.replay, spin.replayed, spin.live_from = spin.polls, 0, woken
        if self.core.ifr or self.core.next_wake <= self.cycle:  # the end of the branch back is a boundary, too
            self._serve()


def raised_at(error: Exception) -> str:
    """Where in the firmware an exception comes from, "line 7 of blink.py"; empty if the fault is our own."""
    place = ""
    ours = False
    step = error.__traceback__
    while step is not None:
        code = step.tb_frame.f_code
        ours = code.co_filename.startswith(PACKAGE) and not code.co_filename.endswith(FIRMWARE_VIEW)
        if not code.co_filename.startswith(PACKAGE):
            place = f"line {step.tb_lineno} of {Path(code.co_filename).name}"
        step = step.tb_next
    return "" if ours else place
