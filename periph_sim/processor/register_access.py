"""Register accesses of one CPU: a register goes in; the cycles it costs, what is read, and writes that land come out.

    read    instruction, wait states, value
    write   instruction | . . posted . . | lands
    field   instruction, wait states, value | . . posted . . | lands        while the CPU goes on

A write leaves the pipeline in its last stage, W, two cycles after the stage in which a read has its value, R2. So it is
posted: it takes effect at the end of a later cycle, while the CPU goes on. A read in the protected block, or of the
same register, waits for it; any other may overtake it, and one in the cycle of the landing does.

Source: SPRS439M Table 3-5 (wait states); SPRU430E sections 4.1, 4.4.1, 4.5 (pipeline, write to read); SPRUFB0D
sections 7.2, 7.4.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from ..core.chip import NEVER, Note
from ..core.kernel import Kernel
from ..core.records import Kind, Recorder
from ..core.registers import Field, Register
from ..core.socket import Socket
from ..core.time import Clock
from ..f28335.cpu import instruction_costs as cpu_costs
from ..f28335.cpu.compiled_code_costs import CodeCosts
from ..f28335.cpu.interrupts import CpuInterrupts
from ..f28335.cpu.pie import Pie
from ..f28335.cpu.pie_map import PIEACK
from ..f28335.system.memory_map import BOTH, HIGH, LOW, WRITE_TO_READ, AddressMap, Frame, ModuleRange, WaitStates
from ..f28335.system.options import SystemOptions
from .interruptible_cpu import InterruptibleCpu
from .polling import Poll, Spin
from .source_location import SourceLocation


class Posted(NamedTuple):
    """A write on its way. named, where, cause: of the instruction that issued it."""

    lands: int
    place: ModuleRange
    register: Register
    value: int
    words: int
    named: Field | None
    where: SourceLocation | None  # None where nobody wants to know
    cause: int


class RegisterAccess(InterruptibleCpu):
    """memory: the modules by address."""

    __slots__ = (
        "_between",
        "_free_from",
        "_free_of",
        "_last_pf1_write",
        "_posted",
        "_recorded",
        "_records_access",
        "_waits",
        "_write_lands",
        "memory",
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
        code: CodeCosts,
        strict: bool,
    ) -> None:
        super().__init__(kernel, clock, recorder, name, core, pie, code, strict)
        self.memory = memory
        self._records_access = recorder.wants(Kind.ACCESS)
        wanted = recorder.subjects(Kind.ACCESS)
        self._recorded = None if wanted is None else frozenset(subject.rpartition(".")[2] for subject in wanted)
        self._waits = WaitStates(options)
        self._write_lands = options.write_lands
        self._between = code.between_accesses
        self._posted: deque[Posted] = deque()
        self._free_from = 0  # from this cycle on a read in the protected block need not wait for a write
        self._free_of: dict[int, int] = {}  # the same of a register outside of the block, by its address
        self._last_pf1_write = -NEVER

    def kill(self, how: type[BaseException]) -> None:
        self._posted.clear()
        super().kill(how)

    # Reads -------------------------------------------------------------------

    def read(self, place: ModuleRange, register: Register, words: int = LOW, looked_at: Field | None = None) -> int:
        """The value of these words of the register, each in its place; costs one cycle and the frame's wait states."""
        spin = self.spin_now
        if spin is None:
            self._run(self._between)
        elif spin.polls:
            self.instruction(cpu_costs.SB_NOT_TAKEN)  # the test of the value before, in the same pass
        self._wait_for_writes(place, register, spin)
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
                value = self._fetch_recorded(place, register, words, looked_at)
            elif register.plain and words == LOW and socket.before is None:
                value = socket.chip.peek(at, register.offset)
            else:
                value = self._fetch(socket, register, words)
        if spin is not None:
            spin.polls.append(Poll(place, register, words, looked_at, at, value))
            if register.free_running or not register.reads_are_harmless:
                spin.pure = False
        self.instruction(1)
        return value

    def load(self, address: int, width: int = 16) -> int:
        """What a 16- or 32-bit read of an address sees. NoSuchAddress where no register is."""
        place, register, words = self._at(address, width)
        if width == 32 and self._too_wide(place, register):
            return 0
        value = self.read(place, register, words)
        return value >> 16 if words == HIGH else value

    def _wait_for_writes(self, place: ModuleRange, register: Register, spin: Spin | None) -> None:
        """Write-to-read protection: a read waits until earlier writes to the block, or to its register, are done."""
        free = self._free_from if place.protected_block else self._free_of.get(place.base + register.offset, 0)
        if self.cycle < free:
            if spin is not None:
                spin.hold_up(free - self.cycle)
            self._go_to(free)

    def _fetch_recorded(self, place: ModuleRange, register: Register, words: int, named: Field | None) -> int:
        outer = self._recorder.cause
        seen = self._peek(place.socket, register, words)  # recorded before the read, which causes what it sets off
        self._recorder.cause = self._record("R", place, register, seen, named, self._places.now(2))
        value = self._fetch(place.socket, register, words)
        self._recorder.cause = outer
        return value

    def _peek(self, socket: Socket, register: Register, words: int) -> int:
        value = socket.peek(self.cycle, register.offset) if words & LOW else 0
        return value | socket.peek(self.cycle, register.offset + 1) << 16 if words & HIGH else value

    def _fetch(self, socket: Socket, register: Register, words: int) -> int:
        neighbour = words == BOTH and register.width == 16 and not register.upper  # read as half of a 32-bit word
        if register.reads_are_harmless and not neighbour:
            return self._peek(socket, register, words)
        self._now()
        value = socket.read(self.cycle, register.offset) if words & LOW else 0
        return value | socket.read(self.cycle, register.offset + 1) << 16 if words & HIGH else value

    # Writes ------------------------------------------------------------------

    def write(self, place: ModuleRange, register: Register, value: int, words: int = LOW) -> None:
        """Write these words of a register, each in its place in `value`; costs one cycle and the frame's wait states.

        Ignored where EALLOW protects the register.
        """
        self._before_write()
        at = self.cycle + self._waits.write[place.frame]
        if place.frame is Frame.PF1 and self._last_pf1_write == self.cycle - 1:
            at += self._waits.pf1_after_pf1
        self._go_to(at)
        self._post(place, register, value, words, None)
        if register is PIEACK:
            self.core.wrote_pieack(at)
        self.instruction(1)

    def modify(self, place: ModuleRange, register: Register, f: Field, number: int, words: int = LOW) -> None:
        """A bit-field write as the compiler makes it: one instruction that reads the word with the field and writes it.

        It costs what a read costs; the write lands while the CPU goes on.
        """
        self._before_write()
        self._wait_for_writes(place, register, self.spin_now)
        self._go_to(self.cycle + self._waits.read[place.frame])
        if self._records_access and self._wanted(register):
            value = self._fetch_recorded(place, register, words, f)
        else:
            value = self._fetch(place.socket, register, words)
        self._post(place, register, f.put(value, number), words, f)
        self.instruction(1)

    def store(self, address: int, value: int, width: int = 16) -> None:
        """A 16- or 32-bit write to an address. NoSuchAddress where no register is."""
        place, register, words = self._at(address, width)
        if width == 32 and self._too_wide(place, register):
            return
        self.write(place, register, value << 16 if words == HIGH else value, words)

    def _before_write(self) -> None:
        """The code between two accesses; a pass of a wait has its own, and with a write in it cannot be skipped."""
        if self.spin_now is None:
            self._run(self._between)
        else:
            self.spin_now.pure = False

    def _post(self, place: ModuleRange, register: Register, value: int, words: int, named: Field | None) -> None:
        """Send a write on its way, issued in this cycle."""
        at = self.cycle
        lands = at + self._write_lands
        if place.frame is Frame.PF1:
            self._last_pf1_write = at
        if register.protected and not self.core.eallow:
            text = f"{register.name} of {place.name} was written without EALLOW; the write is ignored"
            self.note(Note("duty", text, "SPRUFB0D section 7.2"))
        else:
            recorded = self._records_access and self._wanted(register)
            where = self._places.now(2) if recorded or self.strict else None
            self._posted.append(Posted(lands, place, register, value, words, named, where, self._recorder.cause))
            if lands < self._lands:
                self._lands = lands
            if lands < self._lease:
                self._lease = lands + 1
        free = max(at + 1 + WRITE_TO_READ, lands + 1)
        if place.protected_block:
            self._free_from = free
        else:
            self._free_of[place.base + register.offset] = free

    def _land(self) -> None:
        posted = self._posted.popleft()
        self._lands = self._posted[0].lands if self._posted else NEVER
        _, place, register, value, words, named, where, cause = posted
        recorder, socket = self._recorder, place.socket
        outer, recorder.cause = recorder.cause, cause
        if where is not None and self._records_access and self._wanted(register):
            recorder.cause = self._record("W", place, register, value, named, where)
        self._issued_at = where
        self._now()
        if words & LOW:
            socket.write(self.cycle, register.offset, value & 0xFFFF)
        if words & HIGH:
            socket.write(self.cycle, register.offset + 1, value >> 16 & 0xFFFF)
        self._issued_at = None
        recorder.cause = outer

    # Both --------------------------------------------------------------------

    def _at(self, address: int, width: int) -> tuple[ModuleRange, Register, int]:
        """The register at an address, and which words of it an access there moves: 32 bits begin at an even one."""
        if width == 32:
            place, register, _ = self.memory.find(address & ~1)
            return place, register, BOTH
        place, register, half = self.memory.find(address)
        return place, register, HIGH if half else LOW

    def _too_wide(self, place: ModuleRange, register: Register) -> bool:
        """Frame 2 has 16-bit accesses only: a wider one is not performed, and noted."""
        if place.frame is not Frame.PF2:
            return False
        self.instruction(1 + self._waits.read[place.frame])
        text = f"{register.name} of {place.name} was accessed with 32 bits; peripheral frame 2 takes 16 only"
        self.note(Note("duty", text, "SPRUFB0D Table 88"))
        return True

    def _wanted(self, register: Register) -> bool:
        """True if any subscriber records accesses to this register."""
        return self._recorded is None or register.name in self._recorded or register.upper in self._recorded

    def _record(
        self, way: str, place: ModuleRange, register: Register, value: int, named: Field | None, where: str
    ) -> int:
        what, field = f"{way} {place.name}.{register.name}", "" if named is None else named.name
        return self._recorder.emit(self._clock.tick(self.cycle), Kind.ACCESS, self.name, what, value, where, field)
