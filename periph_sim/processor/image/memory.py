"""Memory of the CPU that runs an image: loads, stores and fetches of code, each made in the present cycle.

load16, store16 --> Ram
                --> Bus: registers of modules
                --> UnmappedMemory: flash, and frames that are not modelled
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from ...core.state import State
from ...f28335.memory.address_space import Content, area_at
from ...f28335.memory.ram import Ram, block_at
from ...f28335.system_control import register_map as clocks_map
from ...f28335.system_options import SystemOptions
from ...form.c_types import UInt16
from ..c28x.execution.engine import PAGE, Engine
from ..c28x.execution.registers import IllegalOperation
from ..c28x.pipeline import SP, addressing
from ..processor import Processor
from .data_marks import DataMarks
from .elsewhere import BOOT_ROM, UnmappedMemory
from .instruction_timing import InstructionTiming
from .observers import VariableRecords
from .polls import PollSkipper

WATCHDOG_KEY = clocks_map.BASE + clocks_map.WDKEY.offset
RAM_FROM, RAM_TO = 0x8000, 0x1_0000  # addresses of L0 to L7
LOW_RAM = 0x800  # M0 and M1 are below this address
WAITED_FROM = 0xC000  # L4 to L7, which begin here, have wait states as program memory
L0_AGAIN, L4_AGAIN = 0x3F_8000, 0x3F_C000  # L0 to L3 are mapped a second time, from L0_AGAIN to L4_AGAIN - 1
MIRROR = L0_AGAIN - 0x8000  # the second address of a word minus its first address


def in_plain_ram(address: int) -> bool:  # core: noexcept
    return address < LOW_RAM or RAM_FROM <= address < RAM_TO


def first_address(address: int) -> int:  # core: noexcept
    """Return the first address of a word of L0 to L3, which are mapped twice; return any other address unchanged."""
    return address - MIRROR if L0_AGAIN <= address < L4_AGAIN else address


class ImageMemory(Engine):
    """The memory that an image accesses: RAM, registers on the bus, and the words of `elsewhere`.

    elsewhere: the words outside of RAM and of the modelled modules.
    timing: the additional cycles of instructions.
    polls: detects waits of the program.
    watched: the observer of writes to variables; None if there is none.
    marks: the marks of data; None if they are not followed.
    reads_unwritten: a function that is called, with the address, at the first read of a RAM word that was not written
        before; None to call nothing.
    """

    STATE = State("elsewhere timing polls watched marks _tested _written _slots_seen")

    def __init__(self, processor: Processor, options: SystemOptions, skip_polls: bool) -> None:
        self._core = processor.core
        super().__init__()
        self._slots_seen: set[int] = set()  # addresses of FPU instructions whose delay slots were checked
        self._time = processor.time
        self._bus = processor.bus
        self._ram: Ram = processor.bus.ram
        self.elsewhere: UnmappedMemory = UnmappedMemory(self._core, processor.notes)
        self.timing = InstructionTiming(self._core, options, self.elsewhere)
        self._pipeline = self.timing.pipeline
        self._decoding = False
        self._tested = 0  # mask of the bits of its operand that the present instruction tests
        # For each RAM word: 1 if it was written, or if a read of the unwritten word has been reported; otherwise 0.
        self._written: Annotated[list[UInt16], RAM_TO] = [0] * RAM_TO
        self.watched: VariableRecords | None = None
        self.polls = PollSkipper(self._time, self._core, skip_polls)
        self.marks: DataMarks | None = None
        self.reads_unwritten: Callable[[int], None] | None = None

    def fill(self, address: int, value: int) -> None:
        """Set a word before the program begins, or as a preset when main begins. `watched` is not called."""
        address = first_address(address)
        if block_at(address) is not None:
            self._ram.put(address, value)
            self._written[address] = 1
        else:
            self.elsewhere.fill(address, value)

    def forget(self, addresses: range) -> None:
        """Clear words of RAM, and mark them as not written."""
        for address in addresses:
            self._ram.put(address, 0)
            self._written[address] = 0
            if self.marks is not None:
                self.marks.forget(address)
            if self._code[address >> PAGE]:
                self.written(address)

    def load16(self, address: int) -> int:
        if in_plain_ram(address):
            if self._pipeline.clock < self._pipeline.until:
                self.timing.wait_for_word(address, 1)
            if self.marks is not None:
                self.marks.loaded(address)
            value = self._ram.word(address)
            if not value and not self._written[address]:
                self._unwritten(address)
            return value
        return self._load(address, 16)

    def load32(self, address: int) -> int:
        if address & 1:
            address = self._even(address, "read from")
        if in_plain_ram(address):
            if self._pipeline.clock < self._pipeline.until:
                self.timing.wait_for_word(address, 2)
            if self.marks is not None:
                self.marks.loaded(address)
                self.marks.loaded(address + 1)
            value = self._ram.word32(address)
            # An unwritten word is 0, so `_written` is tested only if one of the two words is 0.
            if (not value & 0xFFFF or not value >> 16) and not (self._written[address] and self._written[address + 1]):
                self._unwritten(address)
                self._unwritten(address + 1)
            return value
        return self._load(address, 32)

    def _load(self, address: int, width: int) -> int:
        bus, cycle, polls = self._bus, self._time.cycle, self.polls
        operand = bus.find(address, width)
        if operand is None:
            if block_at(address) is not None:
                return bus.read(cycle, address, width)
            if L0_AGAIN <= address < L4_AGAIN:
                return self.load16(address - MIRROR) if width == 16 else self.load32(address - MIRROR)
        if self.marks is not None and operand is not None:
            self.marks.loaded_register(operand)
        if polls.replaying and polls.answer(cycle):
            return polls.answered()
        if operand is None:  # flash, boot ROM, or a frame that is not modelled
            value: int = self.elsewhere.read(cycle, address)
            if width == 32:
                value |= self.elsewhere.read(cycle, address + 1) << 16
            if polls.tracking:
                polls.note_elsewhere(address, value)
            return value
        if operand.meets:
            self._time.meet()
        if operand.recorded and self._tested and width == 16:
            value = bus.fetch(cycle, bus.naming(operand, self._tested)) >> operand.shift
        else:
            value = bus.load(cycle, operand, width)
        if polls.tracking:
            polls.note(operand, value)
        return value

    def store16(self, address: int, value: int) -> None:
        if in_plain_ram(address):
            if self.polls.tracking and self._ram.word(address) != value:
                self.polls.changes(address, self._ram.word(address))
            self._pipeline.wrote(address, 1, self.written_in)
            if self.marks is not None:
                self.marks.stored(address)
            self._ram.put(address, value)
            self._written[address] = 1
            if self._code[address >> PAGE] or self.watched is not None:
                self.written(address)
        else:
            self._store(address, value, 16)

    def store32(self, address: int, value: int) -> None:
        if address & 1:
            address = self._even(address, "written to")
        if in_plain_ram(address):
            if self.polls.tracking and self._ram.word32(address) != value:
                self.polls.changes(address, self._ram.word(address))
                self.polls.changes(address + 1, self._ram.word(address + 1))
            self._pipeline.wrote(address, 2, self.written_in)
            if self.marks is not None:
                self.marks.stored(address)
                self.marks.stored(address + 1)
            self._ram.put_word32(address, value)
            self._written[address] = self._written[address + 1] = 1
            if self._code[address >> PAGE] or self.watched is not None:
                self.written(address)
                self.written(address + 1)
        else:
            self._store(address, value, 32)

    def _even(self, address: int, how: str) -> int:
        """Return the even address that a 32-bit access uses in place of the odd address `address` [SPRU430F 5.11].

        Raise IllegalOperation if the instruction encodes this address by a mode that does not use SP, because an odd
        address is then a mistake of the program. SP may be odd.
        how: the words "read from" or "written to", for the message.
        """
        if self.ea == address and addressing(self.field) != SP:
            raise IllegalOperation(
                f"32 bits are {how} the odd address {address:#08x}; on the chip, {address & ~1:#08x}"
            )
        return address & ~1

    def _unwritten(self, address: int) -> None:
        if not self._written[address]:
            self._written[address] = 1
            if self.reads_unwritten is not None:
                self.reads_unwritten(address)

    def _store(self, address: int, value: int, width: int) -> None:
        if address == WATCHDOG_KEY:
            self.polls.restart()
        else:
            self.polls.soil()
        operand = self._bus.find(address, width)
        if self.marks is not None and not L0_AGAIN <= address < L4_AGAIN:
            self.marks.stored_elsewhere(operand, value)
        if operand is not None:
            self._bus.save(self._time.cycle, operand, value, width)
        elif L0_AGAIN <= address < L4_AGAIN:
            if width == 16:
                self.store16(address - MIRROR, value)
            else:
                self.store32(address - MIRROR, value)
        elif block_at(address) is not None:
            self._bus.write(self._time.cycle, address, value, width)
        else:
            self._keep(address, value & 0xFFFF)
            if width == 32:
                self._keep(address + 1, value >> 16)

    def written(self, address: int) -> None:
        Engine.written(self, address)
        self._slots_seen.difference_update((address - 1, address))
        if self.polls.counting:
            self.polls.soil()  # the word may be an instruction of the loop
        if L0_AGAIN <= address + MIRROR < L4_AGAIN:
            Engine.written(self, address + MIRROR)
            self._slots_seen.difference_update((address + MIRROR - 1, address + MIRROR))
        if self.watched is not None and address in self.watched.addresses:
            self.polls.soil()
            self.watched.written(address, self._time.cycle)

    def program16(self, address: int) -> int:
        if not self._decoding and (address >= WAITED_FROM or not in_plain_ram(address)):
            waits = self.elsewhere.fetches(address)[1]
            self.timing.late += waits + self.timing.read(self.pc, address, self._time.cycle, waits)
        if in_plain_ram(first_address(address)):
            if self.marks is not None:
                if self._decoding:
                    self.marks.decoded(first_address(address))
                else:
                    self.marks.loaded(first_address(address))
            return self._ram.word(first_address(address))
        area = area_at(address)
        if area is None or area.content is Content.REGISTERS:
            raise IllegalOperation(f"code is fetched from {address:#08x}, where there is no memory")
        if address in BOOT_ROM:
            raise IllegalOperation(f"code is fetched from {address:#08x}: routines of the boot ROM are not modelled")
        return self.elsewhere.read(self._time.cycle, address)

    def word_at(self, address: int) -> int:
        """Return a word of code, without cycles or other effects."""
        address = first_address(address)
        return self._ram.word(address) if in_plain_ram(address) else self.elsewhere.peek(address)

    def _keep(self, address: int, value: int) -> None:
        if self.elsewhere.write(self._time.cycle, address, value):
            self.written(address)
