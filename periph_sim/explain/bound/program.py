"""The source files of a firmware: its main function goes in; functions by name come out, and which of them take time.

    main --globals--> modules of the firmware, not ours and no libraries --ast--> functions by name

What code calls is known by name alone: a call is one of every function of that name. A library can take no time
unless it is given the DSP.
"""

from __future__ import annotations

import ast
import builtins
import sys
import sysconfig
from collections.abc import Callable, Iterable, Iterator
from functools import cached_property
from pathlib import Path
from types import CodeType, FunctionType, ModuleType

from ...processor.dsp import Dsp
from ...processor.source_location import PACKAGE, is_ours
from ...timing.language.scope import MAPS
from .data_dependence import Function, Kind, Module, called

REGISTERS = {register.name for of in MAPS.values() for register in of.registers}
MACHINE = {name for name in dir(Dsp) if not name.startswith("_")} | {"idle"}  # calls that may take time
FREE = {"has", "module", "handle", "socket"}  # and those among them that take none
GIVEN_A_NAME = {"setattr", "getattr"}  # an access where they are given a module
BUILTINS = {name for name in vars(builtins) if not name.startswith("_")} - GIVEN_A_NAME
DATA = (bytes, bytearray, dict, list, set, str, tuple, int, float)
METHODS = {name for kind in DATA for name in vars(kind) if not name.startswith("_")}
PLAIN = BUILTINS | METHODS


class Program:
    """Functions of a firmware. unreadable: files whose source cannot be had."""

    def __init__(self, main: Callable[..., object]) -> None:
        self.modules: dict[str, Module] = {}
        self.unreadable: set[str] = set()
        for path in sorted(_files(main)):
            try:
                self.modules[path] = Module.of(Path(path))
            except (OSError, SyntaxError, UnicodeDecodeError):
                self.unreadable.add(path)
        self._paying: dict[ast.AST, bool] = {}
        self._callees: dict[ast.AST, list[tuple[Module, Function]]] = {}

    def function_at(self, code: CodeType) -> tuple[Module, Function] | None:
        """The function of a code object; of a lambda or comprehension the one around it."""
        module = self.modules.get(code.co_filename)
        found = None if module is None else _function_at(module, code.co_name, code.co_firstlineno)
        return None if module is None or found is None else (module, found)

    def called_from(self, parts: Iterable[tuple[Module, ast.AST]]) -> list[tuple[Module, ast.AST]]:
        """These parts of functions and all functions that they call, directly or not, as far as they may take time."""
        found: dict[ast.AST, Module] = {}
        waiting = list(parts)
        while waiting:
            module, part = waiting.pop()
            if part in found:
                continue
            found[part] = module
            waiting += self._called_in(module, part)
        return [(module, part) for part, module in found.items()]

    def _called_in(self, module: Module, part: ast.AST) -> list[tuple[Module, Function]]:
        """The functions that a part calls itself, as far as they may take time."""
        if part not in self._callees:
            calls = (node for node in module.walk(part) if isinstance(node, ast.Call))
            self._callees[part] = [(m, f) for call in calls for m, f in self._may_call(call) if self.pays(m, f)]
        return self._callees[part]

    def _may_call(self, node: ast.Call) -> Iterator[tuple[Module, Function]]:
        name = called(node)
        if name == "next":
            yield from self._generators
        for module in self.modules.values():
            yield from ((module, function) for function in module.functions.get(name, ()))
            if name in module.classes:
                inside = module.classes[name].body
                yield from ((module, each) for each in inside if isinstance(each, Function) and each.name == "__init__")

    @cached_property
    def _generators(self) -> list[tuple[Module, Function]]:
        return [
            (module, function)
            for module in self.modules.values()
            for named in module.functions.values()
            for function in named
            if any(isinstance(node, ast.Yield | ast.YieldFrom) for node in module.walk(function))
        ]

    def pays(self, module: Module, *nodes: ast.AST) -> bool:
        """True if running them may take time: an access, a computation, a wait, a call of something that does."""
        return any(self._pays(module, node) for node in nodes)

    def _pays(self, module: Module, node: ast.AST) -> bool:
        if node not in self._paying:
            self._paying[node] = False  # a function that calls itself: what else is in it decides
            self._paying[node] = any(self._takes_time(module, inner) for inner in module.walk(node))
        return self._paying[node]

    def _takes_time(self, module: Module, node: ast.AST) -> bool:
        if isinstance(node, ast.Attribute):
            return node.attr in REGISTERS
        if not isinstance(node, ast.Call):
            return False
        name = called(node)
        if name in MACHINE:
            return name not in FREE
        if any(self._pays(m, f) for m, f in self._may_call(node)):
            return True
        if name in PLAIN:
            return False
        given = [*node.args, *(key.value for key in node.keywords)]
        return any(isinstance(arg, ast.Lambda) or module.kind(arg) is Kind.HANDLE for arg in given)


def _function_at(module: Module, name: str, line: int) -> Function | None:
    functions = [function for named in module.functions.values() for function in named]
    if not name.startswith("<"):
        return next((f for f in functions if f.name == name and line in (f.lineno, _first_line(f))), None)
    around = [f for f in functions if _first_line(f) <= line <= (f.end_lineno or line)]
    return max(around, key=_first_line, default=None)


def _first_line(function: Function) -> int:
    return min([function.lineno, *(decorator.lineno for decorator in function.decorator_list)])


def _files(main: Callable[..., object]) -> set[str]:
    """The file of `main`, and those of the firmware's modules that its own names lead to."""
    found: set[str] = set()
    code = getattr(main, "__code__", None)
    if isinstance(code, CodeType):
        found.add(code.co_filename)
    waiting = [vars(sys.modules[main.__module__])] if main.__module__ in sys.modules else []
    if isinstance(main, FunctionType):
        waiting.append(main.__globals__)
    seen: set[int] = set()
    while waiting:
        names = waiting.pop()
        if id(names) in seen:
            continue
        seen.add(id(names))
        for value in list(names.values()):
            module = value if isinstance(value, ModuleType) else sys.modules.get(getattr(value, "__module__", "") or "")
            file = getattr(module, "__file__", None)
            if isinstance(file, str) and module is not None and not _is_library(file):
                found.add(file)
                waiting.append(vars(module))
    return found


LIBRARIES = tuple({sysconfig.get_paths()[key] for key in ("stdlib", "platstdlib", "purelib", "platlib")})


def _is_library(file: str) -> bool:
    return is_ours(file) or (file.startswith(LIBRARIES) and not file.startswith(PACKAGE))
