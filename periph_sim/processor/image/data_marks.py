"""Marks of data: the words of memory and the parts of registers that received data of the SCI can reach.

    SCIRXBUF --read--> AL, N, Z --instructions--> words of RAM --> I2CDXR     the times of the run follow from no data
                                             '--> branch, address, setting    `found`: data can decide what happens

The marks are those of one run. If `found` is None at its end, then a run with other data, and otherwise the same
inputs, executes the same instructions at the same cycles, and accesses the same addresses and registers. Only the
contents of marked words, and of registers that take words to send, can differ.

An instruction whose sources include a marked part or word marks all its results (`c28x.data_flow`). Otherwise, it
removes the marks of the results that it replaces.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, NamedTuple, final

from ...core.state import State
from ...f28335.i2c.register_map import MDR_DLB, MDR_MST
from ...f28335.memory.ram import END, Remainders
from ...form.c_types import UInt16
from ..c28x.data_flow import ANY_FLOAT, BITS, ST0, data_flow
from ..c28x.execution.cpu import Operation
from ..operand import Operand

# Registers that can contain data of a frame: received data, and data to send, which firmware can read back.
OF_DATA = frozenset(["SCIRXBUF", "SCIRXEMU", "SCITXBUF", "SPIRXBUF", "SPIRXEMU", "SPITXBUF", "SPIDAT", "I2CDXR"])
LINES = frozenset(["GPADAT", "GPBDAT", "GPCDAT"])  # registers that show the levels of lines with data
LOOPED = "I2CDRR"  # it has data of a frame only if the module receives what it sends, or a target answers with it
# Registers that decide how an SCI receives.
RECEPTION = frozenset(["SCICCR", "SCICTL1", "SCIHBAUD", "SCILBAUD", "SCIFFCT"])
OUTPUTS = ("SET", "CLEAR", "TOGGLE")  # ends of the names of the GPIO registers that only change the levels of outputs
CLOCKS = ("PCLKCR", "LPMCR")  # how the names of registers begin that stop clocks
MARKED = 0x1FF  # the mark of a word. A word with the saved ST0 has the marks of its fields instead.
FIELDS = 22  # the number of the lowest bit of ST0 in a mask of parts
# For each of the first 8 words of the context that an interrupt saves, the part that it contains; 0 for ST0.
SAVED = (0, *(BITS[name] for name in ("T", "AL", "AH", "PL", "PH", "AR0", "AR1")))
CONTEXT = 14  # number of words of this context
MOST_STORES = 8  # maximum number of words that an instruction writes

assert ST0 == MARKED << FIELDS


class DataUse(NamedTuple):
    """A place at which data decide what happens. address: that of the instruction. how: a phrase about it."""

    address: int
    how: str


@final
class DataMarks:
    """The marks of a run.

    registers: mask of the marked parts of registers (`data_flow.PARTS`).
    memory: for each word of RAM, 0 if it is not marked.
    found: the first use of data that decides what happens; None if there was none.
    """

    STATE = State(
        "registers memory found _late _due _has_frames _changes _kept_registers _kept_changes",
        results="_changes",
    )

    memory: Annotated[list[UInt16], END]
    _stores: Annotated[list[int], MOST_STORES]

    def __init__(self, marked: Sequence[int] = ()) -> None:
        """marked: the addresses of words of RAM that contain data from the start."""
        self.registers = 0
        self.memory = [0] * END
        for address in marked:
            self.memory[address] = MARKED
        self.found: DataUse | None = None
        self._late = 0  # marks of FPU registers whose old values the next instruction may still read
        self._due = 0  # marks of FPU registers that may be written only after the next instruction
        self._has_frames = False  # True if the first frame has begun
        self._changes = 0  # number of changes of `memory`
        self._kept_registers = self._kept_changes = 0  # the values at the last call of `is_as_before`
        # what the present instruction has done so far:
        self._has_read = False  # True if it has read a marked word
        self._stores = [0] * MOST_STORES
        self._stored = 0  # number of entries of `_stores`, the addresses to which it has written
        self._setting = ""  # the name of the register or memory to which it has written, and which must not be marked
        self._reason = ""  # a phrase about a value that it has written and with which data can decide what happens

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Return remainders in place of the marks of words. See `proof.normal_state`."""
        found = Remainders()
        address: int
        for address in range(END):
            if self.memory[address]:
                found.add(address, self.memory[address])
        return {"memory": found.both(), "_kept_registers": None, "_kept_changes": None}

    def is_as_before(self) -> bool:
        """Return True if the marks of registers are as at the last call, and no mark of a word has changed since."""
        same: bool = self.registers == self._kept_registers and self._changes == self._kept_changes
        self._kept_registers, self._kept_changes = self.registers, self._changes
        return same

    def both(self) -> tuple[int, int]:
        """Return the marks of registers, and the number of changes of marks of words."""
        return self.registers, self._changes

    def frame_begins(self) -> None:
        """Receive the beginning of a frame. From now on, the way in which lines are received must not change."""
        self._has_frames = True

    # Accesses of the present instruction -----------------------------------------------

    def loaded(self, address: int) -> None:
        """Note that the present instruction has read this word of RAM."""
        if self.memory[address]:
            self._has_read = True

    def stored(self, address: int) -> None:
        """Note that the present instruction has written this word of RAM."""
        self._stores[self._stored] = address
        self._stored += 1

    def loaded_register(self, operand: Operand) -> None:
        """Note that the present instruction has read this register of a module."""
        name = operand.register.name
        if name in OF_DATA or name in LINES:
            self._has_read = True

    def stored_elsewhere(self, operand: Operand | None, value: int) -> None:
        """Note that the present instruction has written a value to a register of a module.

        operand: the register; None for memory whose words have no marks.
        """
        if operand is None:
            self._setting = "memory outside of RAM"
        elif not operand.to_send:
            self._setting = operand.register.name
            module: str = operand.place.name
            if self._setting == "I2CMDR" and value & (MDR_DLB | MDR_MST):
                self._reason = "I2CMDR makes the module a master or its own receiver, and data sent can decide"
            elif self._has_frames and (
                self._setting in RECEPTION or module == "XINT" or routes_lines(module, self._setting)
            ):
                self._reason = f"{self._setting} is written while frames come, and data can decide what is received"

    def decoded(self, address: int) -> None:
        """Set `found` if a word that is decoded as an instruction is marked. address: that of the word."""
        if self.memory[address]:
            self._find(address, "data are executed as an instruction")

    # Instructions --------------------------------------------------------------------------

    def executed(self, f: Operation) -> None:
        """Update the marks after an instruction, or one pass of a repeated instruction."""
        if not f.has_flow:
            _set_flow(f)
        before = self.registers | self._late
        if before & f.pointers:
            self._find(f.address, "data decide the address of an access")
        if (self._has_read and f.memory_decides) or before & f.decides:
            self._find(f.address, "data decide a branch" if f.jumps else "data decide the effect of an instruction")
        due, self._late, self._due = self._due, 0, 0
        if self._has_read or before & f.sources:
            if self._setting:
                self._find(f.address, f"data are written to {self._setting}")
            self.registers |= f.replaces | f.changes
            if f.late:
                self._due = f.replaces & ANY_FLOAT
            self._mark_stores(MARKED)
        else:
            if f.late:
                self._late = self.registers & f.replaces & ANY_FLOAT
            self.registers &= ~f.replaces
            self._mark_stores(0)
        self.registers |= due
        if self._reason:
            self._find(f.address, self._reason)
        self._has_read, self._stored, self._setting, self._reason = False, 0, "", ""

    def _mark_stores(self, mark: int) -> None:
        at: int
        for at in range(self._stored):
            self._put(self._stores[at], mark)

    def _put(self, address: int, mark: int) -> None:
        if self.memory[address] != mark:
            self.memory[address] = mark
            self._changes += 1

    def _find(self, address: int, how: str) -> None:
        if self.found is None:
            self.found = DataUse(address, how)

    # Interrupts, and words that lose their contents --------------------------------------------

    def entered(self, frame: int) -> None:
        """Mark the words in which an interrupt has saved marked parts of registers. frame: the address of the first."""
        self._late = self._due = 0
        at: int
        for at in range(CONTEXT):
            mark: int = 0
            if at == 0:
                mark = self.registers >> FIELDS & MARKED
            elif at < len(SAVED) and self.registers & SAVED[at]:
                mark = MARKED
            self._put(frame + at, mark)

    def returned(self, frame: int, address: int) -> None:
        """Restore the marks of registers after IRET. address: that of IRET."""
        at: int
        for at in range(CONTEXT):
            mark = self.memory[frame + at]
            if at == 0:
                self.registers = self.registers & ~(MARKED << FIELDS) | mark << FIELDS
            elif at >= len(SAVED):
                if mark:
                    self._find(address, "data decide what IRET restores")
            elif mark:
                self.registers |= SAVED[at]
            else:
                self.registers &= ~SAVED[at]

    def forget(self, address: int) -> None:
        """Remove the mark of a word that is cleared."""
        self._put(address, 0)


def routes_lines(module: str, register: str) -> bool:
    """Return True if a write to a register can change which modules receive a line, or stop one of them."""
    return (module == "GPIO" and not register.endswith(OUTPUTS)) or register.startswith(CLOCKS)


def _set_flow(f: Operation) -> None:
    """Store the data flow of an operation in its attributes."""
    flow = data_flow(f.encoding, {letter: getattr(f, letter) for letter in f.encoding.fields})
    f.sources, f.replaces, f.changes = flow.sources, flow.replaces, flow.changes
    f.decides, f.pointers = flow.decides, flow.pointers
    f.memory_decides = flow.memory_decides
    f.has_flow = True
