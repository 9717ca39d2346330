"""Typed attributes that link objects of one kind, and how each chain of them is released.

A chain that is released by recursion overflows the C stack once it is long enough. Every class of the build has the
directive `trashcan`, with which a chain of any length is released in a loop; the build verifies that it reached C. A
new link makes tests/form/test_linked.py fail until it is named here, as a chain or with the reason why it is none.
"""

from __future__ import annotations

from periph_sim.form.compiled_class import OBJECT
from tests.form.package import classes

CHAINS = {
    ("core.chip_input", "Input", "following"),
    ("core.event_queue", "Event", "following"),
    ("core.agent", "SampledParty", "following"),
    ("core.agent", "Settleable", "following"),
    ("core.agent", "Settleable", "then"),
    ("core.records", "_ListenerEntry", "following"),
    ("core.records", "_SinkEntry", "following"),
    ("core.wire", "PullWatch", "following"),
    ("core.wire", "_Watch", "following"),
    ("processor.c28x.execution.cpu", "Operation", "following"),
    ("processor.c28x.execution.cpu", "Operation", "goal"),
    ("processor.bus", "Posted", "following"),
    ("processor.python.code_records", "Waited", "following"),
    ("timing.budgets", "BudgetJudge", "same_as"),
    ("timing.measures.event_pairing", "ValueTest", "others"),
    ("timing.measures.modifies", "Access", "after"),
    ("timing.measures.modifies", "Access", "before"),
}
NO_CHAINS = {
    ("timing.measures.event", "Jitter", "of"): "one for each `jitter of` in a sentence",
    ("processor.python.port_fields", "Port", "_half"): "a half has no half",
}


def links() -> set[tuple[str, str, str]]:
    """Module, class and attribute where an attribute may hold an object that has this attribute, too."""
    return {
        (owner.source.name, owner.name, name)
        for owner in classes()
        for name, kind in owner.attributes.items()
        if kind.kind and (kind.kind in (owner, *owner.bases) or owner in kind.kind.bases)
    }


def untyped() -> dict[tuple[str, str], str]:
    """An attribute that holds any object, of each class that has one, by module and class."""
    found: dict[tuple[str, str], str] = {}
    for owner in classes():
        if any("__setattr__" in one.defined for one in (owner, *owner.bases)):  # it takes values of registers
            continue
        for name, kind in owner.attributes.items():
            if kind.c == OBJECT and not name.startswith("__"):
                found.setdefault((owner.source.name, owner.name), name)
    return found
