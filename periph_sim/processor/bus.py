"""Bus of one CPU: register and memory accesses in a given cycle, with their values, records and effects.

    read    issued | wait for writes, wait states | fetched
    write   issued | wait states | posted . . | lands
    field   issued | wait for writes, wait states | fetched, posted . . | lands      while the CPU continues

A write leaves the pipeline in its last stage, W, two cycles after the stage in which a read has its value, R2. So it is
posted: it takes effect at the end of a later cycle, while the CPU continues. A read in the protected block, or of the
same register, waits for it; any other may overtake it, and one in the cycle of the landing does.

The bus serves no interrupt and advances no clock: it returns the cycle in which an access can be made. The program
advances to that cycle (`CpuTime.advance`, and `meet` for accesses with effects) before it makes the access.

Source: SPRS439M Table 3-5 (wait states); SPRU430E sections 4.1, 4.4.1, 4.5 (pipeline, write to read); SPRUFB0D
sections 7.2, 7.4.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from typing import final

from ..core.chip import NEVER, Note
from ..core.options import IntOption
from ..core.records import NOWHERE, Kind, Recorder
from ..core.registers import Field, Register
from ..core.state import State
from ..core.time import Clock
from ..f28335.cpu.interrupts import CpuInterrupts
from ..f28335.memory.memory_map import BOTH, HIGH, LOW, WRITE_TO_READ, AddressMap, ModuleRange, WaitStates
from ..f28335.memory.ram import Ram, block_at
from ..f28335.system_options import SystemOptions
from ..form.c_types import Text
from .cpu_time import CpuTime
from .firmware_notes import FirmwareNotes
from .operand import Operand
from .source_location import SourceLocation

REGISTERS_END = 0x8000  # no register lies above


@final
class Posted:  # core: freelist 4
    """A write that was issued and has not landed yet, as an element of the queue of such writes.

    where: the place of the instruction that issued it; None if the place is not used.
    cause: the record of this instruction.
    following: the write that lands next.
    """

    STATE = State("operand value where", cycles="lands", records="cause", made=True)

    lands: int
    operand: Operand
    value: int
    where: SourceLocation | None
    cause: int
    following: Posted | None


@final
class Bus:
    """The bus of one CPU, with the wait states of accesses and the posted writes.

    map: the modules by address.
    ram: memory without registers.
    free_from: the cycle from which a read in the protected block need not wait for a write.
    free_of: the same cycle for registers outside of the block, by address.
    issued_at: the statement that issued the write that lands now.
    """

    STATE = State("ram _posted_last issued_at", cycles="free_from free_of _last_pf1_write", chains="_posted")

    _pf2_read_ws: IntOption
    _pf2_write_ws: IntOption

    def __init__(
        self,
        name: str,
        time: CpuTime,
        clock: Clock,
        recorder: Recorder,
        memory: AddressMap,
        core: CpuInterrupts,
        notes: FirmwareNotes,
        options: SystemOptions,
        place: Callable[[], SourceLocation | None],
    ) -> None:
        """place: returns the statement that makes the access."""
        self.map = memory
        self.ram = Ram()
        self.free_from = 0
        self.free_of: dict[int, int] = {}
        self.issued_at: SourceLocation | None = None
        self._name = name
        self._time = time
        self._clock = clock
        self._recorder = recorder
        self._core = core
        self._notes = notes
        self._place = place
        self._records_access = recorder.wants(Kind.ACCESS)
        wanted = recorder.subjects(Kind.ACCESS)
        self._subjects: frozenset[str] | None = (
            None if wanted is None else frozenset(subject.rpartition(".")[2] for subject in wanted)
        )
        self._waits: WaitStates = WaitStates(options)
        self._pf1_back_to_back_write: IntOption = options.pf1_back_to_back_write
        self._pf2_read_ws, self._pf2_write_ws = options.pf2_read_ws, options.pf2_write_ws
        self._write_lands: IntOption = options.write_lands
        self._read_listed = self._write_listed = False  # an access in frame 2
        self._words: list[Operand | None] = []  # by address, made at the first access
        self._pairs: list[Operand | None] = []  # of 32 bits
        self._nothing: Operand = Operand.__new__(Operand)  # the entry of an address without a register
        self._named: dict[tuple[Operand, int], Operand] = {}  # by operand and bits read
        self._posted: Posted | None = None  # the first of a chain
        self._posted_last: Posted | None = None  # the last of the chain
        self._last_pf1_write = -NEVER

    # Operands ------------------------------------------------------------

    def operand(self, place: ModuleRange, register: Register, words: int, field: Field | None = None) -> Operand:
        """Return the operand of these words of a register of the map, or of a field in them."""
        names, subjects = (register.name, register.upper), self._subjects
        recorded = self._records_access and (subjects is None or any(name in subjects for name in names))
        operand = Operand(place, register, words, field, self._waits, recorded)
        if operand.recorded:
            kind, recorder = Kind.ACCESS, self._recorder  # an attribute of an enumeration costs as much as a call
            reads = recorder.topic(kind, self._name, f"R {operand.name}")
            operand.record(reads, recorder.topic(kind, self._name, f"W {operand.name}"))
        return operand

    def find(self, address: int, width: int) -> Operand | None:
        """Return the register at an address, 32 bits from an even one on; None if no register is there."""
        if not 0 <= address < REGISTERS_END:
            return None
        if not self._words:
            self._words, self._pairs = [None] * REGISTERS_END, [None] * REGISTERS_END
        found: Operand | None
        if width == 32:
            address &= ~1
            found = self._pairs[address]
        else:
            found = self._words[address]
        if found is None:  # the first access
            at, found = self.map.at(address), self._nothing
            if at is not None:
                place, register, half = at
                found = self.operand(place, register, BOTH if width == 32 else HIGH if half else LOW)
            table = self._pairs if width == 32 else self._words
            table[address] = found
        return None if found is self._nothing else found

    def at(self, address: int, width: int) -> Operand:
        """Return the register at an address as `find` does. Raise NoSuchAddress if no register is there."""
        found = self.find(address, width)
        if found is None:
            raise self.map.refusal(address & ~1 if width == 32 else address)
        return found

    def naming(self, operand: Operand, mask: int) -> Operand:
        """Return the same words with the field named that has these bits; the same operand if it is not one field.

        mask: bits of the word that is transferred, not shifted to its place in the register.
        """
        found = self._named.get((operand, mask))
        if found is None:
            fields = [f for f in operand.register.fields if f.mask & mask << operand.shift]
            found = operand
            if len(fields) == 1:
                found = self.operand(operand.place, operand.register, operand.words, fields[0])
            self._named[operand, mask] = found
        return found

    def named(self, address: int, words: int, field: Text) -> Operand:
        """Return the operand of these words of the register at an address, with a field of it named if one is given."""
        found = self.at(address + 1 if words == HIGH else address, 32 if words == BOTH else 16)
        return self.naming(found, found.register[field].mask >> found.shift) if field else found

    @property
    def lands_after(self) -> int:
        """Cycles from a write to its effect."""
        return self._write_lands.unrecorded()

    # By address ----------------------------------------------------------------

    def reads_at(self, cycle: int, address: int, width: int = 16) -> int:
        """Return the cycle in which a read issued in `cycle` has its value. Raise NoSuchAddress if nothing is there."""
        block = block_at(address)
        if block is not None:
            return cycle + block.read_waits
        return self.fetches_at(cycle, self.at(address, width))

    def writes_at(self, cycle: int, address: int, width: int = 16) -> int:
        """Return the cycle in which a write issued in `cycle` is posted. Raise NoSuchAddress if nothing is there."""
        block = block_at(address)
        return cycle + block.write_waits if block is not None else self.posts_at(cycle, self.at(address, width))

    def read(self, at: int, address: int, width: int = 16) -> int:
        """Return the value of a 16- or 32-bit read of an address in cycle `at`."""
        if block_at(address) is not None:
            return self.ram.word32(address) if width == 32 else self.ram.word(address)
        return self.load(at, self.at(address, width), width)

    def load(self, at: int, operand: Operand, width: int) -> int:
        """Return the value of a read of a register in cycle `at`, which is 0 for 32 bits in frame 2."""
        if width == 32 and operand.frame2:
            self.note_width(at, operand)
            return 0
        return self.fetch(at, operand) >> operand.shift

    def write(self, at: int, address: int, value: int, width: int = 16) -> None:
        """Write 16 or 32 bits to an address: to memory at once, to a register by a posted write."""
        block = block_at(address)
        if block is None:
            self.save(at, self.at(address, width), value, width)
        elif block.protected and not self._core.eallow:
            self._ignored(at, f"{address:#06x} of {block.name}")
        elif width == 32:
            self.ram.put_word32(address, value)
        else:
            self.ram.put(address, value)

    def save(self, at: int, operand: Operand, value: int, width: int) -> None:
        """Post a write to a register in cycle `at`; 32 bits in frame 2 are ignored."""
        if width == 32 and operand.frame2:
            self.note_width(at, operand)
        else:
            self.store(at, operand, value << operand.shift)

    def note_width(self, cycle: int, operand: Operand) -> None:
        """Note a 32-bit access to frame 2, which has 16-bit accesses only and does not perform it."""
        what = f"{operand.register.name} of {operand.place.name}"
        text = f"{what} was accessed with 32 bits; peripheral frame 2 takes 16 only"
        self._notes.note(cycle, Note("duty", text, "SPRUFB0D Table 88"))

    # Reads -----------------------------------------------------------------------

    def read_waits(self, operand: Operand) -> int:
        """Return the wait states of a read that is made now."""
        if operand.frame2 and not self._read_listed:
            self._read_listed = True  # the CPU's list keeps its entries
            self._pf2_read_ws.assume(self._core.touched)
        return operand.read_waits

    def free(self, operand: Operand) -> int:
        """Return the cycle from which write-to-read protection of the block or the register delays no read."""
        return self.free_from if operand.block else self.free_of.get(operand.address, 0)

    def fetches_at(self, cycle: int, operand: Operand) -> int:
        """Return the cycle in which a read of a register that is issued in `cycle` has its value."""
        return max(cycle, self.free(operand)) + self.read_waits(operand)

    def fetch(self, at: int, operand: Operand) -> int:
        """Return the value of these words of the register in cycle `at`, each in its place."""
        if not operand.recorded:
            return operand.see(at) if operand.harmless else self._read(at, operand)
        return self._recorded(at, operand, self._place() if operand.records_place() else None)

    def record_poll(self, at: int, operand: Operand, value: int, where: SourceLocation | None) -> None:
        """Record a read that was a look at the chip and returned this value. where: see `_recorded`."""
        operand.reads.emit(self._clock.tick(at), value, where or "", operand.named)

    def _recorded(self, at: int, operand: Operand, where: SourceLocation | None) -> int:
        """Return the value of a read that is recorded, before its effects. where: its statement; None if unused."""
        recorder = self._recorder
        outer = recorder.cause
        seen = operand.see(at)
        recorder.cause = operand.reads.emit(self._clock.tick(at), seen, where or "", operand.named)
        value = seen if operand.harmless else self._read(at, operand)
        recorder.cause = outer
        return value

    def _read(self, at: int, operand: Operand) -> int:
        self._require_met(at)
        socket, words = operand.socket, operand.words
        value = socket.read(at, operand.offset) if words & LOW else 0
        return value | socket.read(at, operand.offset + 1) << 16 if words & HIGH else value

    # Writes ----------------------------------------------------------------------

    def posts_at(self, cycle: int, operand: Operand) -> int:
        """Return the cycle in which a write issued in `cycle` is posted."""
        if operand.frame2 and not self._write_listed:
            self._write_listed = True
            self._pf2_write_ws.assume(self._core.touched)
        if operand.frame1 and self._last_pf1_write == cycle - 1:
            return cycle + operand.write_waits + self._pf1_back_to_back_write.assume(self._core.touched)
        return cycle + operand.write_waits

    def store(self, at: int, operand: Operand, value: int) -> None:
        """Post these words of a register, each in its place in `value`, in cycle `at`.

        The write is ignored if EALLOW protects the register.
        """
        self._post(at, operand, value, self._place() if self._wants_place(operand) else None)
        if operand.pieack:
            self._core.wrote_pieack(at)

    def modify(self, at: int, operand: Operand, number: int) -> None:
        """Write a bit field by one instruction that reads and writes the word with the field, as the compiler does.

        It costs as much as a read; the write lands while the CPU continues.
        """
        where = self._place() if self._wants_place(operand) else None
        value = self._recorded(at, operand, where) if operand.recorded else self.fetch(at, operand)
        self._post(at, operand, value & ~operand.mask | number << operand.lsb & operand.mask, where)

    def _wants_place(self, operand: Operand) -> bool:
        """Return True if the statement of a write, or of the read for a modify, is needed."""
        return self._notes.placed or (operand.recorded and operand.reads.places + operand.writes.places > NOWHERE)

    def _post(self, at: int, operand: Operand, value: int, where: SourceLocation | None) -> None:
        lands = at + self._write_lands.assume(self._core.touched)
        if operand.frame1:
            self._last_pf1_write = at
        if operand.protected and not self._core.eallow:
            self._ignored(at, f"{operand.register.name} of {operand.place.name}")
        else:
            posted: Posted = Posted.__new__(Posted)
            posted.lands, posted.operand, posted.value, posted.where = lands, operand, value, where
            posted.cause = self._recorder.cause
            posted.following = None
            if self._posted is None or self._posted_last is None:
                self._posted = posted
            else:
                self._posted_last.following = posted
            self._posted_last = posted
            self._time.limit(lands)
        free = max(at + 1 + WRITE_TO_READ, lands + 1)
        if operand.block:
            self.free_from = free
        else:
            self.free_of[operand.address] = free

    def _ignored(self, cycle: int, what: str) -> None:
        text = f"{what} was written without EALLOW; the write is ignored"
        self._notes.note(cycle, Note("duty", text, "SPRUFB0D section 7.2"))

    def land(self) -> None:
        """Let the first posted write take effect in its cycle."""
        first = self._posted
        assert first is not None
        self._posted = after = first.following
        self._time.lands = NEVER if after is None else after.lands
        at, operand, value = first.lands, first.operand, first.value
        recorder, socket = self._recorder, operand.socket
        outer, recorder.cause = recorder.cause, first.cause
        if operand.recorded:
            recorder.cause = operand.writes.emit(self._clock.tick(at), value, first.where or "", operand.named)
        self.issued_at = first.where
        self._require_met(at)
        if operand.words & LOW:
            socket.write(at, operand.offset, value & 0xFFFF)
        if operand.words & HIGH:
            socket.write(at, operand.offset + 1, value >> 16 & 0xFFFF)
        self.issued_at = None
        recorder.cause = outer

    def forget(self) -> None:
        """Drop all posted writes, since the program has ended."""
        self._posted = None

    # Both ------------------------------------------------------------------------

    def _require_met(self, at: int) -> None:
        """Raise RuntimeError if the kernel's time is not that of an access with effects."""
        if self._time.met != at:
            raise RuntimeError(f"{self._name}: an access in cycle {at} has effects; call CpuTime.meet before it")
