"""C sources as firmware of a unit: the CPU of the unit makes their register accesses.

    main() in the library --runtime.c: access, basic blocks, asm--> Run --> Cpu, as for Python firmware
                        <-- value of the register, in memory ------'
    service routine    <-- called when its vector is taken --------'

gcc inserts a call of runtime.c before each access. For a write, this call announces the bytes; the store follows. The
time between two accesses is estimated: each basic block takes `BLOCK_CYCLES`.
"""

from __future__ import annotations

import ctypes
import re
import signal
from collections.abc import Callable, Sequence
from functools import partial
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory

from ...core.input_files import TEMPORARY
from ...core.state import State
from ...f28335.memory.memory_map import NoSuchAddress
from ..dsp import Dsp
from ..image.elsewhere import UnmappedMemory
from ..source_location import SourceLocation
from ..user_code import FirmwareError, FirmwareLost
from .library import (
    ANNOUNCED,
    ASSEMBLY,
    BYTES,
    DELAY,
    ENDS,
    FAULT,
    LOOPS,
    NO_PLACE,
    PROTECTED,
    READ,
    TOUCHED,
    UNWINDS,
    UNWOUND,
    WRITE,
    BadSources,
    Library,
    Sources,
    compiled,
    contents_of,
    enter_c,
    kept_in_c,
    leave_c,
    linked,
)
from .register_layout import BYTES_A_WORD, IER, IFR, LARGEST, VECTORS, WORD, BadLayout, Place, RegisterLayout

# Host address of the register memory of the first program, and the distance to that of the next program.
FIRST_BASE, ROOM = 0x2000_0000_0000, 0x100_0000
BLOCK_CYCLES = 6  # cycles of a basic block: about three statements with loads, operations and stores
BLOCKS_AT_ONCE = 64  # number of basic blocks after which time passes even without an access
LOOP_CYCLES = 1_000_000  # cycles that an endless empty loop takes at a time; service routines may interrupt them
DELAY_PASS, DELAY_CALL = 5, 9  # cycles of a pass of the loop in DSP28x_usDelay, and of a call of this function
ROUTINES = 0x31_0000  # first of the code addresses given to functions whose pointers are stored as vectors
_taken: set[int] = set()  # host addresses of the register memories of running programs
POINTER = 8  # bytes of a pointer on the host
RPT_NOP = re.compile(r"rpt\s+#(\d+)\s*\|\|\s*nop", re.IGNORECASE)


class HostFirmware:
    """The C program of a unit. Each call of `main` runs it from its beginning, with initialised variables.

    contents: the code and initial data of the compiled library.
    make_run: makes the `Run` for a call of `main`.
    run: the present run; None while `main` is not active.
    """

    STATE = State("elsewhere")

    def __init__(self, dsp: Dsp, sources: Sources) -> None:
        """Raise BadSources if the sources cannot be compiled and linked."""
        self.dsp = dsp
        self.make_run: Callable[[Dsp, Path, int, RegisterLayout], Run] = Run
        self.run: Run | None = None
        self._folder = TemporaryDirectory(prefix=TEMPORARY, ignore_cleanup_errors=True)
        self._objects, self._undefined = compiled(sources, Path(self._folder.name)), sources.undefined
        self._begun = 0
        library = linked(self._objects, self._undefined, FIRST_BASE, Path(self._folder.name) / "checked.so")
        self.contents = contents_of(library)
        try:
            self._layout = RegisterLayout(library)
        except BadLayout as error:
            raise BadSources(str(error)) from None

    @property
    def elsewhere(self) -> UnmappedMemory | None:
        """The memory outside of the modelled modules; None if there is no run."""
        return None if self.run is None else self.run.elsewhere

    def main(self) -> None:
        """Run the C function main to its end. Raise FirmwareError if there is no main, FirmwareLost after a fault."""
        self._begun += 1
        base = next(base for base in count(FIRST_BASE, ROOM) if base not in _taken)
        _taken.add(base)
        try:
            path = linked(self._objects, self._undefined, base, Path(self._folder.name) / f"{self._begun}.so")
            self.run = self.make_run(self.dsp, path, base, self._layout)
            self.run.main()
        finally:
            self.run = None
            _taken.discard(base)


