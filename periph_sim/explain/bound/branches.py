"""What decides which code of a firmware runs: functions go in; decisions that are open come out, each with its place.

    source --ast--> kind of every value --> conditions, loops, costs, calls that neither settings nor waits decide

A path is fixed if nothing but settings, constants and the ends of waits decide it: then the same code runs whatever
the data and the phase, and what it takes once it takes always. A decision counts only where cycles depend on it: code
without accesses, computations and waits takes no time.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import CodeType

from msgspec import Struct

from .code_trace import Ran
from .data_dependence import WAITS, Function, Kind, Module, called
from .program import BUILTINS, MACHINE, METHODS, Program

SHOWN = 40  # characters of source that a message repeats
Comprehension = ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp
Loop = ast.For | ast.AsyncFor | ast.While


class Decision(Struct, frozen=True, order=True):
    """A place at which data or phase may decide what runs, or what it costs."""

    file: str
    line: int
    what: str

    def __str__(self) -> str:
        return f"{Path(self.file).name}:{self.line}: {self.what}"


class Decisions:
    """The decisions of one program."""

    def __init__(self, program: Program) -> None:
        self._program = program
        self._known: dict[ast.AST, tuple[Decision, ...]] = {}
        self._of_ran: dict[Ran, frozenset[Decision]] = {}

    def open(self, ran: Iterable[Ran]) -> tuple[Decision, ...]:
        """The open decisions of what ran, and of all that it may call, by file and line."""
        found: set[Decision] = set()
        for one in ran:
            if one not in self._of_ran:
                self._of_ran[one] = frozenset(self._open_in(*one))
            found |= self._of_ran[one]
        return tuple(sorted(found))

    def _open_in(self, code: CodeType, begin: int, end: int) -> Iterator[Decision]:
        at = self._program.function_at(code)
        if at is None:
            what = f"the source of {code.co_name} cannot be read"
            yield Decision(code.co_filename, code.co_firstlineno, what)
            return
        for module, part in self._program.called_from([(at[0], _part(*at, begin, end))]):
            if part not in self._known:
                self._known[part] = tuple(_Reader(self._program, module).found(part))
            yield from self._known[part]


def _part(module: Module, function: Function, begin: int, end: int) -> ast.AST:
    """What of a function can run between two of its lines: its outermost loop around both, or all of it."""
    around = [
        node
        for node in module.own_nodes(function)
        if isinstance(node, Loop) and all(node.lineno <= line <= (node.end_lineno or 0) for line in (begin, end))
    ]
    return min(around, key=lambda loop: loop.lineno, default=function)


class _Reader:
    """Reads functions of one module, or parts of them, node by node; functions within a function are others."""

    def __init__(self, program: Program, module: Module) -> None:
        self._program = program
        self._module = module
        self._file = next((path for path, one in program.modules.items() if one is module), "")

    def found(self, part: ast.AST) -> Iterator[Decision]:
        for node in (part, *self._module.own_nodes(part)):
            what = self._open(node)
            if what:
                yield Decision(self._file, getattr(node, "lineno", 0), what)

    def _open(self, node: ast.AST) -> str:
        """What is open about a node; empty if nothing is, or no cycles depend on it."""
        if isinstance(node, ast.If):
            return self._branch(node.test, [*node.body, *node.orelse])
        if isinstance(node, ast.IfExp):
            return self._branch(node.test, [node.body, node.orelse])
        if isinstance(node, ast.While):
            if not self._decided(node.test) and self._pays(node.test, *node.body, *node.orelse):
                return f"'while {_text(node.test)}' decides how often code runs"
        elif isinstance(node, ast.For | ast.AsyncFor):
            return self._repeated(node.iter, [*node.body, *node.orelse])
        elif isinstance(node, Comprehension):
            return self._comprehension(node)
        elif isinstance(node, ast.BoolOp):
            first, *others = node.values
            if self._pays(*others) and not self._decided(first):
                return f"'{_text(first)}' decides what runs"
        elif isinstance(node, ast.Match):
            if self._kind(node.subject) is not Kind.FIXED and self._pays(*node.cases):
                return f"'match {_text(node.subject)}' decides what runs"
        elif isinstance(node, ast.Try):
            if node.handlers and self._pays(*node.body, *node.handlers):
                return "an exception decides what runs"
        elif isinstance(node, ast.Call):
            return self._call(node)
        return ""

    def _branch(self, test: ast.expr, parts: list[ast.AST]) -> str:
        matters = self._pays(*parts) or any(self._leaves(part) for part in parts)
        return f"'if {_text(test)}' decides what runs" if matters and not self._decided(test) else ""

    def _repeated(self, over: ast.expr, body: list[ast.AST]) -> str:
        if self._kind(over) is Kind.FIXED or not self._pays(*body):
            return ""
        return f"'for ... in {_text(over)}' decides how often code runs"

    def _comprehension(self, node: Comprehension) -> str:
        body = [node.key, node.value] if isinstance(node, ast.DictComp) else [node.elt]
        for part in node.generators:
            body += part.ifs
        for part in node.generators:
            what = self._repeated(part.iter, list(body))
            what = what or next(filter(None, (self._branch(test, list(body)) for test in part.ifs)), "")
            if what:
                return what
        return ""

    def _call(self, node: ast.Call) -> str:
        """A computation's cost, and which function is called where a value says it."""
        name, func = called(node), node.func
        if name == "compute" and (node.args or node.keywords):
            cost = next((key.value for key in node.keywords if key.arg in ("cost", "cycles")), None)
            cost = cost if cost is not None or not node.args else node.args[0]
            if cost is not None and self._kind(cost) not in (Kind.FIXED, Kind.OBJECT):
                return f"'{_text(cost)}' decides what a computation costs"
        elif name in WAITS and any(key.arg == "timeout" for key in node.keywords):
            return "a wait may time out"
        elif name not in MACHINE | BUILTINS | METHODS:
            whose = func.value if isinstance(func, ast.Attribute) else func
            return f"'{_text(func)}' decides which function runs" if self._kind(whose) is Kind.OPEN else ""
        return ""

    def _leaves(self, part: ast.AST) -> bool:
        """True if it leaves the function, or a loop around it whose passes take time."""
        for node in self._module.walk(part):
            if isinstance(node, ast.Return):
                return True
            if isinstance(node, ast.Break | ast.Continue):
                loop: ast.AST | None = node
                while loop is not None and not isinstance(loop, Loop):
                    loop = self._module.parents.get(loop)
                if loop is not None and self._pays(loop):
                    return True
        return False

    def _decided(self, test: ast.expr) -> bool:
        return self._kind(test) in (Kind.FIXED, Kind.WAIT)

    def _kind(self, node: ast.expr) -> Kind:
        return self._module.kind(node)

    def _pays(self, *nodes: ast.AST) -> bool:
        return self._program.pays(self._module, *nodes)


def _text(node: ast.AST) -> str:
    """Source of a node, shortened for a message."""
    text = " ".join(ast.unparse(node).split())
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 3]}..."
