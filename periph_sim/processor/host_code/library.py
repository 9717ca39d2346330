"""A compiled library that runs in this process.

Python calls its handler of SIGINT when a function begins, so also when C calls back: an exception raised there, before
the function's `try`, would be printed and dropped by ctypes. While C code runs, SIGINT is stored; `leave_c` then raises
KeyboardInterrupt.
"""

from __future__ import annotations

import ctypes
import signal
from array import array
from bisect import bisect_right
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from threading import current_thread, main_thread
from types import FrameType

from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection

from ..image_files.debug_info import DebugInfo
from ..image_files.load import Image
from .register_layout import LARGEST

BYTES = 0x4_0000  # bytes of registers: 2 ** 16 words
READ, ANNOUNCED, WRITE, TOUCHED, TIME, ASSEMBLY, DELAY, ENDS = range(8)  # requests of runtime.c
UNWINDS, NO_PLACE, PROTECTED = -1, 0, 1  # replies; larger numbers are places written
ENDED, UNWOUND, FAULT, LOOPS = range(4)  # how a function ended

Asked = Callable[[int, int, int, int, int, int], int]
ASKED = ctypes.CFUNCTYPE(
    ctypes.c_int,
    ctypes.c_int,
    ctypes.c_uint32,
    ctypes.c_uint32,
    ctypes.c_uint64,
    ctypes.c_uint64,
    ctypes.c_uint64,
)


class Library:
    """A compiled library of C firmware, loaded into this process.

    path: the file, which is loaded only here. base: the host address of the chip's word 0.
    """

    def __init__(self, path: Path, base: int, asked: Asked, blocks_at_once: int) -> None:
        self._path = path
        self._library = ctypes.CDLL(str(path))
        self._asked = ASKED(asked)  # kept alive here, because C does not
        self._library.c28x_begin.argtypes = (ctypes.c_uint64, ASKED, ctypes.c_uint64)
        self._library.c28x_run.argtypes = (ctypes.c_void_p,)
        if self._library.c28x_begin(base, self._asked, blocks_at_once):
            raise OSError(f"the host cannot map registers at {base:#x}")
        self.memory = memoryview((ctypes.c_ubyte * BYTES).from_address(base)).cast("B")
        self._numbers = (ctypes.c_int * (BYTES * (LARGEST + 1))).in_dll(self._library, "c28x_numbers")

    def write_as_announced(self, at: int, size: int, place: int) -> None:
        """Handle each write announced for these bytes as a write of this place, without calling Python."""
        self._numbers[at * (LARGEST + 1) + size] = place

    def answer(self, log: array[int]) -> ctypes.c_uint64:
        """Answer accesses from these items, but for the last. Return the number of the next item, a variable of C."""
        ctypes.c_uint64.in_dll(self._library, "c28x_log").value = log.buffer_info()[0]
        ctypes.c_uint64.in_dll(self._library, "c28x_log_end").value = max(len(log) - 1, 0)
        return ctypes.c_uint64.in_dll(self._library, "c28x_log_next")

    def run(self, address: int) -> int:
        """Call a function at a host's address, to its end: ENDED, UNWOUND, FAULT or LOOPS."""
        how: int = self._library.c28x_run(address)
        return how

    def fault(self) -> tuple[int, int, int]:
        """Return the signal of a FAULT, and the host addresses of the access and of the instruction; 0 if unknown."""
        number = ctypes.c_int.in_dll(self._library, "c28x_signal").value
        at, pc = (ctypes.c_uint64.in_dll(self._library, f"c28x_fault_{name}").value for name in ("at", "pc"))
        return number, at, pc

    def address_of(self, name: str) -> int | None:
        """Return the host address of a function; None if there is none of this name."""
        found = self._functions.get(name)
        return None if found is None else self.loaded_at + found

    def place_of(self, address: int) -> tuple[str, str, int]:
        """Return (function, file, line) of an instruction at a host address; empty and 0 if unknown."""
        at = address - self.loaded_at
        file, line = self._debug.line_at(at) or ("", 0)
        by_address = self._by_address
        place = bisect_right(by_address, (at, "\uffff")) - 1
        return by_address[place][1] if place >= 0 else "", file, line

    def close(self, last: bool) -> None:
        """Free the registers' memory. last: no other library runs. The library stays loaded until the process ends."""
        self._library.c28x_end(int(last))

    # Addresses ----------------------------------------------------------------------

    @cached_property
    def loaded_at(self) -> int:
        runs = ctypes.cast(self._library.c28x_run, ctypes.c_void_p).value
        assert runs is not None
        return runs - self._functions["c28x_run"]

    @cached_property
    def _functions(self) -> dict[str, int]:
        with self._path.open("rb") as file:
            table = ELFFile(file).get_section_by_name(".symtab")
            assert isinstance(table, SymbolTableSection)
            return {
                symbol.name: symbol["st_value"]
                for symbol in table.iter_symbols()
                if symbol["st_info"]["type"] == "STT_FUNC" and symbol["st_shndx"] != "SHN_UNDEF"
            }

    @cached_property
    def _by_address(self) -> list[tuple[int, str]]:
        return sorted((address, name) for name, address in self._functions.items())

    @cached_property
    def _debug(self) -> DebugInfo:
        with self._path.open("rb") as file:
            sections = [one for one in ELFFile(file).iter_sections() if one.name.startswith(".debug")]
            return DebugInfo(Image("ELF", 0, (), debug={one.name: one.data() for one in sections}))


def contents_of(library: Path) -> bytes:
    """Return code and initial data of a library, without debug information."""
    with library.open("rb") as file:
        sections = [one for one in ELFFile(file).iter_sections() if one["sh_flags"] & SH_FLAGS.SHF_ALLOC]
        return b"".join(one.data() for one in sections if one["sh_type"] == "SHT_PROGBITS")


_in_c = _kept = False
_programs = 0  # programs within `kept_in_c`
_before: Callable[[int, FrameType | None], object] = signal.default_int_handler


def enter_c() -> None:
    """Mark that C code runs."""
    global _in_c
    _in_c = True


def leave_c() -> None:
    """Mark that Python code runs. Raise KeyboardInterrupt if SIGINT came meanwhile."""
    global _in_c, _kept
    _in_c = False
    if _kept:
        _kept = False
        _before(signal.SIGINT, None)


@contextmanager
def kept_in_c() -> Iterator[None]:
    """Defer SIGINT in C code within the block; no effect outside the main thread."""
    global _programs, _before
    before = signal.getsignal(signal.SIGINT)
    if current_thread() is not main_thread() or not callable(before):
        yield
        return
    if not _programs:
        _before = before
        signal.signal(signal.SIGINT, _handle)
    _programs += 1
    try:
        yield
    finally:
        _programs -= 1
        if not _programs:
            signal.signal(signal.SIGINT, _before)


def _handle(number: int, frame: FrameType | None) -> None:
    global _kept
    if _in_c:
        _kept = True
    else:
        _before(number, frame)
