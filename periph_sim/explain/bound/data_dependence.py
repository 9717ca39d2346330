"""Kinds of values in a firmware's source: a file goes in; what each expression can depend on comes out.

    FIXED   settings, constants, and what arithmetic makes of them: the same for the whole run
    HANDLE  the DSP and its modules; reading through one is an access
    OBJECT  made once from those: the name never means another object, but what is in it may change
    WAIT    how a wait ended: the bus decides it, in the order in which things happen there
    OPEN    all else: data, flags, and whatever is not followed

Assignments are known by name, whatever the order: a name that is assigned twice is open. It errs to that side.
"""

from __future__ import annotations

import ast
import builtins
from collections import defaultdict
from collections.abc import Iterator
from enum import Enum
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple, cast, get_args

Function = ast.FunctionDef | ast.AsyncFunctionDef
Scope = Function | ast.Lambda | ast.Module
Apart = Scope | ast.ClassDef  # what has names of its own
BARE = (ast.expr_context, ast.operator, ast.boolop, ast.unaryop, ast.cmpop)  # parts of nodes that hold nothing
Loop = ast.For | ast.AsyncFor | ast.comprehension
Named = ast.ExceptHandler | ast.MatchAs | ast.MatchStar

# Every node of every source is asked for these as a run begins: nodes are of these very classes, so that sets tell.
SCOPES = frozenset(get_args(Scope))
ASSIGNING = frozenset({ast.Assign, ast.AnnAssign, ast.NamedExpr, ast.AugAssign, ast.withitem, ast.Delete})
ASSIGNING |= {*get_args(Loop), *get_args(Named), ast.MatchMapping}

WAITS = frozenset({"spin", "spin_either"})
PURE = frozenset(
    {abs, bool, divmod, enumerate, float, frozenset, int, isinstance, len, max, min, pow, range, reversed, round}
    | {sorted, str, sum, tuple, zip}
)  # builtins that make something fixed of what is fixed
LOOKUPS = frozenset({"get", "items", "keys", "values"})
DSP = "Dsp"
SETTINGS = "Settings"  # the class of which a case makes the settings


class Kind(Enum):
    FIXED = "fixed"
    HANDLE = "handle"
    OBJECT = "object"
    WAIT = "wait"
    OPEN = "open"


class Assigned(NamedTuple):
    """value: None where it is not followed. part: the name gets an element of it, and not all of it."""

    target: ast.AST
    value: ast.expr | None
    part: bool = False


