"""Summary of an image: sections, vectors, registers, unknown words and functions.

Found by reading the code, not by running it: registers reached through a pointer in memory and vectors copied in a loop
from a table are missing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from ...f28335.memory.address_space import Content, area_at, register_name
from ...f28335.pie.register_map import VECTOR_TABLE, VECTORS
from ..c28x.decoder import Instruction, sweep
from .constants import Access, accesses
from .functions import Function, FunctionMap
from .model import Image, Section

VECTOR_NAMES = {address: name for name, address in VECTORS.items()}


class Vector(NamedTuple):
    """A store into the PIE vector table. handler: the function's name, or its address."""

    name: str
    address: int
    handler: str
    stored_in: str


class Unknown(NamedTuple):
    """A word of code that is not an instruction of this CPU."""

    address: int
    word: int
    function: str


class Register(NamedTuple):
    """A register that code accesses by its address. reads, writes: counts. functions: which access it."""

    module: str
    name: str
    address: int
    reads: int
    writes: int
    functions: tuple[str, ...]


@dataclass(frozen=True)
class Inspection:
    """entry_name: symbol or function at the entry, else its address. instructions, words: counts in code sections."""

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
    """Return the kind of a section: code, data, registers, reserved or ""."""
    if section.loaded:
        return "code" if section.code else "data"
    if not section.allocated:
        return ""
    area = area_at(section.run)
    return "registers" if area is not None and area.content is Content.REGISTERS else "reserved"
