"""A compiled library in this process: a file goes in; its functions, registers and places come out."""

from __future__ import annotations

import ctypes
from bisect import bisect_right
from collections.abc import Callable
from functools import cached_property
from pathlib import Path

from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection

from .register_layout import LARGEST

BYTES = 0x4_0000  # of registers: 2 ** 16 words
READ, ANNOUNCED, WRITE, TOUCHED, TIME, ASSEMBLY, DELAY, ENDS = range(8)  # what runtime.c asks
UNWINDS, NO_PLACE, PROTECTED = -1, 0, 1  # what it is answered; larger numbers are places that are written
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
    """path: of the file, which nobody else loads. base: the host's address of the chip's word 0."""

    def __init__(self, path: Path, base: int, asked: Asked, blocks_at_once: int) -> None:
        self._path = path
        self._library = ctypes.CDLL(str(path))
        self._asked = ASKED(asked)  # held, since C does not hold it
        self._library.c28x_begin.argtypes = (ctypes.c_uint64, ASKED, ctypes.c_uint64)
        self._library.c28x_run.argtypes = (ctypes.c_void_p,)
        if self._library.c28x_begin(base, self._asked, blocks_at_once):
            raise OSError(f"the host has no room for registers at {base:#x}")
        self.memory = memoryview((ctypes.c_ubyte * BYTES).from_address(base)).cast("B")
        self._numbers = (ctypes.c_int * (BYTES * (LARGEST + 1))).in_dll(self._library, "c28x_numbers")

    def write_as_announced(self, at: int, size: int, place: int) -> None:
        """Take each write that is announced for these bytes as a write of this place, without a call of Python."""
        self._numbers[at * (LARGEST + 1) + size] = place

    def run(self, address: int) -> int:
        """Call a function at a host's address, to its end: ENDED, UNWOUND, FAULT or LOOPS."""
        how: int = self._library.c28x_run(address)
        return how

    @property
    def signal(self) -> int:
        """By which signal it ended in a FAULT."""
        return ctypes.c_int.in_dll(self._library, "c28x_signal").value

    @property
    def fault_at(self) -> int:
        """The host's address that the fault was about."""
        return ctypes.c_uint64.in_dll(self._library, "c28x_fault_at").value

    @property
    def fault_pc(self) -> int:
        """The host's address of the instruction that did it; 0 where the host does not tell."""
        return ctypes.c_uint64.in_dll(self._library, "c28x_fault_pc").value

    def address_of(self, name: str) -> int | None:
        """The host's address of a function; None where the sources have none of this name."""
        found = self._functions.get(name)
        return None if found is None else self._loaded_at + found

    def place_of(self, address: int) -> tuple[str, str, int]:
        """(function, file, line) of an instruction at a host's address; empty and 0 where nothing tells them."""
        at = address - self._loaded_at
        rows, starts = self._lines
        row = bisect_right(starts, at) - 1
        file, line = rows[row] if row >= 0 else ("", 0)
        by_address = self._by_address
        place = bisect_right(by_address, (at, "\uffff")) - 1
        return by_address[place][1] if place >= 0 else "", file, line

    def close(self, last: bool) -> None:
        """Registers give back their place. last: no other library runs. What is loaded stays, as the process lasts."""
        self._library.c28x_end(int(last))

    # Where things are ---------------------------------------------------------------

    @cached_property
    def _loaded_at(self) -> int:
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
    def _lines(self) -> tuple[list[tuple[str, int]], list[int]]:
        """(file, line) by address, and the addresses."""
        found: dict[int, tuple[str, int]] = {}
        with self._path.open("rb") as file:
            dwarf = ELFFile(file).get_dwarf_info()
            for unit in dwarf.iter_CUs():
                program = dwarf.line_program_for_CU(unit)
                if program is None:
                    continue
                first = 0 if program["version"] >= 5 else 1
                names = [entry.name.decode("utf-8", "replace") for entry in program["file_entry"]]
                for entry in program.get_entries():
                    state = entry.state
                    if state is not None and not state.end_sequence:
                        found[state.address] = (names[state.file - first], state.line)
        starts = sorted(found)
        return [found[start] for start in starts], starts
