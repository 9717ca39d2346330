"""Summary of an image, as text and as JSON: sections, vectors, registers, unknown words and functions.

The code is decoded, but not executed. So registers that are accessed through a pointer in memory, and vectors that a
loop copies from a table, are not found.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from ...core.text_table import columns, paragraph, text_table
from ...f28335.memory.address_space import NOT_MODELLED, Content, area_at, register_name
from ...f28335.pie.register_map import VECTOR_TABLE, VECTORS
from ..c28x.decoder import Instruction, other_unit, sweep
from .constants import Access, accesses
from .debug_info import Function, FunctionMap
from .load import shared_memory
from .model import Image, Section

VECTOR_NAMES = {address: name for name, address in VECTORS.items()}


class Vector(NamedTuple):
    """A write of a vector to the PIE vector table.

    name, address: the name and the address of the vector.
    handler: the name of the service routine; its address if it has no name.
    stored_in: the name of the function that writes the vector.
    """

    name: str
    address: int
    handler: str
    stored_in: str


class Unknown(NamedTuple):
    """A word of code that is no instruction of this CPU. function: the name of the function that contains it."""

    address: int
    word: int
    function: str


class Register(NamedTuple):
    """A register that code accesses at a constant address.

    reads, writes: the number of instructions that read the register, and of those that write it.
    functions: the names of the functions that access the register.
    """

    module: str
    name: str
    address: int
    reads: int
    writes: int
    functions: tuple[str, ...]


@dataclass(frozen=True)
class Inspection:
    """The contents of an image, as `inspect` summarises them.

    entry_name: the symbol or function at the entry; the address of the entry if there is none.
    instructions, words: the numbers of instructions and words in the code sections.
    debug_damaged: the reason why the debug data could not be read completely; "" if they are undamaged.
    """

    image: Image
    entry_name: str
    functions: tuple[Function, ...]
    vectors: tuple[Vector, ...]
    registers: tuple[Register, ...]
    unknown: tuple[Unknown, ...]
    instructions: int
    words: int
    debug_damaged: str


def inspect(image: Image) -> Inspection:
    """Decode all code of an image once and summarise it."""
    functions = FunctionMap(image)
    starts = frozenset(function.address for function in functions.functions)
    named: list[tuple[Access, str]] = []
    unknown: list[Unknown] = []
    instructions = 0
    for section in image.code:
        code = list(sweep(section.run, section.words))
        for found in code:
            if isinstance(found, Instruction):
                instructions += 1
            else:
                word = section.words[found - section.run]
                unknown.append(Unknown(found, word, functions.name_at(found)))
        named += [(access, functions.name_at(access.instruction.address)) for access in accesses(code, starts)]
    return Inspection(
        image=image,
        entry_name=image.symbol_at.get(image.entry) or functions.name_at(image.entry),
        functions=functions.functions,
        vectors=tuple(_vectors(image, functions.functions, named)),
        registers=tuple(_registers(named)),
        unknown=tuple(unknown),
        instructions=instructions,
        words=sum(len(section.words) for section in image.code),
        debug_damaged=functions.debug.damaged,
    )


def _vectors(image: Image, functions: tuple[Function, ...], named: list[tuple[Access, str]]) -> Iterator[Vector]:
    names = image.symbol_at | {function.address: function.name for function in functions}
    found = {}
    for access, function in named:
        if access.address in VECTOR_TABLE and access.value is not None and "w" in access.how:
            name = VECTOR_NAMES.get(access.address, f"+{access.address - VECTOR_TABLE.start:#04x}")
            handler = names.get(access.value, f"{access.value:#08x}")
            found[access.address, handler] = Vector(name, access.address, handler, function)
    yield from sorted(found.values(), key=lambda vector: vector.address)


def _registers(named: list[tuple[Access, str]]) -> Iterator[Register]:
    touched: dict[tuple[str, str], list[tuple[Access, str]]] = {}
    for access, function in named:
        area = area_at(access.address)
        if area is not None and area.content is Content.REGISTERS and access.address not in VECTOR_TABLE:
            touched.setdefault(register_name(access.address), []).append((access, function))
    for (module, name), made in sorted(touched.items(), key=lambda item: item[1][0][0].address):
        yield Register(
            module=module,
            name=name,
            address=min(access.address for access, _ in made),
            reads=sum("r" in access.how for access, _ in made),
            writes=sum("w" in access.how for access, _ in made),
            functions=tuple(dict.fromkeys(function for _, function in made)),
        )


def contents_of(section: Section) -> str:
    """Return the kind of a section: "code", "data", "registers" or "reserved"; "" if it is not in memory."""
    if section.loaded:
        return "code" if section.code else "data"
    if not section.allocated:
        return ""
    area = area_at(section.run)
    return "registers" if area is not None and area.content is Content.REGISTERS else "reserved"


LONGEST_TEXT = 10  # number of functions that the text lists without -v


def text(found: Inspection, every: bool = False) -> str:
    """Return the summary as text of 80 columns.

    every: True to list all functions, and for each register the functions that use it.
    """
    image = found.image
    version = f", linker {image.tool_version}" if image.tool_version else ""
    count = len(found.unknown)
    known = f"{count} unknown word{'s' * (count > 1)}" if count else "all known"
    lines = [
        f"{image.kind}{version}, entry {image.entry:#08x} ({found.entry_name})",
        f"{found.instructions} instructions in {found.words} words of code, {known}",
    ]
    if found.debug_damaged:
        lines += paragraph(f"note: debug data are damaged and partly read ({found.debug_damaged})")
    for sentence in shared_memory(image):
        lines += paragraph(f"note: {sentence}")
    lines += [
        "",
        *_section_lines(found),
        "",
        *_vector_lines(found),
        "",
        *_register_lines(found, every),
        "",
        *_function_lines(found, every),
    ]
    if found.unknown:
        lines += ["", "words of code that are not instructions of the F28335:"]
        rows = [
            (f"{one.address:#08x}", f"{one.word:#06x}", one.function, other_unit(one.word)) for one in found.unknown
        ]
        lines += [line.rstrip() for line in columns(rows)]
    return "\n".join(lines)


def _section_lines(found: Inspection) -> list[str]:
    rows = []
    for section in found.image.sections:
        contents = contents_of(section)
        if contents in ("", "registers"):
            continue
        runs = f"{section.run:#08x}" if section.copied else ""
        rows.append((section.name, f"{section.address:#08x}", runs, str(section.size), contents))
    if found.image.initial:
        words = sum(len(words) for _, words in found.image.initial)
        rows.append((".cinit, applied", "", "", str(words), "data that the loader writes"))
    return text_table(("section", "loaded at", "runs at", "words", "contents"), rows, right=(3,))


def _vector_lines(found: Inspection) -> list[str]:
    if not found.vectors:
        return ["no vector is stored to a constant address"]
    rows = [(one.name, f"{one.address:#06x}", one.handler, one.stored_in) for one in found.vectors]
    return text_table(("vector", "address", "handler", "stored in"), rows)


def _register_lines(found: Inspection, every: bool) -> list[str]:
    if not found.registers:
        return ["no register is accessed by a constant address"]
    if every:
        rows = [
            (
                f"{one.module} {one.name}",
                f"{one.address:#06x}",
                str(one.reads),
                str(one.writes),
                ", ".join(one.functions),
            )
            for one in found.registers
        ]
        return text_table(("register", "address", "reads", "writes", "in"), rows, right=(2, 3))
    modules: dict[str, list[Register]] = {}
    for one in found.registers:
        modules.setdefault(one.module, []).append(one)
    rows_by_module = [(module or "-", ", ".join(one.name for one in named)) for module, named in modules.items()]
    lines = text_table(("module", "registers touched"), rows_by_module)
    absent = [module for module in modules if module in {one.name for one in NOT_MODELLED}]
    return [*lines, *paragraph(f"not modelled: {', '.join(absent)}", then="    ")] if absent else lines


def _function_lines(found: Inspection, every: bool) -> list[str]:
    largest = sorted(found.functions, key=lambda function: (-function.size, function.address))
    shown = found.functions if every else largest[:LONGEST_TEXT]
    rows = [(one.name, f"{one.address:#08x}", str(one.size), str(one.source or "")) for one in shown]
    lines = text_table(("function", "address", "words", "source"), rows, right=(2,))
    left_out = len(found.functions) - len(shown)
    return [*lines, f"and {left_out} smaller functions; -v lists all"] if left_out else lines


def as_json(found: Inspection) -> dict[str, object]:
    """Return the summary as a dictionary; addresses are numbers."""
    image = found.image
    return {
        "kind": image.kind,
        "linker": image.tool_version,
        "entry": {"address": image.entry, "name": found.entry_name},
        "instructions": found.instructions,
        "words": found.words,
        "sections": [
            {
                "name": section.name,
                "loaded_at": section.address,
                "runs_at": section.run,
                "words": section.size,
                "contents": contents_of(section),
            }
            for section in image.sections
            if section.allocated
        ],
        "vectors": [one._asdict() for one in found.vectors],
        "registers": [one._asdict() for one in found.registers],
        "functions": [
            {
                "name": one.name,
                "address": one.address,
                "words": one.size,
                "section": one.section,
                "file": one.source.file if one.source else None,
                "line": one.source.line if one.source else None,
            }
            for one in found.functions
        ],
        "unknown": [one._asdict() for one in found.unknown],
        "debug_damaged": found.debug_damaged,
        "shared_memory": shared_memory(image),
    }
