"""Declarations of a compiled module: the C types of its functions, and of its classes' attributes and methods."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple, cast

from .syntax import is_own, own_assignments, read_names, walked

if TYPE_CHECKING:
    from .sources import Source


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
    """An annotation or mark (`# core: ...`) of a source cannot be declared in C. The message has file and line."""


class Type(NamedTuple):
    """A type in C.

    c: the spelling of the type in a .pxd file.
    kind: the compiled class, if the type is a compiled class; otherwise None.
    optional: True if None is a valid value; always False for the type `object`, which accepts None in any case.
    """

    c: str
    kind: Class | None = None
    optional: bool = False


class Function(NamedTuple):
    """The declaration of a function.

    kind: "cpdef" if Python and C can call it, "cdef" if only C can call it, "def" if it stays a Python function.
    arguments: for each argument, by name, the pair (its type, True if it has a default).
    variables: the types of the annotated local variables, by name.
    result: the type of the result.
    marks: the words in the comment `# core:` of the function.
    """

    kind: str
    result: Type
    arguments: dict[str, tuple[Type, bool]]
    variables: dict[str, Type]
    marks: list[str]


CLASS_MARKS = re.compile(r"python|freelist \d+")


class Class:
    """A compiled class with its base, its attributes and its methods, and their C types."""

    def __init__(self, source: Source, node: ast.ClassDef) -> None:
        self.source, self.node, self.name = source, node, node.name
        self.marks = source.marks(node, CLASS_MARKS)
        self.is_final = bool(node.decorator_list)
        self.base = source.find_class(ast.unparse(node.bases[0])) if node.bases else None
        self.assigned_at: dict[str, int] = {}
        self.defined = {one.name: one for one in node.body if isinstance(one, ast.FunctionDef)}
        if self.base and self.base.is_final:
            raise source.bad(node.lineno, f"class {node.name} has the base {self.base.name}, which is @final")

    @property
    def bases(self) -> Iterator[Class]:
        one = self.base
        while one is not None:
            yield one
            one = one.base

    def member(self, name: str, called: bool) -> Type | None:
        """Return the type of an attribute or property, or, if `called` is True, the result type of a method.

        Return None if the type is unknown.
        """
        for one in (self, *self.bases):
            if name in one.defined:
                is_property = any(ast.unparse(way) == "property" for way in one.defined[name].decorator_list)
                return one.source.type_of(one.defined[name].returns) if called != is_property else None
            if not called and name in one.known:
                return one.known[name]
        return None

    @property
    def attributes(self) -> dict[str, Type]:
        """The types of the attributes that the class has in addition to those of its base, by name.

        Raise BadDeclaration if a type is unknown.
        """
        known = self.known
        for name, line in self.assigned_at.items():
            if name not in known:
                raise self.source.bad(line, f"nothing says the type of {self.name}.{name}; annotate it in the class")
        return known

    @cached_property
    def known(self) -> dict[str, Type]:
        """The types of the class's own attributes whose type an annotation or an assigned value determines, by name."""
        inherited = {name for base in self.bases for name in (*base.known, *base.defined)}
        found: dict[str, Type] = {}
        # The property is set before it is complete, because the value of an attribute may use other attributes.
        self.__dict__["known"] = found
        nodes = [one for one in self.node.body if isinstance(one, ast.AnnAssign) and one.value is None]
        annotated = [(one.target.id, one.annotation) for one in nodes if isinstance(one.target, ast.Name)]
        for one in (one for method in self.defined.values() for one in walked(method)):
            if isinstance(one, ast.AnnAssign) and is_own(one.target):
                annotated.append((cast("ast.Attribute", one.target).attr, one.annotation))
        for target, annotation in annotated:
            if target.isupper():  # uppercase names are constants that subclasses set
                continue
            kind = self.source.type_of(annotation)
            if found.setdefault(target, kind).c != kind.c:
                what = f"{self.name}.{target} is {kind.c} here and {found[target].c} in another annotation"
                raise self.source.bad(annotation.lineno, what)
        for method in sorted(self.defined.values(), key=lambda one: one.name != "__init__"):
            arguments = {one.arg: one.annotation for one in (*method.args.args, *method.args.kwonlyargs)}
            for name, value, line in own_assignments(method):
                if name in found or name in inherited or name in self.defined:
                    continue
                self.assigned_at.setdefault(name, line)
                if value and (says := self.source.type_of_value(value, self, arguments)):
                    found[name] = says
        return {name: kind for name, kind in found.items() if name not in inherited}

    @cached_property
    def methods(self) -> dict[str, Function]:
        handed_on = {name for one in (self, *self.bases) for name in read_names(one.node, "self")}
        found = {}
        for name, node in self.defined.items():
            over = next((base.methods[name] for base in self.bases if name in base.methods), None)
            kind = "cdef" if name.startswith("_") and name not in self.source.called_on_others else "cpdef"
            kind = "def" if name in handed_on or name.startswith("__") else kind
            if over and over.kind == "def":
                kind, over = "def", None
            found[name] = self.source.function(node, kind, over)
            if over and found[name].kind == "def":
                what = f"{self.name}.{name} cannot be compiled as the C method that it overrides can"
                raise self.source.bad(node.lineno, f"{what}; mark that one '# core: python'")
        return found
