"""C sources as firmware of a unit: what they read, write and wait for goes in; the unit's CPU makes these accesses.

    main() in the library --runtime.c: access, piece of code, asm--> HostFirmware --> Cpu, as for Python firmware
                        <-- the register's value, in memory --------'
    service routine    <-- called as its vector is taken -----------'

The time between accesses is estimated: `BLOCK_CYCLES` for each piece of code without a branch, beside an access's own.
"""

from __future__ import annotations

import ctypes
import re
import signal
from collections.abc import Callable
from functools import partial
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory

from ..f28335.system.memory_map import NoSuchAddress
from ..processor.dsp import Dsp
from ..processor.error_origin import FirmwareError, FirmwareLost
from ..processor.image.elsewhere import Elsewhere
from ..processor.source_location import SourceLocation
from .build import Sources, compiled, linked
from .keyboard_interrupt import enter_c, kept_in_c, leave_c
from .library import ASSEMBLY, DELAY, FAULT, HALF_WORD, LOOPS, READ, UNWOUND, WORDS, WRITE, Library
from .register_symbols import IER, IFR, VECTORS

FIRST_BASE, ROOM = 0x2000_0000_0000, 0x100_0000  # of registers: one place for each program that runs
BLOCK_CYCLES = 6  # of a piece of code without a branch: some three statements' loads, operations and stores
BLOCKS_AT_ONCE = 64  # so many pass before time is looked at, in code without any access
LOOP_CYCLES = 1_000_000  # at once, of a loop without anything in it; service routines cut in
DELAY_PASS, DELAY_CALL = 5, 9  # DSP28x_usDelay: cycles of a pass, and of the call
ROUTINES = 0x31_0000  # code addresses of functions whose pointers are stored as vectors
_taken: set[int] = set()
LAYOUT = "declare registers of 16 bits as unsigned int, and those of 32 bits as unsigned long, as TI's headers do"
RPT_NOP = re.compile(r"rpt\s+#(\d+)\s*\|\|\s*nop", re.IGNORECASE)


class HostFirmware:
    """The program of a unit: each call of `main` is a run from its beginning on, with variables as they begin."""

    def __init__(self, dsp: Dsp, sources: Sources) -> None:
        """BadSources where they cannot be compiled and linked."""
        self._dsp = dsp
        self._folder = TemporaryDirectory(prefix="periph_sim_", ignore_cleanup_errors=True)
        self._objects = compiled(sources, Path(self._folder.name))
        self._begun = 0
        linked(self._objects, FIRST_BASE, Path(self._folder.name) / "checked.so")

    def main(self) -> None:
        """Run main to its end. FirmwareError without one; FirmwareLost where it cannot go on."""
        self._begun += 1
        base = next(base for base in count(FIRST_BASE, ROOM) if base not in _taken)
        _taken.add(base)
        try:
            path = linked(self._objects, base, Path(self._folder.name) / f"{self._begun}.so")
            _Run(self._dsp, path, base).main()
        finally:
            _taken.discard(base)


