"""Functions and source lines of an image by address, from its debug data (DWARF).

Functions without debug data are found by their symbols. TI's compilers write DWARF 2 or 3. Addresses are run addresses
in words. Debug data that cannot be read are ignored.
"""

from __future__ import annotations

import inspect
import io
from bisect import bisect_right
from collections.abc import Callable, Iterator
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import NamedTuple, TypeVar

from elftools.dwarf.compileunit import CompileUnit
from elftools.dwarf.dwarfinfo import DebugSectionDescriptor, DwarfConfig, DWARFInfo

from .model import Image

ADDRESS_BYTES = 4
T = TypeVar("T")


class SourceLine(NamedTuple):
    """A line of a source file. file: the path that was passed to the compiler."""

    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"


class FunctionRange(NamedTuple):
    """The address range of a function. name: its name in C. end: the address after its last word."""

    name: str
    address: int
    end: int


class DebugInfo:
    """Debug data of an image. damaged: why the data could not be read completely; "" if no damage was found."""

    def __init__(self, image: Image) -> None:
        self.damaged = ""
        self._dwarf = _dwarf(image)

    @cached_property
    def functions(self) -> tuple[FunctionRange, ...]:
        """All functions in the debug data, in ascending order of addresses."""
        return tuple(sorted(set(self.each(_functions)), key=lambda function: (function.address, function.end)))

    @cached_property
    def lines(self) -> tuple[tuple[int, SourceLine | None], ...]:
        """(address, source line) for each address at which a line begins, in ascending order.

        The line is None where a range of addresses without a line begins.
        """
        found: dict[int, SourceLine | None] = {}
        for address, line in self.each(_lines):
            if line is not None or address not in found:
                found[address] = line
        return tuple(sorted(found.items()))

    def line_at(self, address: int) -> SourceLine | None:
        """Return the source line of the instruction at a run address; None if it has no line."""
        at = bisect_right(self.lines, address, key=lambda line: line[0]) - 1
        return self.lines[at][1] if at >= 0 else None

    def each(self, parse: Callable[[DWARFInfo, CompileUnit], Iterator[T]]) -> list[T]:
        """Return all that `parse` yields for the compilation units. Stop at damaged data, and set `damaged`."""
        found: list[T] = []
        if self._dwarf is None:
            return found
        try:
            for unit in self._dwarf.iter_CUs():
                found.extend(parse(self._dwarf, unit))
        except Exception as error:  # for damaged data, the library raises exceptions of many types
            self.damaged = f"{type(error).__name__}: {error}"
        return found


@lru_cache(maxsize=8)
def debug_info(image: Image) -> DebugInfo:
    """Return the debug data of an image. For the last few images, they are read only once."""
    return DebugInfo(image)


def _dwarf(image: Image) -> DWARFInfo | None:
    if ".debug_info" not in image.debug or ".debug_abbrev" not in image.debug:
        return None
    sections: dict[str, DebugSectionDescriptor | None] = {}
    for parameter in list(inspect.signature(DWARFInfo).parameters)[1:]:  # the first parameter is the configuration
        name = f".{parameter.removesuffix('_sec')}"
        data = image.debug.get(name)
        described = None if data is None else DebugSectionDescriptor(io.BytesIO(data), name, 0, len(data), 0)
        sections[parameter] = described
    config = DwarfConfig(little_endian=True, machine_arch="C2000", default_address_size=ADDRESS_BYTES)
    return DWARFInfo(config, **sections)


def _functions(dwarf: DWARFInfo, unit: CompileUnit) -> Iterator[FunctionRange]:
    for entry in unit.get_top_DIE().iter_children():
        found = entry.attributes
        if entry.tag == "DW_TAG_subprogram" and {"DW_AT_name", "DW_AT_low_pc", "DW_AT_high_pc"} <= found.keys():
            first, last = found["DW_AT_low_pc"].value, found["DW_AT_high_pc"]
            end = last.value if last.form == "DW_FORM_addr" else first + last.value
            if first < end:
                yield FunctionRange(text_of(found["DW_AT_name"].value), first, end)


def _lines(dwarf: DWARFInfo, unit: CompileUnit) -> Iterator[tuple[int, SourceLine | None]]:
    program = dwarf.line_program_for_CU(unit)
    if program is None:
        return
    states = [entry.state for entry in program.get_entries() if entry.state is not None]
    for state, after in pairwise([*states, None]):
        assert state is not None
        if state.end_sequence:
            yield state.address, None
        elif after is None or after.end_sequence or after.address != state.address:
            # If several lines begin at one address, only the last one is used.
            files = program["file_entry"]
            place = state.file if program["version"] >= 5 else state.file - 1
            file = text_of(files[place].name) if 0 <= place < len(files) else "?"
            yield state.address, SourceLine(file, state.line)


def text_of(raw: bytes | str) -> str:
    return raw.decode("utf-8", "replace") if isinstance(raw, bytes) else raw


class Function(NamedTuple):
    """A function of an image.

    address: its run address.
    size: its number of words.
    section: the name of its section.
    source: its first source line; None if it is unknown.
    """

    name: str
    address: int
    size: int
    section: str
    source: SourceLine | None


class FunctionMap:
    """The functions of an image. debug: its debug data. functions: all functions, ordered by section and address."""

    def __init__(self, image: Image) -> None:
        self.debug = debug_info(image)
        self.functions = tuple(functions_of(image, self.debug))
        self._by_address = sorted(self.functions, key=lambda function: function.address)
        self._starts = [function.address for function in self._by_address]

    def at(self, address: int) -> Function | None:
        """Return the function that contains an address; None if there is none.

        Functions are known from debug data and, where these lack a function, from symbols.
        """
        before = bisect_right(self._starts, address) - 1
        if before >= 0 and address < self._by_address[before].address + self._by_address[before].size:
            return self._by_address[before]
        return None

    def name_at(self, address: int) -> str:
        """Return the name of the function at an address; the address itself if there is none."""
        inside = self.at(address)
        return inside.name if inside else f"{address:#08x}"

    def named(self, name: str) -> Function | None:
        """Return the function with this name; None if there is none. If there are several, use the lowest address."""
        return next((function for function in self._by_address if function.name == name), None)


def functions_of(image: Image, debug: DebugInfo) -> Iterator[Function]:
    for section in image.code:
        described = {function.address: function for function in debug.functions if section.runs_at(function.address)}
        covered = [range(function.address, function.end) for function in described.values()]
        symbols = {
            symbol.address: symbol.name
            for symbol in sorted(image.symbols, key=lambda symbol: (not symbol.external, symbol.name), reverse=True)
            if symbol.section == section.name and not symbol.label and section.runs_at(symbol.address)
        }
        starts = sorted({*described, *(at for at in symbols if not any(at in where for where in covered))})
        for at, after in pairwise([*starts, section.run + section.size]):
            name = described[at].name if at in described else symbols[at]
            end = min(described[at].end, section.run + section.size) if at in described else after
            yield Function(name, at, end - at, section.name, debug.line_at(at))