class Run:
    """One run of a C program.

    assembly: for each assembly instruction that asm() may contain, except `rpt || nop`, the function that executes it.
    """

    def __init__(self, dsp: Dsp, path: Path, base: int, layout: RegisterLayout) -> None:
        """path: the library, which no other run has loaded, so that no variables are shared.

        base: the host address of the chip's word 0, where the register memory begins.
        """
        self.dsp = dsp
        self._layout = layout
        self._place = 0  # host address of the instruction that makes the current access
        self._raised: BaseException | None = None  # the exception that `_call` raises after the C functions have ended
        self._routines: dict[int, int] = {}  # maps a function pointer of the host to its code address
        self._places: list[Place] = []  # the places that C code has written so far
        self._numbers: dict[Place, int] = {}  # maps each place in `_places` to its number in runtime.c
        # Maps the host address of the call that announces a write to (offset from the announced bytes, size) of the
        # store that follows.
        self._stores: dict[int, tuple[int, int]] = {}
        self.elsewhere = UnmappedMemory(dsp.core, dsp.processor.notes)
        self.elsewhere.set_part(dsp.plan.part)
        cpu = dsp.cpu
        self.assembly: dict[str, Callable[[], None]] = {
            "clrc intm": cpu.eint,
            "setc intm": cpu.dint,
            "eallow": cpu.eallow,
            "edis": cpu.edis,
            "idle": cpu.idle,
            "nop": cpu.nop,
            "clrc dbgm": cpu.nop,
            "setc dbgm": cpu.nop,
        }
        self.library = Library(path, base, self._on_request, BLOCKS_AT_ONCE)

    def main(self) -> None:
        self.dsp.cpu.program.placed = self.place
        try:
            main = self.library.address_of("main")
            if main is None:
                raise FirmwareError(f"{self.dsp.name}: no source has a function main")
            with kept_in_c():
                self._call(main)
        finally:
            self.dsp.cpu.program.placed = None
            self.library.close(len(_taken) == 1)

    def place(self) -> SourceLocation | None:
        """Return the current C statement; None if it is unknown."""
        function, file, line = self.library.place_of(self._place)
        if not function:
            return None
        found = SourceLocation(f"{function}:{line}")
        found.path, found.line = file, line
        return found

    def _call(self, address: int) -> None:
        """Run the C function at a host address to its end. In an endless empty loop, let time pass without end.

        Raise the exception that `_on_request` has kept, or FirmwareLost if the host signals a fault.
        """
        enter_c()
        how = self.library.run(address)
        raised, self._raised = self._raised, None
        if how == UNWOUND and raised is not None:
            raise raised
        leave_c()
        while how == LOOPS:
            self.compute(LOOP_CYCLES)
        if how == FAULT:
            number, at, pc = self.library.fault()
            self._place = pc or self._place
            name = signal.strsignal(number)
            hint = (
                "; access a register by its structure's name, not by its address" if at < BYTES // BYTES_A_WORD else ""
            )
            raise FirmwareLost(f"{self.dsp.name}: {name} at {self.place()}, the host's address {at:#x}{hint}")

    # Requests of runtime.c --------------------------------------------------------------

    def _on_request(self, what: int, at: int, size: int, detail: int, blocks: int, pc: int) -> int:
        """Handle a request of runtime.c and return the reply.

        If an exception is raised, keep it and return UNWINDS. runtime.c then leaves the C functions, and `_call` raises
        the exception again.

        what: the kind of the request.
        at, size: the offset of the accessed bytes in register memory, and their number.
        detail: depends on the kind: the number of the place to write, the announced bytes, a text, or a count.
        blocks: the number of basic blocks executed since the last request.
        pc: the host address of the instruction.
        """
        reply = NO_PLACE
        try:
            leave_c()
            self._place = pc
            if blocks:
                self.compute(BLOCK_CYCLES * blocks)
            if what == READ:
                places = self._layout.read(at, size)
                if not places:
                    raise self._no_member(at, size)
                self.load(at, size, places)
            elif what == ANNOUNCED:
                reply = self._announced(at, size)
            elif what == WRITE:
                place = self._places[detail - PROTECTED - 1]
                value = int.from_bytes(self.library.memory[place.at : place.at + place.size], "little")
                if place.word in VECTORS:
                    value = self._vector(place, value)
                self.write_register(place.word, value & (1 << place.width) - 1, place.width)
            elif what == TOUCHED:
                self._stores[pc] = at - (detail >> 8), size
                reply = self._begin_write(self._stored(detail >> 8, detail & 0xFF))
            elif what == ASSEMBLY:
                self._assembled((ctypes.c_char_p(detail).value or b"").decode("latin-1"))
            elif what == DELAY:
                self.compute(DELAY_CALL + DELAY_PASS * detail)
            elif what == ENDS:
                how = (ctypes.c_char_p(detail).value or b"").decode("utf-8", "replace")
                raise FirmwareLost(f"{self.dsp.name}: {how} at {self.place()}; firmware on the chip cannot end")
            enter_c()
        except BaseException as raised:  # exceptions cannot pass through C code, so `_call` raises this one
            self._raised = raised
            return UNWINDS
        return reply

    def _announced(self, at: int, size: int) -> int:
        """Return the number of the place that C code writes next. at, size: the bytes that gcc has announced.

        Return PROTECTED if only the store instruction determines the place. runtime.c then protects these bytes, so
        that the store causes a fault, and finds the address and the size of the store in the handler of the fault.
        """
        if not self._layout.may_write(at, size):
            raise self._no_member(at, size)
        place = self._layout.announced(at, size)
        if place is None:
            return self._begin_write(self._stored(at, size)) if self._place in self._stores else PROTECTED
        number = self._begin_write(place)
        if not place.partial:
            self.library.write_as_announced(at, size, number)
        return number

    def _stored(self, at: int, size: int) -> Place:
        """Return the place that the current store writes. at, size: the bytes that gcc has announced for it.

        Raise FirmwareLost if there is no such place, or if runtime.c cannot decode the store.
        """
        further, stored = self._stores[self._place]
        if stored > LARGEST:
            raise FirmwareLost(
                f"{self.dsp.name}: the store at {self.place()} is an instruction that the host cannot follow; write "
                "the whole register"
            )
        place = self._layout.stored((at, size), at + further, stored)
        if place is None:
            raise self._no_member(at, size)
        return place

    def _begin_write(self, place: Place) -> int:
        """Return the number, for runtime.c, of the register or bit field that C code writes next.

        For a bit field, first read its word, because the store changes only some bits of the word.
        """
        if place.partial:
            self.load(place.at, place.size, (place,))
        number = self._numbers.get(place)
        if number is None:
            self._places.append(place)
            number = self._numbers[place] = PROTECTED + len(self._places)
        return number

    def _no_member(self, at: int, size: int) -> FirmwareLost:
        return FirmwareLost(
            f"{self.dsp.name}: an access of {size} bytes at {self.place()} is not a register's, {at % BYTES_A_WORD} "
            f"bytes into word {at // BYTES_A_WORD:#06x}; access a register by the member of its structure"
        )

    def _vector(self, place: Place, pointer: int) -> int:
        """Return the code address for a function pointer that the C code stores in the vector table.

        pointer: the host address of the function. If it is 0, a null pointer, return 0.

        Raise FirmwareLost if `place`, to which the C code writes, does not have the size of a function pointer.
        """
        program = self.dsp.cpu.program
        if place.size != POINTER or place.width != 2 * WORD:
            raise FirmwareLost(f"{self.dsp.name}: {self.place()} stores a vector that is not a function pointer")
        code = self._routines.get(pointer)
        if code is None and pointer:
            code = self._routines[pointer] = ROUTINES + len(self._routines)
            program.routine(code, partial(self.enter, pointer))
        return code or 0

    def _assembled(self, text: str) -> None:
        """Execute asm("...") of the sources. Raise FirmwareLost for ESTOP0, and if the text is not supported."""
        said = " ".join(text.lower().split())
        repeated = RPT_NOP.fullmatch(said)
        if repeated:
            self.compute(int(repeated[1]) + 2)
        elif said.startswith("estop0"):
            raise FirmwareLost(f"{self.dsp.name}: ESTOP0 is reached at {self.place()}")
        elif said.split(",")[0] in self.assembly:
            self.execute(said.split(",")[0])
        else:
            known = ", ".join(sorted(self.assembly))
            raise FirmwareLost(
                f"{self.dsp.name}: asm({text!r}) is not known on the host, which has {known}, rpt || nop"
            )

    # Accesses and time of the CPU ------------------------------------------------------

    def compute(self, cycles: int) -> None:
        self.dsp.cpu.compute(cycles)

    def execute(self, instruction: str) -> None:
        """Execute an instruction of `assembly`."""
        self.assembly[instruction]()

    def enter(self, pointer: int) -> None:
        """Run the service routine at a host address. Then `place` returns a statement of the interrupted code again."""
        place = self._place
        self._call(pointer)
        self._place = place

    def load(self, at: int, size: int, places: Sequence[Place]) -> None:
        """Read the registers at these places, and store their values in the host's memory.

        at, size: the bytes that the C code reads. All of them belong to these places.
        """
        cpu, core = self.dsp.cpu, self.dsp.core
        for place in places:
            word = place.word
            if word in VECTORS:
                continue  # the host's memory contains the vector, as a pointer of the host
            if word in (IER, IFR):
                value = core.ier if word == IER else core.ifr
            else:
                try:
                    value = cpu.load(word, place.width)
                except NoSuchAddress:
                    cpu.nop()
                    value = self.elsewhere.read(cpu.cycle, word)
                    if place.width > WORD:
                        value |= self.elsewhere.read(cpu.cycle, word + 1) << WORD
            if place.signed and value >> place.width - 1:
                value -= 1 << place.width
            value &= (1 << 8 * place.size) - 1
            self.library.memory[place.at : place.at + place.size] = value.to_bytes(place.size, "little")

    def write_register(self, word: int, value: int, width: int) -> None:
        """Write a register. word: its address on the chip. width: 16 or 32 bits."""
        cpu = self.dsp.cpu
        if word == IER:
            cpu.and_ier(value)
            cpu.or_ier(value)
            return
        if word == IFR:
            cpu.core.and_ifr(cpu.cycle, value)
            cpu.nop()
            return
        try:
            cpu.store(word, value, width)
        except NoSuchAddress:
            cpu.nop()
            for index in range(width // WORD):
                self.elsewhere.write(cpu.cycle, word + index, value >> WORD * index & 0xFFFF)
