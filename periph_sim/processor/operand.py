"""Operand of a register access: the words that are transferred, and the properties of these words for the bus.

An operand is made once, and is used again for all later accesses to the same words.
"""

# core: compiled

from __future__ import annotations

from typing import final

from ..core.chip import Chip
from ..core.records import NOWHERE, OF_MODIFIES, Topic
from ..core.registers import Field, Register, Yields
from ..core.socket import Socket
from ..f28335.descriptor import Frame
from ..f28335.memory.memory_map import BOTH, HIGH, LOW, PROTECTED_BLOCK, WORDS_MASK, ModuleRange, WaitStates
from ..f28335.pie.register_map import PIEACK

TO_SEND = frozenset({"I2CDXR", "SCITXBUF", "SPIDAT", "SPITXBUF"})  # registers that take words to send


@final
class Operand:
    """The words or the field of a register that an access transfers.

    place: the module with the register.
    words: LOW, HIGH or BOTH words of the register.
    field: the field that the program has named; None for whole words.
    named: the name of the field in records; "" for whole words.
    mask: the bits of the register that the program reads or writes.
    lsb: the lowest bit of the field; 0 for whole words.
    shift: 16 if only the upper word is transferred, otherwise 0.
    offset, address: the offset of the register in its module, and its address on the chip.
    block: True if the register is in the protected block, where a read waits for earlier writes.
    frame1, frame2: True if the register is in peripheral frame 1, or 2.
    protected: True if only firmware with EALLOW = 1 can write the register.
    pieack: True if the register is PIEACK.
    to_send: True if the register takes words to send, so that a written word can be lost.
    recorded: True if accesses are recorded.
    harmless: True if a read has no effect. False also for a 32-bit access to 16-bit registers.
    steady: True if a read of the register has no effect and its value does not change with time.
    meets: True if `harmless` is False, or the module must be updated before a read. Before such a read, the kernel's
        time must be set to its cycle (`CpuTime.meet`).
    looks: True if the value of `Chip.see` is all that a read needs: the register has 16 bits, a read has no effect, the
        module needs no update, and no callback receives the record of the read.
    reads, writes: the topics of the records of reads and writes; set only if `recorded`.
    placed: True if records of reads contain the firmware's statement.
    """

    reads: Topic
    writes: Topic

    def __init__(
        self,
        place: ModuleRange,
        register: Register,
        words: int,
        field: Field | None,
        waits: WaitStates,
        recorded: bool,
    ) -> None:
        # True for a 32-bit access to a 16-bit register, which also accesses the register at the next address.
        neighbour = words == BOTH and register.width == 16 and not register.upper
        socket, harmless = place.socket, register.reads_are_harmless
        self.place = place
        self.register = register
        self.words = words
        self.field = field
        self.named: str = "" if field is None else field.name
        self.socket: Socket = socket
        self.chip: Chip = socket.chip
        self.offset: int = register.offset
        self.address: int = place.base + self.offset
        self.mask: int = WORDS_MASK[words] if field is None else field.mask
        self.lsb: int = 0 if field is None else field.lsb
        self.shift: int = 16 if words == HIGH else 0
        self.name: str = f"{place.name}.{register.name}"
        self.read_waits: int = waits.read[place.frame]
        self.write_waits: int = waits.write[place.frame]
        self.block: bool = place.base in PROTECTED_BLOCK
        self.frame1: bool = place.frame is Frame.PF1
        self.frame2: bool = place.frame is Frame.PF2
        self.protected: bool = register.protected
        self.pieack = register is PIEACK
        self.to_send: bool = register.name in TO_SEND
        self.recorded = recorded
        self.placed = False
        self.harmless: bool = harmless and not neighbour
        self.meets: bool = not self.harmless or socket.before is not None
        self.steady: bool = harmless and register.yields is not Yields.TIME
        self.looks: bool = harmless and words == LOW and register.width == 16 and socket.before is None

    def record(self, reads: Topic, writes: Topic) -> None:
        """Set the topics of the records of reads and writes."""
        self.reads, self.writes = reads, writes
        self.placed = self.records_place()
        self.looks = self.looks and not reads.makes_records()

    def records_place(self) -> bool:
        """Return True if records of reads of this operand contain the firmware's statement.

        If subscribers need statements only for read-modify-writes, records of reads of a single field contain none.
        """
        return self.reads.places > (OF_MODIFIES if self.field is not None else NOWHERE)

    def see(self, cycle: int) -> int:
        """Return what the CPU reads in this cycle, without side effects. The upper word is in bits 31:16."""
        socket, words = self.socket, self.words
        value = socket.see(cycle, self.offset) if words & LOW else 0
        return value | socket.see(cycle, self.offset + 1) << 16 if words & HIGH else value

    def __str__(self) -> str:
        return f"{self.name}.{self.field.name if self.field is not None else 'all'}"