class Module:
    """One source file. OSError, SyntaxError, UnicodeDecodeError where it cannot be read."""

    @staticmethod
    def of(path: Path) -> Module:
        """The module of a file, taken apart once for each text that it has had."""
        return _module(path.read_text(encoding="utf-8"))

    def __init__(self, tree: ast.Module) -> None:
        self.tree = tree
        self.parents: dict[ast.AST, ast.AST] = {}
        self._children: dict[ast.AST, list[ast.AST]] = {}
        self._scopes: dict[ast.AST, Scope] = {tree: tree}
        nodes = self._taken_apart()
        self.functions: dict[str, list[Function]] = defaultdict(list)
        self.classes = {node.name: node for node in nodes if isinstance(node, ast.ClassDef)}
        self._calls: dict[str, list[ast.Call]] = defaultdict(list)
        self._passed_on: set[str] = set()  # functions and classes that are used as values
        self._names: dict[tuple[Scope, str], list[Assigned]] = defaultdict(list)
        self._attributes: dict[str, list[Assigned]] = defaultdict(list)
        self._kinds: dict[ast.AST, Kind] = {}
        self._from_outside: dict[Scope, dict[str, Scope]] = {}  # names that `global` and `nonlocal` fetch, and whence
        for node in nodes:
            if isinstance(node, Function):
                self.functions[node.name].append(node)
            elif isinstance(node, ast.Call):
                self._calls[called(node)].append(node)
            elif isinstance(node, ast.Name | ast.Attribute) and self._is_passed_on(node):
                self._passed_on.add(node.id if isinstance(node, ast.Name) else node.attr)
            if type(node) in ASSIGNING:
                self._keep_assignments(node)

    def _taken_apart(self) -> list[ast.AST]:
        """All nodes, the outer ones first; each gets its children, its parent and its scope."""
        nodes: list[ast.AST] = [self.tree]
        for node in nodes:  # which grows meanwhile
            scope = cast(Scope, node) if type(node) in SCOPES else self._scopes[node]
            found = [child for child in ast.iter_child_nodes(node) if not isinstance(child, BARE)]
            for child in found:
                self.parents[child] = node
                self._scopes[child] = scope
            self._children[node] = found
            nodes += found
        return nodes

    def scope(self, node: ast.AST) -> Scope:
        """The function, lambda or module that a node belongs to."""
        return self._scopes[node]

    def walk(self, node: ast.AST) -> Iterator[ast.AST]:
        """A node and all that is in it, the outer ones first."""
        nodes = [node]
        for inner in nodes:  # which grows meanwhile
            yield inner
            nodes += self._children[inner]

    def own_nodes(self, scope: ast.AST) -> Iterator[ast.AST]:
        """The nodes of a function without those of functions, lambdas and classes in it."""
        waiting = list(self._children[scope])
        while waiting:
            node = waiting.pop()
            yield node
            if not isinstance(node, Apart):
                waiting += self._children[node]

    # Assignments -----------------------------------------------------------------

    def _keep_assignments(self, node: ast.AST) -> None:
        if isinstance(node, ast.Assign):
            for target in node.targets:
                self._assign(target, node.value)
        elif isinstance(node, ast.AnnAssign | ast.NamedExpr):
            self._assign(node.target, node.value)
        elif isinstance(node, ast.AugAssign):
            self._assign(node.target, None)
        elif isinstance(node, Loop):
            self._assign(node.target, node.iter, part=True)
        elif isinstance(node, ast.withitem) and node.optional_vars is not None:
            self._assign(node.optional_vars, None)
        elif isinstance(node, ast.Delete):
            for target in node.targets:
                self._assign(target, None)
        elif isinstance(node, Named) and node.name:
            self._names[self.scope(node), node.name].append(Assigned(node, None))
        elif isinstance(node, ast.MatchMapping) and node.rest:
            self._names[self.scope(node), node.rest].append(Assigned(node, None))

    def _assign(self, target: ast.expr, value: ast.expr | None, part: bool = False) -> None:
        if isinstance(target, ast.Tuple | ast.List):
            pairs = value.elts if isinstance(value, ast.Tuple) and len(value.elts) == len(target.elts) else None
            for place, one in enumerate(target.elts):
                self._assign(one, value if pairs is None or part else pairs[place], part or pairs is None)
        elif isinstance(target, ast.Starred):
            self._assign(target.value, value, part=True)
        elif isinstance(target, ast.Name):
            self._names[self._owner(target), target.id].append(Assigned(target, value, part))
        elif isinstance(target, ast.Attribute):
            self._attributes[target.attr].append(Assigned(target, value, part))
        elif isinstance(target, ast.Subscript):
            self._assign(target.value, None)  # something in it becomes another

    def _owner(self, name: ast.Name) -> Scope:
        """The scope of a name that is assigned here."""
        scope = self.scope(name)
        if scope not in self._from_outside:
            self._from_outside[scope] = self._fetched(scope)
        return self._from_outside[scope].get(name.id, scope)

    def _fetched(self, scope: Scope) -> dict[str, Scope]:
        """What a function declares global or nonlocal, and where that is at home."""
        found: dict[str, Scope] = {}
        for node in self.own_nodes(scope):
            if isinstance(node, ast.Global):
                found |= dict.fromkeys(node.names, self.tree)
            elif isinstance(node, ast.Nonlocal):
                found |= {name: self._around(scope, name) for name in node.names}
        return found

    def _around(self, scope: Scope, name: str) -> Scope:
        """The function around this one in which a name is at home."""
        outer = self.scope(scope)
        while not isinstance(outer, ast.Module) and name not in self._local(outer):
            outer = self.scope(outer)
        return outer

    def _local(self, scope: Scope) -> set[str]:
        """Names that a function assigns, or takes."""
        stored = {n.id for n in self.own_nodes(scope) if isinstance(n, ast.Name) and not isinstance(n.ctx, ast.Load)}
        return stored | set(parameters(scope))

    def _is_passed_on(self, node: ast.Name | ast.Attribute) -> bool:
        if not isinstance(node.ctx, ast.Load):
            return False
        child, parent = node, self.parents.get(node)
        if isinstance(parent, ast.Call) and parent.func is node:
            return False
        inner: ast.AST = child
        while parent is not None and not isinstance(parent, ast.stmt | ast.arg):
            inner, parent = parent, self.parents.get(parent)
        annotations = (getattr(parent, "annotation", None), getattr(parent, "returns", None))
        return inner not in annotations

    # Kinds -----------------------------------------------------------------------

    def kind(self, node: ast.expr) -> Kind:
        """What an expression can depend on."""
        if node not in self._kinds:
            self._kinds[node] = Kind.OPEN  # while it is found out: what depends on itself is open
            self._kinds[node] = self._kind(node)
        return self._kinds[node]

    def _kind(self, node: ast.expr) -> Kind:
        if isinstance(node, ast.Constant):
            return Kind.FIXED
        if isinstance(node, ast.Name):
            return self._of_name(self.scope(node), node.id)
        if isinstance(node, ast.Attribute):
            return self._of_attribute(node)
        if isinstance(node, ast.Call):
            return self._of_call(node)
        if isinstance(node, ast.Compare) and all(isinstance(op, ast.Is | ast.IsNot) for op in node.ops):
            parts = {self.kind(part) for part in (node.left, *node.comparators)}
            return Kind.OPEN if parts & {Kind.OPEN, Kind.WAIT} else Kind.FIXED
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not) and self.kind(node.operand) is Kind.WAIT:
            return Kind.WAIT
        if isinstance(node, ast.List | ast.Dict | ast.Set):
            return Kind.OBJECT
        if isinstance(node, ast.Lambda | ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp | ast.Await):
            return Kind.OPEN
        return self._of_parts(node)

    def _of_parts(self, node: ast.expr) -> Kind:
        kinds = {self.kind(part) for part in ast.iter_child_nodes(node) if isinstance(part, ast.expr)}
        if kinds <= {Kind.FIXED}:
            return Kind.FIXED
        whole = isinstance(node, ast.BinOp | ast.Tuple) or (
            isinstance(node, ast.IfExp) and self.kind(node.test) is Kind.FIXED
        )
        return Kind.OBJECT if whole and kinds <= {Kind.FIXED, Kind.OBJECT, Kind.HANDLE} else Kind.OPEN

    def _of_name(self, scope: Scope, name: str) -> Kind:
        while True:
            assigned = self._names.get((scope, name), [])
            parameter = name in parameters(scope)
            if assigned or parameter:
                break
            if isinstance(scope, ast.Module):
                return Kind.FIXED if hasattr(builtins, name) or name.isupper() else Kind.OBJECT  # imported, a function
            scope = self.scope(scope)
        if len(assigned) + parameter > 1:
            return Kind.OPEN
        return self._of_parameter(scope, name) if parameter else self._of_assigned(assigned[0])

    def _of_assigned(self, one: Assigned) -> Kind:
        if one.value is None:
            return Kind.OPEN
        kind = self.kind(one.value)
        if one.part and kind is not Kind.FIXED:
            return Kind.OBJECT if kind is Kind.OBJECT and isinstance(one.value, ast.Call) else Kind.OPEN
        return kind

    def _of_parameter(self, scope: Scope, name: str) -> Kind:
        """What the only call of a function gives, or all of them in the same words."""
        if not isinstance(scope, Function):
            return Kind.OPEN
        place, owner = parameters(scope).index(name), self.parents.get(scope)
        method = isinstance(owner, ast.ClassDef)
        if isinstance(owner, ast.Module) and scope.name == "main" and place < 2:
            return (Kind.HANDLE, Kind.FIXED)[place]
        if method and not place:
            return Kind.OBJECT
        if any(
            isinstance(arg.annotation, ast.Name) and arg.annotation.id == DSP for arg in scope.args.args[place:][:1]
        ):
            return Kind.HANDLE
        made = isinstance(owner, ast.ClassDef) and scope.name == "__init__"
        callee = owner.name if isinstance(owner, ast.ClassDef) and made else scope.name
        if callee in self._passed_on or (not made and len(self.functions[callee]) > 1):
            return Kind.OPEN
        given = [_argument(call, name, place - method) for call in self._calls.get(callee, ())]
        if not given or any(one is None for one in given):
            return Kind.OPEN
        return (
            self.kind(given[0])
            if given[0] is not None and len({ast.dump(one) for one in given if one}) == 1
            else Kind.OPEN
        )

    def _of_attribute(self, node: ast.Attribute) -> Kind:
        stored = self._attributes.get(node.attr, [])
        if isinstance(node.value, ast.Name) and self._is_self(node.value):
            if node.attr in self.functions:
                return Kind.OPEN if any(f.decorator_list for f in self.functions[node.attr]) else Kind.OBJECT
            made_once = len(stored) == 1 and self._is_made_once(stored[0].target)
            return self._of_assigned(stored[0]) if made_once else Kind.OPEN
        elsewhere = [one for one in stored if not self._is_of_another_class(one.target)]
        return Kind.FIXED if self.kind(node.value) is Kind.FIXED and not elsewhere else Kind.OPEN

    def _is_self(self, name: ast.Name) -> bool:
        scope = self.scope(name)
        while isinstance(scope, ast.Lambda) and name.id not in parameters(scope):
            scope = self.scope(scope)
        in_class = isinstance(scope, Function) and isinstance(self.parents.get(scope), ast.ClassDef)
        return in_class and parameters(scope)[:1] == [name.id]

    def _is_made_once(self, target: ast.AST) -> bool:
        """True of `self.name = value` in a constructor."""
        own = isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name) and self._is_self(target.value)
        return own and self._runs_once(target)

    def _is_of_another_class(self, target: ast.AST) -> bool:
        """True of `self.name = value` in a class that is not the settings'."""
        if not (
            isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name) and self._is_self(target.value)
        ):
            return False
        owner = self.parents.get(self.scope(target))
        return isinstance(owner, ast.ClassDef) and owner.name != SETTINGS

    def _runs_once(self, node: ast.AST) -> bool:
        """True in a constructor, in `main` and in the module, outside of loops."""
        scope = self.scope(node)
        if isinstance(scope, ast.Lambda) or (isinstance(scope, Function) and scope.name not in ("__init__", "main")):
            return False
        parent = self.parents.get(node)
        while parent is not None and parent is not scope:
            if isinstance(parent, Loop | ast.While):
                return False
            parent = self.parents.get(parent)
        return True

    def _of_call(self, node: ast.Call) -> Kind:
        name = called(node)
        given = {self.kind(arg) for arg in (*node.args, *(key.value for key in node.keywords))}
        if isinstance(node.func, ast.Attribute):
            base = self.kind(node.func.value)
            if base is Kind.HANDLE:
                timed = any(key.arg == "timeout" for key in node.keywords)
                if name in WAITS:
                    return Kind.OPEN if timed else Kind.WAIT
                return {"module": Kind.HANDLE, "has": Kind.FIXED}.get(name, Kind.OPEN)
            return Kind.FIXED if base is Kind.FIXED and name in LOOKUPS and given <= {Kind.FIXED} else Kind.OPEN
        if vars(builtins).get(name) in PURE and name not in self.functions and given <= {Kind.FIXED}:
            return Kind.FIXED
        closed = given <= {Kind.FIXED, Kind.HANDLE, Kind.OBJECT}
        return Kind.OBJECT if closed and self._runs_once(node) else Kind.OPEN


@lru_cache(maxsize=64)
def _module(text: str) -> Module:
    return Module(ast.parse(text))


def called(node: ast.Call) -> str:
    """The last name of what is called; empty where no name says it."""
    func = node.func
    return func.id if isinstance(func, ast.Name) else func.attr if isinstance(func, ast.Attribute) else ""


def parameters(scope: Scope) -> list[str]:
    if isinstance(scope, ast.Module):
        return []
    of = scope.args
    return [arg.arg for arg in (*of.posonlyargs, *of.args, *of.kwonlyargs, *filter(None, (of.vararg, of.kwarg)))]


def _argument(call: ast.Call, name: str, place: int) -> ast.expr | None:
    """What a call gives for a parameter; None where its words do not say it."""
    if any(isinstance(arg, ast.Starred) for arg in call.args) or any(key.arg is None for key in call.keywords):
        return None
    given = next((key.value for key in call.keywords if key.arg == name), None)
    return given if given is not None or not 0 <= place < len(call.args) else call.args[place]
