"""Changes of a firmware, one statement at a time: source and the names of functions go in, mutants come out.

    each statement --deleted------------> pass
                   --delayed by n-------> dsp.compute(n) before it
                   --moved past its neighbour
                   --each constant, named constant and register field in it exchanged for another

A constant loses its lowest bit; 0 becomes 1. A named one is exchanged for the next that its line defines; one that
comes from elsewhere, or stands alone, is halved. A field is exchanged for the next one of its register.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator
from dataclasses import dataclass

from periph_sim.core.registers import Register
from periph_sim.timing.names import MAPS

DELAYS = (20, 300)  # cycles
REGISTERS: dict[str, Register] = {register.name: register for each in MAPS.values() for register in each.registers}
VECTORS = {"SCIRXINTA": "SCITXINTA"}
BLOCKS = ("body", "orelse")

Path = tuple[tuple[str, int], ...]  # from a function down: which block, which statement of it


@dataclass(frozen=True)
class Mutant:
    """file: the module's name. line: of the statement. kind: what was done. before, after: the statement's source."""

    file: str
    function: str
    line: int
    kind: str
    before: str
    after: str
    tree: ast.Module

    def __str__(self) -> str:
        what = f" --> {self.after}" if self.kind == "exchanged" else ""
        return f"{self.file}.py:{self.line} {self.function}: {self.kind}: {self.before}{what}"


def mutants(file: str, source: str, functions: tuple[str, ...]) -> Iterator[Mutant]:
    """Every change of these functions' statements, in order."""
    tree = ast.parse(source)
    found = {node.name: node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    for name in functions:
        for path in _statements(found[name]):
            for kind, after, changed in _changes(tree, name, path):
                statement = _at(found[name], path)
                yield Mutant(file, name, statement.lineno, kind, _text(statement), after, changed)


def _statements(function: ast.AST, path: Path = ()) -> Iterator[Path]:
    """Where the statements of a function are, those within statements too."""
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


def _changes(tree: ast.Module, name: str, path: Path) -> Iterator[tuple[str, str, ast.Module]]:
    """(kind, the statement afterwards, the changed module)."""
    block, index = path[-1]

    def changed() -> tuple[ast.Module, list[ast.stmt], str]:
        whole = copy.deepcopy(tree)
        function = next(n for n in ast.walk(whole) if isinstance(n, ast.FunctionDef) and n.name == name)
        parent = _at(function, path[:-1]) if len(path) > 1 else function
        return whole, getattr(parent, block), "dsp" if function.args.args[0].arg == "dsp" else "self.dsp"

    whole, siblings, _ = changed()
    siblings[index] = ast.copy_location(ast.Pass(), siblings[index])
    yield "deleted", "pass", whole
    for cycles in DELAYS:
        whole, siblings, dsp = changed()
        siblings.insert(index, ast.copy_location(ast.parse(f"{dsp}.compute({cycles})").body[0], siblings[index]))
        yield f"{cycles} cycles late", "", ast.fix_missing_locations(whole)
    whole, siblings, _ = changed()
    if index + 1 < len(siblings):
        siblings[index], siblings[index + 1] = siblings[index + 1], siblings[index]
        yield f"moved past {_text(siblings[index])}", "", whole
    _, siblings, _ = changed()
    for number in range(len(list(_exchangeable(siblings[index])))):
        whole, siblings, _ = changed()
        place = list(_exchangeable(siblings[index]))[number]
        _exchange(siblings[index], place, _following(tree))
        yield "exchanged", _text(siblings[index]), ast.fix_missing_locations(whole)


def _exchangeable(statement: ast.stmt) -> Iterator[ast.expr]:
    """Constants, named constants and register fields of a statement, not of those within it."""
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
    """The register whose field this is."""
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
    """Of each named constant that the module defines together with others the next one."""
    found: dict[str, str] = {}
    for statement in tree.body:
        if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Tuple):
            names = [target.id for target in statement.targets[0].elts if isinstance(target, ast.Name)]
            found |= dict(zip(names, names[1:] + names[:1], strict=True))
    return found


def _text(statement: ast.AST) -> str:
    """The first line of a statement's source."""
    text = ast.unparse(statement).splitlines()[0]
    return text if len(text) <= 90 else f"{text[:87]}..."
