"""C types of a package's modules, derived from the annotations in their sources.

A module is compiled if it has the line `# core: compiled`. A class in it is compiled if it has no decorator other than
`@final`, no keyword such as `metaclass`, and at most one base, which is compiled, too. An attribute has the type of its
annotation. Without an annotation, it has the type of the first assigned value whose type can be derived.

By default, Python and C can call a function (cpdef). Only C can call a private one (cdef). A function is private if it
is missing in the `__all__` of its module or, without `__all__`, if its name begins with an underscore. A method is
private if its name begins with an underscore and its module calls it only on `self`. A function stays a Python function
(def) if Cython cannot compile it as a C function. Methods and private functions also stay Python functions if they are
used as objects, for example as callbacks; so do methods whose names begin with two underscores.
`c_types` and the following comments express what ordinary annotations cannot:

    class Event:  # core: freelist 16                   keeps up to 16 deleted objects for reuse
    class Span:  # core: python                         stays a Python class
    def s16(value: int) -> int:  # core: noexcept       never raises an exception
    def nz16(self, value: int) -> None:  # core: C only     cannot be called from Python
    def listen(self) -> None:  # core: python           stays a Python function
"""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import cast

from .compiled_class import (
    BUFFERS,
    BUILTINS,
    CLASS_MARKS,
    INTEGER,
    NUMBERS,
    OBJECT,
    VOID,
    BadDeclaration,
    Class,
    Function,
    Type,
)
from .syntax import OPERATORS, is_typable, pairs, read_names, walked

HEADER = re.compile(r"^# core: (.*)$", re.MULTILINE)
COMPILED, UNCHECKED = "compiled", "compiled without checks for None"
MARKS = re.compile(r"# core: (.*)$")
FUNCTION_MARKS = re.compile(r"python|C only|noexcept")


class Sources(dict[str, "Source"]):
    """The modules of a package by name. Each module is read when it is first used."""

    def __init__(self, package: Path) -> None:
        super().__init__()
        self.package = package

    def __missing__(self, name: str) -> Source:
        path = self.package.joinpath(*name.split("."))
        path = path.with_suffix(".py") if path.with_suffix(".py").is_file() else path / "__init__.py"
        self[name] = source = Source(self, name, path.read_text("utf-8") if path.is_file() else "")
        return source

    def compiled(self) -> list[str]:
        """Return the names of all modules that are compiled."""
        names = (".".join(path.relative_to(self.package).with_suffix("").parts) for path in self.package.rglob("*.py"))
        return sorted(name for name in names if self[name].is_compiled)


