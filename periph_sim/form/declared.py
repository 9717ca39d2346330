"""Types and function signatures in C, as the annotations of a source declare them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from .compiled_class import Class

NUMBERS = {
    "bool": "bint",
    "int": "long long",
    "UInt8": "unsigned char",
    "UInt16": "unsigned short",
    "UInt32": "unsigned int",
}
BUILTINS = frozenset({"bytearray", "dict", "frozenset", "list", "set", "str", "tuple"})
BUFFERS = ("Buffer", "NDArray", "npt.NDArray")
OBJECT, VOID, INTEGER = "object", "void", NUMBERS["int"]


class BadDeclaration(Exception):
    """A source says something about a type that has no declaration in C; the message names file and line."""


class Type(NamedTuple):
    """c: as a .pxd file spells it. kind: the compiled class that it is. optional: None is a value, too."""

    c: str
    kind: Class | None = None
    optional: bool = False


class Function(NamedTuple):
    """kind: "cpdef", "cdef" or "def". arguments: the type of each, and whether it has a default."""

    kind: str
    result: Type
    arguments: dict[str, tuple[Type, bool]]
    variables: dict[str, Type]
    marks: list[str]
