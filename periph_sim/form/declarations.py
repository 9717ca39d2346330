"""The text of a module's .pxd file, which declares the C types of its classes and functions to Cython.

class Event:                                            cdef class Event:
    time: int                                               cdef public long long time
    following: Event | None                                 cdef public Event following
def reschedule(self, event: Event, time: int) -> None:      @cython.locals(before=Event)
    before: Event = self._latest                            cpdef bint reschedule(self, Event event, ...) except -1
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from .compiled_class import INTEGER, VOID, Class, Function, Type
from .sources import Source, Sources

# LOCALS maps a C type to its name in the module `cython`.
LOCALS = {"long long": "longlong", "unsigned int": "uint", "int": "int", "bint": "bint"}
# RAISES maps a C result type to its declared error value, which a function returns if it has raised an exception.
# Without error values, the caller of a C function would have to ask Python after each call if an exception was raised.
# A function without a result has the C type `bint`: it returns False, or the error value after an exception.
RAISES = {VOID: " except -1", "bint": " except -1", INTEGER: " except? PERIPH_SIM_RAISED"}
RAISED = '''\
cdef extern from *:
    """
    #define PERIPH_SIM_RAISED (-0x7EDCBA9876543210LL)
    """
    const long long PERIPH_SIM_RAISED
'''  # PERIPH_SIM_RAISED is an improbable result; a caller that receives it asks Python if an exception was raised


@cache
def declarations(source: Source) -> Declarations:
    return Declarations(source)


def used_by(sources: Sources, module: str) -> set[str]:
    """Return the module and all modules whose types or C functions it uses, directly or indirectly."""
    found: set[str] = set()
    waiting = [module]
    while waiting:
        one = waiting.pop()
        if one not in found:
            found.add(one)
            waiting += declarations(sources[one]).needed
    return found


class Declarations:
    """The declarations of one module.

    text: the text of the .pxd file.
    needed: for each other module, the names to cimport from it.
    """

    def __init__(self, source: Source) -> None:
        self.source = source
        self.needed: dict[str, set[str]] = {}
        self.defined: set[str] = set()
        self.forward: list[str] = []
        self.text = self._text(source)

    def _text(self, source: Source) -> str:
        lines: list[str] = []
        for kind in source.classes.values():
            self.defined.add(kind.name)
            lines += ["", *self._class(kind)]
        if any(one.kind != "def" for one in source.functions.values()):
            lines.append("")
        for name, function in source.functions.items():
            if function.kind != "def":
                lines += self._function(name, function, "")
        for name, module in source.cimported.items():
            self.needed.setdefault(module, set()).add(name)
        head = ["cimport cython", "", RAISED]
        dots = "." * len(source.name.split("."))
        head += [
            f"from {dots}{module} cimport {', '.join(sorted(names))}" for module, names in sorted(self.needed.items())
        ]
        for name, types in source.pointers.items():
            head += [
                "",
                f"ctypedef bint (*{name})({', '.join(self._spelled(source.type_of(one)) for one in types)}) except -1",
            ]
        return "\n".join([*head, "", *self.forward, *lines, ""])

    def _class(self, kind: Class) -> Iterator[str]:
        if kind.is_final:
            yield "@cython.final"
        for mark in kind.marks:
            yield f"@cython.freelist({mark.removeprefix('freelist ')})"
        base = f"({self._spelled(Type(kind.base.name, kind.base))})" if kind.base else ""
        yield f"cdef class {kind.name}{base}:"
        body = []
        for name, type_ in kind.attributes.items():
            # Private buffers and private byte arrays are not declared public, so Python cannot access them.
            # If a byte array were declared public, Python would read the array only up to its first 0.
            hidden = name.startswith("_") and (type_.c.endswith("[::1]") or type_.c.startswith("unsigned char["))
            public = "" if hidden or type_.c in self.source.pointers or name.startswith("__") else "public "
            body.append(f"    cdef {public}{self._spelled(type_)} {name}")
        for name, function in kind.methods.items():
            overrides = any(name in base.methods for base in kind.bases)
            if function.kind != "def" and not (kind.is_final and overrides):
                body += self._function(name, function, "    ")
        yield from body or ["    pass"]

    def _function(self, name: str, function: Function, indent: str) -> Iterator[str]:
        variables = {one: kind for one, kind in function.variables.items() if one not in function.arguments}
        if variables:
            given = ", ".join(
                f"{one}={f'cython.{LOCALS[kind.c]}' if kind.c in LOCALS else self._spelled(kind)}"
                for one, kind in variables.items()
            )
            yield f"{indent}@cython.locals({given})"
        arguments = ["self"] if indent else []
        arguments += [
            f"{self._spelled(kind)} {one}{'=*' if optional else ''}"
            for one, (kind, optional) in function.arguments.items()
        ]
        result = self._spelled(function.result)
        tells = " noexcept" if "noexcept" in function.marks else RAISES.get(result, "")
        yield f"{indent}{function.kind} {result.replace(VOID, 'bint')} {name}({', '.join(arguments)}){tells}"

    def _spelled(self, kind: Type) -> str:
        """Return the spelling of a type in the .pxd file. Record its class, so that the file declares or imports it."""
        owner = kind.kind
        if owner is not None and owner.source is not self.source:
            self.needed.setdefault(owner.source.name, set()).add(owner.name)
        elif owner is not None and owner.name not in self.defined:
            self.defined.add(owner.name)
            base = f"({self._spelled(Type(owner.base.name, owner.base))})" if owner.base else ""
            self.forward.append(f"cdef class {owner.name}{base}")
        return kind.c
