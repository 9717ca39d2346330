"""Typed attributes that link objects of one kind, read from the .pxd files, and how each chain of them is released.

A chain that is released by recursion overflows the C stack once it is long enough. Every class of the build has the
directive `trashcan`, with which a chain of any length is released in a loop; the build verifies that it reached C. A
new link makes tests/form/test_linked.py fail until it is named here, as a chain or with the reason why it is none.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from periph_sim.form import PACKAGE

CLASS = re.compile(r"^cdef class (\w+)(?:\((\w+)\))?:")
ANY = re.compile(r"^    cdef public object (.+)$", re.MULTILINE)
ATTRIBUTE = re.compile(r"^    cdef (?:public |readonly )?(\w+) ([\w, ]+)$")

CHAINS = {
    ("core.chip_input", "Input", "following"),
    ("core.kernel", "Event", "following"),
    ("core.kernel", "Samples", "following"),
    ("core.kernel", "Settles", "following"),
    ("core.kernel", "Settles", "then"),
    ("core.records", "_KeeperEntry", "following"),
    ("core.records", "_ListenerEntry", "following"),
    ("core.wire", "PullWatch", "following"),
    ("core.wire", "_Watch", "following"),
    ("c28x.execution.registers", "Operation", "following"),
    ("c28x.execution.registers", "Operation", "goal"),
    ("processor.bus", "Posted", "following"),
    ("processor.python.code_records", "Waited", "following"),
    ("timing.budgets", "BudgetJudge", "same_as"),
    ("timing.measures.event_pairing", "ValueTest", "others"),
    ("timing.measures.modifies", "Access", "after"),
    ("timing.measures.modifies", "Access", "before"),
    ("timing.measures.modifies", "Look", "following"),
    ("timing.measures.pair", "Open", "following"),
}
NO_CHAINS = {
    ("core.shortcuts", "Shortcuts", "_first"): "a kernel has one `Shortcuts`, which never begins itself",
    ("processor.python.port_fields", "Port", "_half"): "a half has no half",
}


def links() -> set[tuple[str, str, str]]:
    """Module, class and attribute where an attribute may hold an object that has this attribute, too."""
    bases: dict[tuple[str, str], tuple[str, str] | None] = {}
    attributes: list[tuple[tuple[str, str], tuple[str, str], str]] = []
    for path in PACKAGE.rglob("*.pxd"):
        for owner, base, kind, name in _declared(path):
            if kind is None:
                bases[owner] = base
            else:
                attributes.append((owner, kind, name))

    def lineage(one: tuple[str, str] | None) -> Iterator[tuple[str, str]]:
        while one is not None:
            yield one
            one = bases.get(one)

    return {
        (*owner, name) for owner, kind, name in attributes if kind in lineage(owner) or owner in lineage(kind)
    }  # fmt: skip


def untyped() -> dict[tuple[str, str], str]:
    """An attribute that holds any object, of each class that has one, by module and class."""
    found: dict[tuple[str, str], str] = {}
    for path in PACKAGE.rglob("*.pxd"):
        settable = ", ".join(ANY.findall(path.read_text("utf-8")))
        for owner, _, kind, name in _declared(path):
            if kind is not None and kind[1] == "object" and name in settable.split(", "):
                found.setdefault(owner, name)
    return found


Place = tuple[str, str]


def _declared(path: Path) -> Iterator[tuple[Place, Place | None, Place | None, str]]:
    """Each class with its base, and each of its attributes with its type."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    module, home, owner = ".".join(parts), {}, None
    for line in path.read_text("utf-8").split("\n"):
        if imported := re.match(r"from (\.+)([\w.]*) cimport (.+)", line):
            room = ".".join([*parts[: -len(imported[1])], *([imported[2]] if imported[2] else [])])
            home.update({name.strip(): room for name in imported[3].split(",")})
        elif found := CLASS.match(line):
            owner = (module, found[1])
            yield owner, (home.get(found[2], module), found[2]) if found[2] else None, None, ""
        elif owner and (found := ATTRIBUTE.match(line)):
            for name in found[2].split(","):
                yield owner, None, (home.get(found[1], module), found[1]), name.split()[-1]
