"""DWARF of an image: an address goes in, file and line come out; functions with their first and last address.

TI's compilers write version 2 or 3, with addresses in words, those at which code runs. What cannot be read is absent.
"""

from __future__ import annotations

import inspect
import io
from bisect import bisect_right
from collections.abc import Callable, Iterator
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple, TypeVar

from elftools.dwarf.compileunit import CompileUnit
from elftools.dwarf.dwarfinfo import DebugSectionDescriptor, DwarfConfig, DWARFInfo
from elftools.dwarf.lineprogram import LineProgram

from .model import Image

ADDRESS_BYTES = 4
T = TypeVar("T")


class SourceLine(NamedTuple):
    """file: as the compiler was given it."""

    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"


class FunctionRange(NamedTuple):
    """name: as in C. end: the address behind its last word."""

    name: str
    address: int
    end: int


class DebugInfo:
    """damaged: why the debug data could not be read to its end; "" if it was."""

    def __init__(self, image: Image) -> None:
        self.damaged = ""
        self._dwarf = _dwarf(image)

    @cached_property
    def functions(self) -> tuple[FunctionRange, ...]:
        """Every function of which the compiler told, by address."""
        return tuple(sorted(set(self.each(_functions)), key=lambda function: (function.address, function.end)))

    @cached_property
    def lines(self) -> tuple[tuple[int, SourceLine | None], ...]:
        """From which address on a line goes, ascending; None from where no line is told."""
        found: dict[int, SourceLine | None] = {}
        for address, line in self.each(_lines):
            if line is not None or address not in found:
                found[address] = line
        return tuple(sorted(found.items()))

    def line_at(self, address: int) -> SourceLine | None:
        """The source line of the instruction at an address where code runs."""
        at = bisect_right(self._starts, address) - 1
        return self.lines[at][1] if at >= 0 else None

    @cached_property
    def _starts(self) -> list[int]:
        return [address for address, _ in self.lines]

    def each(self, told: Callable[[DWARFInfo, CompileUnit], Iterator[T]]) -> list[T]:
        """What each compilation unit tells, up to where the data are damaged."""
        found: list[T] = []
        if self._dwarf is None:
            return found
        try:
            for unit in self._dwarf.iter_CUs():
                found.extend(told(self._dwarf, unit))
        except Exception as error:  # of damaged data the library raises whatever its parts do
            self.damaged = f"{type(error).__name__}: {error}"
        return found


def _dwarf(image: Image) -> DWARFInfo | None:
    if ".debug_info" not in image.debug or ".debug_abbrev" not in image.debug:
        return None
    parameters = [name for name in inspect.signature(DWARFInfo).parameters if name != "config"]
    return DWARFInfo(
        DwarfConfig(little_endian=True, machine_arch="C2000", default_address_size=ADDRESS_BYTES),
        **{name: _described(image, f".{name.removesuffix('_sec')}") for name in parameters},
    )


def _described(image: Image, name: str) -> DebugSectionDescriptor | None:
    data = image.debug.get(name)
    return None if data is None else DebugSectionDescriptor(io.BytesIO(data), name, 0, len(data), 0)


def _functions(dwarf: DWARFInfo, unit: CompileUnit) -> Iterator[FunctionRange]:
    for entry in unit.get_top_DIE().iter_children():
        told = entry.attributes
        if entry.tag == "DW_TAG_subprogram" and {"DW_AT_name", "DW_AT_low_pc", "DW_AT_high_pc"} <= told.keys():
            first, last = told["DW_AT_low_pc"].value, told["DW_AT_high_pc"]
            end = last.value if last.form == "DW_FORM_addr" else first + last.value
            if first < end:
                yield FunctionRange(text_of(told["DW_AT_name"].value), first, end)


def _lines(dwarf: DWARFInfo, unit: CompileUnit) -> Iterator[tuple[int, SourceLine | None]]:
    program = dwarf.line_program_for_CU(unit)
    if program is None:
        return
    states = [entry.state for entry in program.get_entries() if entry.state is not None]
    for state, after in pairwise([*states, None]):
        assert state is not None
        if state.end_sequence:
            yield state.address, None
        elif after is None or after.end_sequence or after.address != state.address:  # the last line of an address holds
            yield state.address, SourceLine(_file(program, state.file), state.line)


def _file(program: LineProgram, number: int) -> str:
    files = program["file_entry"]
    return text_of(files[number - 1].name) if 0 < number <= len(files) else "?"


def text_of(raw: bytes | str) -> str:
    return raw.decode("utf-8", "replace") if isinstance(raw, bytes) else raw
