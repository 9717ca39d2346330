"""Mutants of firmware: each changes one statement of the given functions.

    each statement --deleted------------> pass
                   --delayed by n-------> dsp.compute(n) before it
                   --moved past its neighbour
                   --each constant, named constant and register field in it exchanged for another

A constant loses its lowest set bit; 0 becomes 1. A named constant is exchanged for the next one that its line defines;
one that is defined elsewhere or alone is halved. A field is exchanged for the next one of its register.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator
from dataclasses import dataclass, field

from periph_sim.core.registers import Register
from periph_sim.timing.language.scope import MAPS

DELAYS = (20, 300)  # cycles
DELETED, MOVED, EXCHANGED = "deleted", "moved past", "exchanged"
REGISTERS: dict[str, Register] = {register.name: register for each in MAPS.values() for register in each.registers}
VECTORS = {"SCIRXINTA": "SCITXINTA"}
BLOCKS = ("body", "orelse")

Path = tuple[tuple[str, int], ...]  # from a function down: a block, and the index of the statement in it


@dataclass(frozen=True)
class Mutant:
    """A changed module.

    file: the module's name.
    line: of the statement.
    kind: how it is changed.
    before, after: the source of the statement.
    source: of the whole module.
    path: of the statement.
    place: the number of the exchanged part in the statement.
    """

    file: str
    function: str
    line: int
    kind: str
    before: str
    after: str
    source: str = field(repr=False)
    path: Path
    place: int = 0

    def __str__(self) -> str:
        return f"{self.file}.py:{self.line} {self.text}"

    @property
    def text(self) -> str:
        """The changed statement and the change, without the line."""
        what = f" --> {self.after}" if self.kind == EXCHANGED else ""
        return f"{self.function}: {self.kind}: {self.before}{what}"

    def tree(self) -> ast.Module:
        """Return the changed module."""
        tree = ast.parse(self.source)
        function = _functions(tree)[self.function]
        parent = _at(function, self.path[:-1]) if len(self.path) > 1 else function
        block, index = self.path[-1]
        siblings = getattr(parent, block)
        if self.kind == DELETED:
            siblings[index] = ast.copy_location(ast.Pass(), siblings[index])
        elif self.kind == EXCHANGED:
            _exchange(siblings[index], list(_exchangeable(siblings[index]))[self.place], _following(tree))
        elif self.kind.startswith(MOVED):
            siblings[index], siblings[index + 1] = siblings[index + 1], siblings[index]
        else:
            dsp = "dsp" if function.args.args[0].arg == "dsp" else "self.dsp"
            late = ast.parse(f"{dsp}.compute({self.kind.split()[0]})").body[0]
            siblings.insert(index, ast.copy_location(late, siblings[index]))
        return ast.fix_missing_locations(tree)


def mutants(file: str, source: str, functions: tuple[str, ...]) -> Iterator[Mutant]:
    """Yield every change of the statements of these functions, in order."""
    tree = ast.parse(source)
    found, following = _functions(tree), _following(tree)
    for name in functions:
        for path in _statements(found[name]):
            parent = _at(found[name], path[:-1]) if len(path) > 1 else found[name]
            block, index = path[-1]
            statement, *others = getattr(parent, block)[index:]
            for kind, after, place in _changes(statement, others, following):
                yield Mutant(file, name, statement.lineno, kind, _text(statement), after, source, path, place)


def _changes(statement: ast.stmt, others: list[ast.stmt], following: dict[str, str]) -> Iterator[tuple[str, str, int]]:
    """Yield kind, changed statement and number of the changed part; `others` are the statements that follow."""
    yield DELETED, "pass", 0
    for cycles in DELAYS:
        yield f"{cycles} cycles late", "", 0
    if others:
        yield f"{MOVED} {_text(others[0])}", "", 0
    for place in range(len(list(_exchangeable(statement)))):
        changed = copy.deepcopy(statement)
        _exchange(changed, list(_exchangeable(changed))[place], following)
        yield EXCHANGED, _text(changed), place


def _functions(tree: ast.Module) -> dict[str, ast.FunctionDef]:
    return {node.name: node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}


def _statements(function: ast.AST, path: Path = ()) -> Iterator[Path]:
    """Yield the paths of the statements of a function, nested ones included."""
    for block in BLOCKS:
        for index, statement in enumerate(getattr(function, block, ())):
            if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
                continue  # a docstring
            if not isinstance(statement, ast.Assert | ast.Nonlocal | ast.Pass | ast.FunctionDef):
                yield (*path, (block, index))
            yield from _statements(statement, (*path, (block, index)))


def _at(function: ast.AST, path: Path) -> ast.stmt:
    node = function
    for block, index in path:
        node = getattr(node, block)[index]
    assert isinstance(node, ast.stmt)
    return node


def _exchangeable(statement: ast.stmt) -> Iterator[ast.expr]:
    """Yield constants, named constants and register fields of a statement, without those of nested statements."""
    waiting: list[ast.AST] = [
        node
        for node in ast.iter_child_nodes(statement)
        if not isinstance(node, ast.stmt) and isinstance(node, ast.expr)
    ]
    while waiting:
        node = waiting.pop(0)
        if (isinstance(node, ast.Constant) and (type(node.value) is int or node.value in VECTORS)) or (
            isinstance(node, ast.Name) and node.id.isupper()
        ):
            yield node
        elif isinstance(node, ast.Attribute) and _register(node) is not None:
            yield node
            continue
        waiting += [inner for inner in ast.iter_child_nodes(node) if not isinstance(inner, ast.stmt)]


def _register(node: ast.Attribute) -> Register | None:
    """Return the register of which this is a field, or None."""
    owner = node.value
    register = REGISTERS.get(owner.attr) if isinstance(owner, ast.Attribute) else None
    return register if register is not None and node.attr in register and len(register.fields) > 1 else None


def _exchange(statement: ast.stmt, place: ast.expr, following: dict[str, str]) -> None:
    if isinstance(place, ast.Attribute):
        register = _register(place)
        assert register is not None
        names = [field.name for field in register.fields]
        place.attr = names[(names.index(place.attr) + 1) % len(names)]
    elif isinstance(place, ast.Constant) and isinstance(place.value, str):
        place.value = VECTORS[place.value]
    elif isinstance(place, ast.Constant):
        assert isinstance(place.value, int)
        place.value = place.value & place.value - 1 if place.value else 1
    elif isinstance(place, ast.Name) and place.id in following:
        place.id = following[place.id]
    else:
        shifted = ast.copy_location(ast.BinOp(copy.deepcopy(place), ast.RShift(), ast.Constant(1)), place)
        for parent in ast.walk(statement):
            for name, value in ast.iter_fields(parent):
                if value is place:
                    setattr(parent, name, shifted)
                elif isinstance(value, list) and any(each is place for each in value):
                    value[:] = [shifted if each is place else each for each in value]


def _following(tree: ast.Module) -> dict[str, str]:
    """Return the successor of each named constant that the module defines together with others."""
    found: dict[str, str] = {}
    for statement in tree.body:
        if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Tuple):
            names = [target.id for target in statement.targets[0].elts if isinstance(target, ast.Name)]
            found |= dict(zip(names, names[1:] + names[:1], strict=True))
    return found


def _text(statement: ast.AST) -> str:
    """Return the first line of a statement's source."""
    text = ast.unparse(statement).splitlines()[0]
    return text if len(text) <= 90 else f"{text[:87]}..."