class Source:
    """One module with its classes, functions and names. text: the source of the module."""

    def __init__(self, sources: Sources, name: str, text: str) -> None:
        self.sources, self.name, self.text = sources, name, text
        self.text_lines = text.split("\n")
        self.header = header_of(text)
        self.is_compiled = bool(self.header)
        if self.header not in ("", COMPILED, UNCHECKED):
            line = self.text_lines.index(f"# core: {self.header}") + 1
            expected = f"expected '# core: {COMPILED}' or '# core: {UNCHECKED}'"
            raise self.bad(line, f"'# core: {self.header}'; {expected}")

    def bad(self, line: int, what: str) -> BadDeclaration:
        return BadDeclaration(f"{self.name.replace('.', '/')}.py:{line}: {what}")

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.text)

    @cached_property
    def classes(self) -> dict[str, Class]:
        """The compiled classes of the module, by name."""
        found: dict[str, Class] = {}
        # The property is set before it is complete, because the base of a class may be in the same module.
        self.__dict__["classes"] = found
        for node in self.tree.body if self.is_compiled else ():
            if not isinstance(node, ast.ClassDef) or "python" in self.marks(node, CLASS_MARKS):
                continue
            decorated = any(ast.unparse(one) != "final" for one in node.decorator_list)
            if decorated or len(node.bases) > 1 or node.keywords:
                continue
            if not node.bases or self.find_class(ast.unparse(node.bases[0])) is not None:
                found[node.name] = Class(self, node)
        return found

    def marks(self, node: ast.ClassDef | ast.FunctionDef, known: re.Pattern[str]) -> list[str]:
        """Return the marks (`# core: ...`) of a class or function. Raise BadDeclaration for an unknown mark."""
        found: list[str] = []
        for row in range(node.lineno, max(node.body[0].lineno, node.lineno + 1)):
            mark = MARKS.search(self.text_lines[row - 1])
            found += mark[1].split(", ") if mark else []
        for one in found:
            if not known.fullmatch(one):
                raise self.bad(node.lineno, f"'# core: {one}' at {node.name}; expected {known.pattern}")
        return found

    @cached_property
    def imports(self) -> dict[str, tuple[str, str]]:
        """The names that this module imports from its own package, each with (source module, name there)."""
        found = {}
        for node in walked(self.tree):
            if isinstance(node, ast.ImportFrom) and node.level:
                place = self.name.split(".")[: -node.level]
                module = ".".join([*place, node.module] if node.module else place)
                found.update({alias.asname or alias.name: (module, alias.name) for alias in node.names})
        return found

    @cached_property
    def assigned(self) -> dict[str, ast.expr]:
        """The expressions that the module assigns, by the name to which each is assigned.

        If an expression is unpacked into several names, each of these names has the whole expression.
        """
        found: dict[str, ast.expr] = {}
        for node in self.tree.body:
            if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value:
                found[node.target.id] = node.value
            elif isinstance(node, ast.Assign):
                for name, value in pairs(node):
                    if isinstance(name, ast.Name):
                        found[name.id] = value or node.value
        return found

    def find_class(self, name: str) -> Class | None:
        """Return the compiled class that has this name in the module, defined or imported; None if there is none."""
        if name in self.classes:
            return self.classes[name]
        module, there = self.imports.get(name, ("", ""))
        return self.sources[module].find_class(there) if module else None

    # Types -------------------------------------------------------------------

    def type_of(self, node: ast.expr | None) -> Type:
        """Return the type of an annotation."""
        match node:
            case ast.Constant(value=None):
                return Type(VOID)
            case ast.Constant(value=str(text)):
                return self.type_of(ast.parse(text, mode="eval").body)
            case ast.BinOp(op=ast.BitOr()):
                sides = [one for one in (self.type_of(node.left), self.type_of(node.right)) if one.c != VOID]
                pointer = len(sides) == 1 and (sides[0].kind or sides[0].c in BUILTINS)
                return sides[0]._replace(optional=True) if pointer else Type(OBJECT)
            case ast.Name(id=name):
                return self._type_named(name)
            case ast.Subscript(value=ast.Name(id="Annotated"), slice=ast.Tuple(elts=[ast.Subscript() as of, length])):
                return Type(f"{self.type_of(of.slice).c}[{self.number(length)}]")
            case ast.Subscript(value=value, slice=of) if ast.unparse(value) in BUFFERS:
                number = self.type_of(ast.Name("int") if ast.unparse(of) == "np.int64" else of)
                return Type(f"{number.c}[::1]") if number.c in NUMBERS.values() else Type(OBJECT)
            case ast.Subscript(value=ast.Name(id=name)):
                return self._type_named(name)
        return Type(OBJECT)

    def _type_named(self, name: str) -> Type:
        if name in NUMBERS or name in BUILTINS:
            return Type(NUMBERS.get(name, name))
        if kind := self.find_class(name):
            return Type(kind.name, kind)
        if name in self.pointers:
            return Type(name)
        value = self.assigned.get(name)
        if isinstance(value, ast.Name | ast.Subscript):
            return self.type_of(value)
        module, there = self.imports.get(name, ("", ""))
        return self.sources[module]._type_named(there) if module and module != "form.c_types" else Type(OBJECT)

    @cached_property
    def pointers(self) -> dict[str, list[ast.expr]]:
        """The types of the arguments of each function pointer type, by the name of this type."""
        found = {}
        for name, value in self.assigned.items():
            if isinstance(value, ast.Subscript) and ast.unparse(value.value) == "CFunction":
                found[name] = cast("ast.List", cast("ast.Tuple", value.slice).elts[0]).elts
        return found

    def number(self, node: ast.expr) -> int:
        """Return the value of a constant expression. Raise BadDeclaration if the expression is not constant."""
        match node:
            case ast.Constant(value=int(value)):
                return value
            case ast.Name(id=name) if name in self.assigned:
                return self.number(self.assigned[name])
            case ast.Name(id=name) if name in self.imports:
                module, there = self.imports[name]
                return self.sources[module].number(ast.Name(there))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
                return OPERATORS[type(op)](self.number(left), self.number(right))
        raise self.bad(node.lineno, f"the length {ast.unparse(node)} of an array; expected a number")

    def type_of_value(self, value: ast.expr, within: Class | None, known: Mapping[str, ast.expr | None]) -> Type | None:
        """Return the type of an expression; None if it cannot be derived.

        within: the class that contains the expression, or None.
        known: the annotations of names that may occur in the expression, by name.
        """
        match value:
            case ast.Constant(value=bool() | int() | str() | bytes() as constant):
                return self._type_named(type(constant).__name__)
            case ast.List() | ast.ListComp():
                return Type("list")
            case ast.Dict() | ast.DictComp():
                return Type("dict")
            case ast.Set() | ast.SetComp():
                return Type("set")
            case ast.Tuple():
                return Type("tuple")
            case ast.Compare() | ast.UnaryOp(op=ast.Not()):
                return Type(NUMBERS["bool"])
            case ast.UnaryOp(operand=operand):
                return self.type_of_value(operand, within, known)
            case ast.BinOp(left=left, op=op, right=right) if not isinstance(op, ast.Div):
                sides = [self.type_of_value(one, within, known) for one in (left, right)]
                return Type(INTEGER) if all(one and one.c == INTEGER for one in sides) else None
            case ast.Name(id="self"):
                return Type(within.name, within) if within else None
            case ast.Name(id=name) if name in known:
                return self.type_of(known[name])
            case ast.Name(id=name) if name.isupper():
                return self.type_of_constant(name)
            case ast.Attribute(value=owner, attr=name):
                of = self.type_of_value(owner, within, known)
                return of.kind.member(name, called=False) if of and of.kind else None
            case ast.Call(func=ast.Attribute(value=owner, attr=name)):
                of = self.type_of_value(owner, within, known)
                return of.kind.member(name, called=True) if of and of.kind else None
            case ast.Call(func=ast.Name(id="len")):
                return Type(INTEGER)
            case ast.Call(func=ast.Name(id=name)) if name in NUMBERS or name in BUILTINS or self.find_class(name):
                return self._type_named(name)
        return None

    def type_of_constant(self, name: str) -> Type | None:
        """Return the type of a constant that the module assigns or imports; None if the type is unknown."""
        value = self.assigned.get(name)
        if value is not None:
            from_range = isinstance(value, ast.Call) and ast.unparse(value.func) == "range"
            return Type(INTEGER) if from_range else self.type_of_value(value, None, {})
        module, there = self.imports.get(name, ("", ""))
        return self.sources[module].type_of_constant(there) if module else None

    # Functions ---------------------------------------------------------------

    @cached_property
    def functions(self) -> dict[str, Function]:
        listed = self.assigned.get("__all__")
        public = None if listed is None else ast.literal_eval(listed)
        values = read_names(self.tree, "") - self.pointed_at
        found = {}
        for node in self.tree.body:
            if isinstance(node, ast.FunctionDef):
                seen = not node.name.startswith("_") if public is None else node.name in public
                kind = "cpdef" if seen else "def" if node.name in values else "cdef"
                found[node.name] = self.function(node, kind)
        return found

    @property
    def pointed_at(self) -> set[str]:
        """The names of functions that are assigned to an attribute whose type is a function pointer."""
        kinds = [kind for name in (*self.classes, *self.imports) if (kind := self.find_class(name))]
        pointers = {name for kind in kinds for name, one in kind.known.items() if one.c in kind.source.pointers}
        return {
            node.value.id
            for node in walked(self.tree)
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Name)
            if isinstance(node.targets[0], ast.Attribute) and node.targets[0].attr in pointers
        }

    @cached_property
    def called_on_others(self) -> set[str]:
        """The names of methods that the module calls on objects other than `self`.

        Such a method is cdef only if it has the mark `C only`.
        """
        calls = (node.func for node in walked(self.tree) if isinstance(node, ast.Call))
        return {one.attr for one in calls if isinstance(one, ast.Attribute) and ast.unparse(one.value) != "self"}

    @cached_property
    def cimported(self) -> dict[str, str]:
        """The imported C functions that this module calls and never uses as objects, each with its defining module."""
        found = {}
        calls = (node.func for node in walked(self.tree) if isinstance(node, ast.Call))
        called = {one.id for one in calls if isinstance(one, ast.Name)} - read_names(self.tree, "")
        for name, (module, there) in self.imports.items():
            other = self.sources[module].functions.get(name) if name == there and name in called else None
            if other and other.kind != "def" and self.sources[module].is_compiled:
                found[name] = module
        return found

    def function(self, node: ast.FunctionDef, kind: str, base: Function | None = None) -> Function:
        """Return the declaration of a function. If it overrides the method `base`, use the kind and types of `base`."""
        marks = self.marks(node, FUNCTION_MARKS)
        if "C only" in marks:
            kind = "cdef"
        if "python" in marks or not is_typable(node, kind):
            kind = "def"
        given = node.args.args
        defaults = [*[None] * (len(given) - len(node.args.defaults)), *node.args.defaults]
        arguments = {
            one.arg: (self._argument(one.annotation, default, kind), default is not None)
            for one, default in zip(given, defaults, strict=True)
            if one.arg != "self"
        }
        if base:
            if len(arguments) != len(base.arguments):
                raise self.bad(node.lineno, f"{node.name} takes other arguments than the method that it overrides")
            kind = base.kind if kind != "def" else kind
            arguments = dict(zip(arguments, base.arguments.values(), strict=True))
        variables = {
            one.target.id: self.type_of(one.annotation)
            for one in walked(node)
            if isinstance(one, ast.AnnAssign) and isinstance(one.target, ast.Name)
        }
        result = base.result if base else self.type_of(node.returns)
        if result.c.endswith("]"):  # C functions return buffers and arrays as Python objects
            result = Type(OBJECT)
        return Function(kind, result, arguments, variables, marks)

    def _argument(self, annotation: ast.expr | None, default: ast.expr | None, kind: str) -> Type:
        """Return the type of an argument, or `object` in place of a type for which Cython would reject None.

        The type is replaced if None is a valid value (`X | None`), Python can call the function, and the default is not
        None. In a call from Python, Cython accepts None only for arguments of the type `object` and for arguments whose
        default is None. In calls from C, Cython does not check for None.
        """
        found = self.type_of(annotation)
        takes_none = kind == "cdef" or (isinstance(default, ast.Constant) and default.value is None)
        return Type(OBJECT) if found.optional and not takes_none else found


def header_of(text: str) -> str:
    """Return the text after `# core:` in a source's header line, such as "compiled"; "" if there is no such line."""
    found = HEADER.search(text)
    return found[1] if found else ""
