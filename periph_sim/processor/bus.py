"""Bus of one CPU: register and memory accesses in a given cycle, with their values, records and effects.

    read    issued | wait for writes, wait states | fetched
    write   issued | wait states | posted . . | lands
    modify  issued | wait for writes, wait states | fetched, posted . . | lands      read, then write of a bit field

A read has its value in phase R2 of the pipeline. A write leaves the pipeline in the last phase, W, two cycles after
R2. So a write is posted: it takes effect (lands) at the end of a later cycle, while the CPU continues. A read in the
protected block, 0x4000 to 0x7FFF, waits until all writes in this block have landed. A read outside of the block waits
only for writes of the same register. A read that does not wait is not affected by a write that has not landed.

The bus serves no interrupt and advances no clock: it returns the cycle in which an access can be made. The program
advances to that cycle (`CpuTime.advance`, and `meet` for accesses with effects) before it makes the access.

Source: SPRS439M Table 3-5 (wait states); SPRU430E 4.1, 4.4.1, 4.5 (pipeline, write to read); SPRUFB0D 7.2, 7.4.
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

REGISTERS_END = 0x8000  # all registers are below this address


@final
class Posted:  # core: freelist 4
    """A write that was issued and has not landed yet, as an element of the queue of posted writes.

    lands: the cycle at whose end the write takes effect.
    value: the words to write: the low word of the register in bits 0 to 15, the high word in bits 16 to 31.
    where: the statement that issued the write; None if nothing needs the statement.
    cause: the record that caused the write.
    following: the posted write that lands after this one; None for the last.
    """

    STATE = State("operand value where", cycles="lands", records="cause", made=True, expires="lands")

    lands: int
    operand: Operand
    value: int
    where: SourceLocation | None
    cause: int
    following: Posted | None


@final
class Bus:
    """The bus of one CPU, with the wait states of accesses and the posted writes.

    map: the address map, which finds the module and the register at an address.
    ram: the memory of the chip.
    free_from: from this cycle on, a read in the protected block does not wait for a write.
    free_of: the same for each register outside of the protected block, by its address.
    issued_at: the statement that issued the posted write that lands now; None if it is unknown, or if no write lands.
    """

    STATE = State(
        "ram _posted_last issued_at",
        cycles="free_from free_of _last_pf1_write",
        chains="_posted",
        expires="free_from free_of _last_pf1_write",
    )

    _pf2_read_ws: IntOption
    _pf2_write_ws: IntOption

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Replace `_posted_last` by True if no write is posted, else by False. See `proof.normal_state`."""
        return {"_posted_last": self._posted is None}

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
        """place: returns the statement that the program executes now."""
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
        # True once the run depends on the option for the wait states of reads (of writes) in peripheral frame 2.
        self._read_listed = self._write_listed = False
        self._words: list[Operand | None] = []  # the 16-bit operand at each address, made at its first access
        self._pairs: list[Operand | None] = []  # the 32-bit operand at each even address
        self._nothing: Operand = Operand.__new__(Operand)  # marks addresses without a register in `_words` and `_pairs`
        self._named: dict[tuple[Operand, int], Operand] = {}  # results of `naming`, by operand and mask
        self._posted: Posted | None = None  # the posted write that lands first; None if there is none
        self._posted_last: Posted | None = None  # the posted write that lands last
        self._last_pf1_write = -NEVER

    # Operands ------------------------------------------------------------

    def operand(self, place: ModuleRange, register: Register, words: int, field: Field | None = None) -> Operand:
        """Make the operand of some words of a register, or of a field.

        place: the module with the register. words: LOW, HIGH or BOTH. field: None for whole words.
        """
        names, subjects = (register.name, register.upper), self._subjects
        recorded = self._records_access and (subjects is None or any(name in subjects for name in names))
        operand = Operand(place, register, words, field, self._waits, recorded)
        if operand.recorded:
            # The variable `kind` saves time: reading a member of an enumeration is slow.
            kind, recorder = Kind.ACCESS, self._recorder
            reads = recorder.topic(kind, self._name, f"R {operand.name}")
            operand.record(reads, recorder.topic(kind, self._name, f"W {operand.name}"))
        return operand

    def find(self, address: int, width: int) -> Operand | None:
        """Return the operand of the register at an address; None if no register is there.

        width: 16 or 32. A 32-bit operand begins at the last even address up to `address`.
        """
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
        if found is None:  # this is the first access to the address
            at, found = self.map.at(address), self._nothing
            if at is not None:
                place, register, half = at
                found = self.operand(place, register, BOTH if width == 32 else HIGH if half else LOW)
            table = self._pairs if width == 32 else self._words
            table[address] = found
        return None if found is self._nothing else found

    def at(self, address: int, width: int) -> Operand:
        """Return the operand that `find` returns. Raise NoSuchAddress if no register is there."""
        found = self.find(address, width)
        if found is None:
            raise self.map.refusal(address & ~1 if width == 32 else address)
        return found

    def naming(self, operand: Operand, mask: int) -> Operand:
        """Return an operand whose records name the only field with bits of `mask`. It has the words of `operand`.

        If `mask` has bits of no field or of several fields, return `operand` itself. mask: bits of the transferred
        word; bit 0 is the lowest bit of that word, also for the upper word of a register.
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
        """Return the operand of the register at an address.

        words: LOW, HIGH or BOTH. field: the name of the field in these words; "" for whole words.
        """
        found = self.at(address + 1 if words == HIGH else address, 32 if words == BOTH else 16)
        return self.naming(found, found.register[field].mask >> found.shift) if field else found

    @property
    def lands_after(self) -> int:
        """Number of cycles from the cycle in which a write is posted to the cycle in which it lands."""
        return self._write_lands.unrecorded()

    # By address ----------------------------------------------------------------

    def reads_at(self, cycle: int, address: int, width: int = 16) -> int:
        """Return the cycle in which a read issued in `cycle` has its value. Raise NoSuchAddress if nothing is there."""
        block = block_at(address)
        if block is not None:
            return cycle + block.read_waits
        return self.fetches_at(cycle, self.at(address, width))

    def writes_at(self, cycle: int, address: int, width: int = 16) -> int:
        """Return the cycle in which a write is posted (see `posts_at`). Raise NoSuchAddress if nothing is there."""
        block = block_at(address)
        return cycle + block.write_waits if block is not None else self.posts_at(cycle, self.at(address, width))

    def read(self, at: int, address: int, width: int = 16) -> int:
        """Return the value of a 16- or 32-bit read of an address in cycle `at`."""
        if block_at(address) is not None:
            return self.ram.word32(address) if width == 32 else self.ram.word(address)
        return self.load(at, self.at(address, width), width)

    def load(self, at: int, operand: Operand, width: int) -> int:
        """Return the value of a read of a register in cycle `at`. A 32-bit read in frame 2 returns 0."""
        if width == 32 and operand.frame2:
            self.note_width(at, operand)
            return 0
        return self.fetch(at, operand) >> operand.shift

    def write(self, at: int, address: int, value: int, width: int = 16) -> None:
        """Write 16 or 32 bits to an address: to memory at once, to a register by a posted write.

        A write to protected memory without EALLOW is ignored.
        """
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
        """Post a write to a register in cycle `at`. A 32-bit write in frame 2 is ignored."""
        if width == 32 and operand.frame2:
            self.note_width(at, operand)
        else:
            self.store(at, operand, value << operand.shift)

    def note_width(self, cycle: int, operand: Operand) -> None:
        """Make a note of a 32-bit access to frame 2, which performs 16-bit accesses only."""
        what = f"{operand.register.name} of {operand.place.name}"
        text = f"{what} was accessed with 32 bits; peripheral frame 2 takes 16 only"
        self._notes.note(cycle, Note("duty", text, "SPRUFB0D Table 88"))

    # Reads -----------------------------------------------------------------------

    def read_waits(self, operand: Operand) -> int:
        """Return the wait states of a read of this operand."""
        if operand.frame2 and not self._read_listed:
            self._read_listed = True
            self._pf2_read_ws.assume(self._core.touched)
        return operand.read_waits

    def free(self, operand: Operand) -> int:
        """Return the cycle from which on a read of this operand does not wait for an earlier write."""
        return self.free_from if operand.block else self.free_of.get(operand.address, 0)

    def fetches_at(self, cycle: int, operand: Operand) -> int:
        """Return the cycle in which the value of a register is read, if the read is issued in `cycle`."""
        return max(cycle, self.free(operand)) + self.read_waits(operand)

    def fetch(self, at: int, operand: Operand) -> int:
        """Read an operand in cycle `at`. The high word of a register is in bits 16 to 31, also if it is read alone."""
        if not operand.recorded:
            return operand.see(at) if operand.harmless else self._read(at, operand)
        return self._recorded(at, operand, self._place() if operand.records_place() else None)

    def record_poll(self, at: int, operand: Operand, value: int, where: SourceLocation | None) -> None:
        """Record a read that the caller has made by `Operand.see`. value: the value that `see` returned.

        where: the statement with the read; None if the records do not contain statements.
        """
        operand.reads.emit(self._clock.tick(at), value, where or "", operand.named)

    def _recorded(self, at: int, operand: Operand, where: SourceLocation | None) -> int:
        """Record a read of an operand, then make the read and return the value. where: see `record_poll`."""
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
        """Return the cycle in which a write is posted: `cycle`, in which the write is issued, plus its wait states."""
        if operand.frame2 and not self._write_listed:
            self._write_listed = True
            self._pf2_write_ws.assume(self._core.touched)
        if operand.frame1 and self._last_pf1_write == cycle - 1:
            return cycle + operand.write_waits + self._pf1_back_to_back_write.assume(self._core.touched)
        return cycle + operand.write_waits

    def store(self, at: int, operand: Operand, value: int) -> None:
        """Post a write in cycle `at`. It is ignored if the register is protected and EALLOW = 0. value: see `fetch`."""
        self._post(at, operand, value, self._place() if self._wants_place(operand) else None)

    def modify(self, at: int, operand: Operand, number: int) -> None:
        """Write `number` to a bit field by one instruction that reads and writes the word with the field.

        TI's compiler emits such an instruction for a bit field. It takes the cycles of a read, and its write is posted.
        """
        where = self._place() if self._wants_place(operand) else None
        value = self._recorded(at, operand, where) if operand.recorded else self.fetch(at, operand)
        self._post(at, operand, value & ~operand.mask | number << operand.lsb & operand.mask, where)

    def _wants_place(self, operand: Operand) -> bool:
        """Return True if a subscriber, or a note on a lost word, needs the statement that makes a write or a modify."""
        if self._notes.placed or operand.to_send:
            return True
        return operand.recorded and operand.reads.places + operand.writes.places > NOWHERE

    def _post(self, at: int, operand: Operand, value: int, where: SourceLocation | None) -> None:
        lands = at + self._write_lands.assume(self._core.touched)
        if operand.pieack:
            self._core.wrote_pieack(at)
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
        """Let the first posted write take effect. The time must be the cycle in which it lands."""
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
        """Drop all posted writes. Call this method when the program has ended."""
        self._posted = None

    # Both ------------------------------------------------------------------------

    def _require_met(self, at: int) -> None:
        """Raise RuntimeError if the program has not called `CpuTime.meet` in cycle `at`, before this access."""
        if self._time.met != at:
            raise RuntimeError(f"{self._name}: an access in cycle {at} has effects; call CpuTime.meet before it")
