"""A class that a .pxd file types has a line there for each attribute; interpreted, none would be missed."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from periph_sim.form import PACKAGE

CLASS = re.compile(r"^cdef class (\w+)(?:\(([\w.]+)\))?:\n((?:(?: .*)?\n)*)", re.MULTILINE)
ATTRIBUTES = re.compile(r"^    cdef (?:public |readonly )?[\w. ]*?\b(\w[^()]*)$", re.MULTILINE)
OPEN = "__dict__"
Classes = dict[str, tuple[str, set[str]]]


def typed(path: Path) -> Classes:
    """The classes of a .pxd file: each one's base, and the names that are declared for it."""
    found: Classes = {}
    for name, base, body in CLASS.findall(f"{path.read_text('utf-8')}\n"):
        declared = {one for line in ATTRIBUTES.findall(body) for one in re.findall(r"\b[A-Za-z_]\w*", line)}
        found[name] = base, declared
    return found


def assigned(path: Path) -> Iterator[tuple[str, str]]:
    """(class, attribute) for each `self.attribute = ...` in a source."""
    for one in ast.parse(path.read_text("utf-8")).body:
        if isinstance(one, ast.ClassDef):
            for node in ast.walk(one):
                stored = isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)
                if stored and isinstance(node.value, ast.Name) and node.value.id == "self":
                    yield one.name, node.attr


def known(name: str, own: Classes, others: Classes) -> set[str]:
    """What is declared for a class and its bases."""
    base, declared = own[name] if name in own else others.get(name, ("", set()))
    return declared | known(base, {}, own | others) if base else declared


def test_each_attribute_has_its_line():
    files = {path: typed(path) for path in PACKAGE.rglob("*.pxd")}
    every = {name: one for classes in files.values() for name, one in classes.items()}
    missing = set()
    for path, classes in files.items():
        for name, attribute in assigned(path.with_suffix(".py")):
            if name in classes and not known(name, classes, every) & {attribute, OPEN}:
                missing.add(f"{path.relative_to(PACKAGE)}: {name}.{attribute}")
    assert sorted(missing) == []
