"""Memory and peripheral frames that no modelled module contains.

    flash, OTP       contain the words of the image; all other words are erased
    PARTID           contains the number of the part
    ADC_cal          returns at once; on the chip, this routine only sets trims of the ADC
    math tables      of the boot ROM contain what TI's IQmath and fast floating-point libraries read (`rom_tables`)
    boot ROM         other words read as 0, and a note is made; calling a routine, or reading the version, is an error
    XINTF zones      are memory with the minimum of one wait state, and a note is made; XTIMING is ignored
    frames           of modules that are not modelled, or not in the unit, keep what is written, and a note is made;
                     a write to a command register of the flash is an error; a reset sets them to 0, or to FRAME_RESET
    stubs            are values that reads of a word return, regardless of writes to the word

Source: SPRS439M Figure 3-2, Tables 3-5 and 3-8 to 3-11; SPRUFB0D Tables 86 to 96 (EALLOW); SPRUI07 Table 2-19.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from ...core.chip import Note
from ...core.state import State
from ...f28335.cpu.interrupts import CpuInterrupts
from ...f28335.descriptor import FLASH, Part
from ...f28335.memory.address_space import Area, Content, area_at, full_name, is_protected, register_name
from ...f28335.memory.ram import Remainders
from ...f28335.parts.f28335 import PART
from ...form.c_types import UInt16
from ..c28x.execution.registers import IllegalOperation
from ..firmware_notes import FirmwareNotes

ERASED = 0xFFFF
FRAME_READ_WAITS, ROM_WAITS, EXTERNAL_WAITS, PASSWORD_WAITS = 2, 1, 1, 16
WAITS = {Content.REGISTERS: FRAME_READ_WAITS, Content.RAM: 0, Content.EXTERNAL: EXTERNAL_WAITS}  # others: ROM_WAITS
L4_WAITS = 1  # wait states of L4 to L7 as program memory
L4_TO_L7 = range(0xC000, 0x1_0000)
FLASH_BEGIN, FLASH_END = FLASH.start, FLASH.stop
PASSWORD = range(0x33_FFF8, 0x34_0000)
FOPT, FBANKWAIT, FOTPWAIT = 0x0A80, 0x0A86, 0x0A87
ENPIPE = 1  # mask of the bit ENPIPE in FOPT
PAGEWAIT = 8  # lowest bit of the field PAGEWAIT in FBANKWAIT; the field RANDWAIT begins at bit 0
ADC_CAL, LRETR = 0x38_0080, 0x0006  # the address of the routine ADC_cal, and the instruction LRETR
PARTID, CLASSID, FLOATING_POINT = 0x38_0090, 0x0882, 0x00EF
FRAME_RESET = {0x0A84: 0x01FF, 0x0A85: 0x01FF, FBANKWAIT: 0x0F0F, FOTPWAIT: 0x001F, CLASSID: FLOATING_POINT}
FLASH_COMMANDS = range(0x0A88, 0x0AE0)  # undocumented flash registers, which only TI's flash API writes
MATH_TABLES = range(0x3F_E000, 0x3F_F27C)
BOOT_ROM = range(0x3F_E000, 0x40_0000)
FLASH_API_CHECK = 0x3F_FFB9  # TI's flash API checks the silicon revision at this address
FRAMES_END = 0x8000  # all frames, and XINTF zone 0, are below this address
# Bits of `_states`. SEEN: the word was accessed, so a further access needs no note and no lookup. STUBBED: the word has
# a stub. PROTECTED: a write needs EALLOW. REGISTER: the word belongs to a peripheral frame.
SEEN, STUBBED, PROTECTED, REGISTER = 1, 2, 4, 8
NO_FLASH_API = "erasing and programming flash, as TI's flash API does, is not modelled"


class UnmappedMemory:
    """The words outside of RAM and of the modelled modules.

    changed: a function that is called when a stub is added or changed; None to call nothing.
    stubs: for each address with a stub, the value that reads of the address return now.
    to_come: the addresses that get a stub, or another value of their stub, later in the run.
    """

    STATE = State("_frames _states _stored _noted stubs to_come _flash")

    _flash_begin: int
    _part: Part

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Return remainders in place of the words and their properties. See `proof.normal_state`."""
        found = Remainders()
        place: int
        for place in range(FRAMES_END):
            both: int = self._frames[place]
            both = both << 16 | self._states[place]
            if both:
                found.add(place, both)
        return {"_frames": found.both(), "_states": None}

    def __init__(self, core: CpuInterrupts, notes: FirmwareNotes) -> None:
        self.changed: Callable[[], None] | None = None
        self._core = core
        self._notes = notes
        self._frames: Annotated[list[UInt16], FRAMES_END] = [0] * FRAMES_END  # words of frames and of XINTF zone 0
        # For each word in `_frames`, a mask of SEEN, STUBBED, PROTECTED and REGISTER.
        self._states: Annotated[list[UInt16], FRAMES_END] = [0] * FRAMES_END
        self._stored = {ADC_CAL: LRETR}  # for each address from FRAMES_END on that was set, its word
        for address, value in FRAME_RESET.items():
            self._frames[address] = value
        self._noted: set[str] = set()
        self.stubs: dict[int, int] = {}
        self.to_come: list[int] = []
        self._flash = self._fetches(Content.FLASH)  # the result is kept, because each jump in flash needs it
        self.set_part(PART)

    def reset(self) -> None:
        """Reset the registers of the frames. Memory in XINTF zone 0 keeps its contents."""
        for address in range(FRAMES_END):
            if self._states[address] & REGISTER:
                self._frames[address] = 0
        self._frames[FOPT] = 0
        for address, value in FRAME_RESET.items():
            self._frames[address] = value
        self._flash = self._fetches(Content.FLASH)

    def set_part(self, part: Part) -> None:
        """Use the memory map of this part, a member of the F2833x family."""
        self._part = part
        self._flash_begin = part.flash.start
        self._stored[PARTID] = part.part_id

    def fill(self, address: int, value: int) -> None:
        """Set a word before the program begins, or as a preset when main begins."""
        if address < FRAMES_END:
            self._frames[address] = value
        else:
            self._stored[address] = value

    def answer(self, address: int, value: int) -> None:
        """Add a stub, or change its value: each later read of the word at this address returns `value`."""
        self.stubs[address] = value
        if address < FRAMES_END:
            self._states[address] |= STUBBED
        if address in self.to_come:
            self.to_come.remove(address)
        if self.changed is not None:
            self.changed()

    def read(self, cycle: int, address: int) -> int:
        """Return the word at an address. Raise IllegalOperation if the word does not exist, or its value is unknown."""
        if address < FRAMES_END and self._states[address] & (SEEN | STUBBED) == SEEN:
            return self._frames[address]
        if self._flash_begin <= address < FLASH_END:
            return self._stored.get(address, ERASED)
        area = self._area(address, "read")
        if address in MATH_TABLES:
            from .rom_tables import words

            return words()[address - MATH_TABLES.start]
        if address == FLASH_API_CHECK:
            raise IllegalOperation(f"{address:#08x} of the boot ROM is read: {NO_FLASH_API}")
        self._note(cycle, address, area)
        self._mark(address, area)
        stub = self.stubs.get(address)
        if stub is not None:
            return stub
        if address < FRAMES_END:
            return self._frames[address]
        return self._stored.get(address, ERASED if area.content in (Content.FLASH, Content.OTP) else 0)

    def peek(self, address: int) -> int:
        """Return the stored word at an address, without notes or other effects; ERASED if nothing is stored there."""
        return self._frames[address] if address < FRAMES_END else self._stored.get(address, ERASED)

    def write(self, cycle: int, address: int, value: int) -> bool:
        """Write a word. Return True if the memory keeps the value, False if the write is ignored.

        Raise IllegalOperation if the word does not exist, or if it is a command register of the flash.
        """
        known: int = self._states[address] if address < FRAMES_END else 0
        if known & SEEN and (self._core.eallow or not known & PROTECTED):
            self._frames[address] = value
            return True
        area = self._area(address, "written")
        if address in FLASH_COMMANDS:
            raise IllegalOperation(f"{full_name(address)} is written: {NO_FLASH_API}")
        self._note(cycle, address, area)
        if area.content not in (Content.REGISTERS, Content.EXTERNAL):
            return False
        if not self._core.eallow and is_protected(address):
            text = f"{full_name(address)} was written without EALLOW; the write is ignored"
            self._notes.note(cycle, Note("duty", text, "SPRUFB0D section 7.2"))
            return False
        self._mark(address, area)
        if address >= FRAMES_END:
            self._stored[address] = value
            return True
        self._frames[address] = value
        if address in (FOPT, FBANKWAIT):
            self._flash = self._fetches(Content.FLASH)
        return True

    def _mark(self, address: int, area: Area) -> None:
        """Store the flags SEEN, PROTECTED and REGISTER of a word in `_states` at the first access to the word.

        The next access then needs no lookup. Flags are not stored for words from FRAMES_END on, and for registers of
        the flash whose accesses have further effects: FOPT, FBANKWAIT and FLASH_COMMANDS.
        """
        if address < FRAMES_END and address not in (FOPT, FBANKWAIT) and address not in FLASH_COMMANDS:
            registers = area.content is Content.REGISTERS
            known = SEEN | PROTECTED * is_protected(address) | REGISTER * registers
            self._states[address] |= known

    def read_waits(self, address: int) -> int:
        """Return the wait states of a data read of an address."""
        if address < FRAMES_END and self._states[address] & REGISTER:
            return FRAME_READ_WAITS
        if address in PASSWORD:
            return PASSWORD_WAITS
        if self._flash_begin <= address < FLASH_END:
            return self._flash[1]
        area = area_at(address)
        return 0 if area is None else self._waits(area.content)[0]

    def fetches(self, address: int) -> tuple[int, int, int]:
        """Return (bits, first, later) for fetches from program memory at an address.

        bits: a fetch reads 2 ** bits words.
        first: the wait states of the first fetch after a jump.
        later: the wait states of each fetch that follows.
        """
        if self._flash_begin <= address < FLASH_END:
            return self._flash
        area = area_at(address)
        if area is None or area.content is Content.RAM:
            waits = L4_WAITS if address in L4_TO_L7 else 0
            return 1, waits, waits
        return self._fetches(area.content)

    def _fetches(self, content: Content) -> tuple[int, int, int]:
        first, later = self._waits(content)
        wide = content is Content.FLASH and self._frames[FOPT] & ENPIPE
        return 2 if wide else 1, first, later

    def _waits(self, content: Content) -> tuple[int, int]:
        """Return (wait states of a first access, wait states of each access that follows directly)."""
        if content is Content.FLASH:
            waits = self._frames[FBANKWAIT]
            return max(waits & 0xF, 1), max(waits >> PAGEWAIT & 0xF, 1)
        if content is Content.OTP:
            waits = max(self._frames[FOTPWAIT] & 0x1F, 1)
            return waits, waits
        waits = WAITS.get(content, ROM_WAITS)
        return waits, waits

    def _area(self, address: int, how: str) -> Area:
        area = area_at(address)
        if area is None or FLASH_BEGIN <= address < self._flash_begin:
            raise IllegalOperation(f"{address:#08x} is {how}, where the {self._part.name} has nothing")
        return area

    def _note(self, cycle: int, address: int, area: Area) -> None:
        """Make a note at the first access to an area whose contents or timing is not modelled."""
        name = register_name(address)[0] if area.content is Content.REGISTERS else area.name
        if name in self._noted:
            return
        if address in BOOT_ROM:
            text, source = f"{name}: {address:#08x} is read as 0; its contents are not modelled", "SPRUI07 section 2.4"
        elif area.content is Content.EXTERNAL:
            text = f"{name}: {address:#08x} is treated as memory with {EXTERNAL_WAITS} wait state, the minimum of XINTF"
            text, source = f"{text}; XTIMING is not modelled", "SPRS439M Table 3-5"
        elif area.content is Content.REGISTERS:
            state = "is not in this unit (name it in modules)" if name in self._part.selectable else "is not modelled"
            text = f"{name or 'a frame'} at {address:#06x} {state}; it keeps what is written"
            source = "SPRS439M Tables 3-8 to 3-11"
        else:
            return
        self._noted.add(name)
        self._notes.note(cycle, Note("unknown", text, source))