class _Run:
    """One run. path: of a library that nobody else loads, so that its variables are its own."""

    def __init__(self, dsp: Dsp, path: Path, base: int) -> None:
        self._dsp = dsp
        self._place = 0  # the host's address of the access that is made
        self._raised: BaseException | None = None
        self._routines: dict[int, int] = {}  # code address by function pointer
        self._widths: dict[int, tuple[int, int]] = {}  # register's address and width by word
        self._elsewhere = Elsewhere(dsp.core, dsp.processor.notes)
        cpu = dsp.cpu
        self._assembly: dict[str, Callable[[], None]] = {
            "clrc intm": cpu.eint,
            "setc intm": cpu.dint,
            "eallow": cpu.eallow,
            "edis": cpu.edis,
            "idle": cpu.idle,
            "nop": cpu.nop,
            "clrc dbgm": cpu.nop,
            "setc dbgm": cpu.nop,
        }
        self._library = Library(path, base, self._asked, BLOCKS_AT_ONCE)
        for place in dsp.memory.places.values():
            for register in place.socket.chip.MAP:
                if register.width == 32:
                    self._library.put_wide(place.base + register.offset)

    def main(self) -> None:
        self._dsp.cpu.program.placed = self.place
        try:
            main = self._library.address_of("main")
            if main is None:
                raise FirmwareError(f"{self._dsp.name}: no source has a function main")
            with kept_in_c():
                self._call(main)
        finally:
            self._dsp.cpu.program.placed = None
            self._library.close(len(_taken) == 1)

    def place(self) -> SourceLocation | None:
        """The statement that is executed."""
        function, file, line = self._library.place_of(self._place)
        if not function:
            return None
        found = SourceLocation(f"{function}:{line}")
        found.path, found.line = file, line
        return found

    def _call(self, address: int) -> None:
        """Run a function of the firmware to its end. FirmwareLost for a fault of the host's processor."""
        enter_c()
        how = self._library.run(address)
        raised, self._raised = self._raised, None
        if how == UNWOUND and raised is not None:
            raise raised
        leave_c()
        while how == LOOPS:
            self._dsp.cpu.compute(LOOP_CYCLES)
        if how == FAULT:
            self._place = self._library.fault_pc or self._place
            name, at = signal.strsignal(self._library.signal), self._library.fault_at
            hint = "; a register is found by its structure's name, not by its address" if at < WORDS else ""
            raise FirmwareLost(f"{self._dsp.name}: {name} at {self.place()}, the host's address {at:#x}{hint}")

    # What runtime.c asks ----------------------------------------------------------------

    def _asked(self, what: int, word: int, size: int, detail: int, blocks: int, pc: int) -> int:
        """0, or 1 for leaving the firmware's functions, where `_call` raises what was raised here."""
        try:
            leave_c()
            self._place = pc
            if blocks:
                self._dsp.cpu.compute(BLOCK_CYCLES * blocks)
            if what == READ:
                self._read(word)
            elif what == WRITE:
                self._write(word, size)
            elif what == ASSEMBLY:
                self._assembled((ctypes.c_char_p(detail).value or b"").decode("latin-1"))
            elif what == DELAY:
                self._dsp.cpu.compute(DELAY_CALL + DELAY_PASS * detail)
            elif what == HALF_WORD:
                raise FirmwareLost(
                    f"{self._dsp.name}: an access of {size} bytes at {self.place()} is no register's; {LAYOUT}"
                )
            enter_c()
        except BaseException as raised:  # nothing may pass through C: it goes on in `_call`
            self._raised = raised
            return 1
        return 0

    def _read(self, word: int) -> None:
        words, core = self._library.words, self._dsp.core
        if word in VECTORS:
            return  # stands there, as a pointer of the host
        if word in (IER, IFR):
            words[word] = core.ier if word == IER else core.ifr
            return
        address, width = self._register(word)
        try:
            words[address] = self._dsp.cpu.load(address, width)
        except NoSuchAddress:
            self._dsp.cpu.nop()
            words[word] = self._elsewhere.read(self._dsp.cpu.cycle, word)
            return
        if width == 32:
            words[address + 1] = 0  # `unsigned long` has 64 bits here, in the room of two words

    def _write(self, word: int, size: int) -> None:
        words, cpu = self._library.words, self._dsp.cpu
        if word in VECTORS:
            self._vector(word & ~1)
            return
        if word in (IER, IFR):
            self._status(word, words[word] & 0xFFFF)
            return
        address, width = self._register(word)
        try:
            cpu.store(address, words[address] & (1 << width) - 1, width)
        except NoSuchAddress:
            cpu.nop()
            self._elsewhere.write(cpu.cycle, word, words[word] & 0xFFFF)

    def _status(self, word: int, value: int) -> None:
        cpu, core = self._dsp.cpu, self._dsp.core
        if word == IER:
            cpu.and_ier(value)
            cpu.or_ier(value)
        else:
            core.and_ifr(cpu.cycle, value)
            cpu.nop()

    def _vector(self, address: int) -> None:
        """A pointer has been stored: the CPU's table gets a code address for it."""
        words, program = self._library.words, self._dsp.cpu.program
        pointer = words[address] | words[address + 1] << 32
        code = self._routines.get(pointer)
        if code is None and pointer:
            code = self._routines[pointer] = ROUTINES + len(self._routines)
            program.routine(code, partial(self._call, pointer))
        self._dsp.cpu.store(address, code or 0, 32)

    def _assembled(self, text: str) -> None:
        """asm("...") of the sources. FirmwareLost for what nobody knows here."""
        said = " ".join(text.lower().split())
        repeated = RPT_NOP.fullmatch(said)
        if repeated:
            self._dsp.cpu.compute(int(repeated[1]) + 2)
        elif said.startswith("estop0"):
            raise FirmwareLost(f"{self._dsp.name}: ESTOP0 is reached at {self.place()}")
        elif said.split(",")[0] in self._assembly:
            self._assembly[said.split(",")[0]]()
        else:
            known = ", ".join(sorted(self._assembly))
            raise FirmwareLost(
                f"{self._dsp.name}: asm({text!r}) is not known on the host, which has {known}, rpt || nop"
            )

    def _register(self, word: int) -> tuple[int, int]:
        """The register that a word belongs to, and its width: 16 where nothing is modelled."""
        found = self._widths.get(word)
        if found is None:
            try:
                _, register, back = self._dsp.memory.find(word)
                found = (word - back, register.width)
            except NoSuchAddress:
                found = (word, 16)
            self._widths[word] = found
        return found
