"""Chains of objects are released in a loop, without recursion: tested in threads with a small stack.

A chain that is released by recursion overflows the C stack once it is long enough. Every class of the build has the
directive `trashcan`, with which a chain of any length is released in a loop; the build verifies that it has an effect
in the C code. An attribute that links objects of one class must be listed in CHAINS, or in NO_CHAINS with the reason
why it forms no chain; otherwise a test fails.
"""

from __future__ import annotations

import subprocess
import sys

import pytest

from periph_sim.form.compiled_class import OBJECT
from tests.form.package import classes

CHAINS = {
    ("core.flag_recorder", "Input", "following"),
    ("core.agent", "Event", "following"),
    ("core.agent", "SampledParty", "following"),
    ("core.agent", "Settleable", "following"),
    ("core.agent", "Settleable", "then"),
    ("core.records", "_Entry", "following"),
    ("core.wire", "PullWatch", "following"),
    ("core.wire", "_Watch", "following"),
    ("processor.c28x.execution.cpu", "Operation", "following"),
    ("processor.c28x.execution.cpu", "Operation", "goal"),
    ("processor.bus", "Posted", "following"),
    ("timing.budgets", "BudgetJudge", "same_as"),
    ("timing.measures.event", "ValueTest", "others"),
    ("timing.measures.modifies", "Access", "after"),
    ("timing.measures.modifies", "Access", "before"),
}
NO_CHAINS = {
    ("processor.python.register_view", "Port", "_half"): "a half has no half",
}


def links() -> set[tuple[str, str, str]]:
    """Return the module, class and name of each attribute whose value may be an object that also has this attribute."""
    return {
        (owner.source.name, owner.name, name)
        for owner in classes()
        for name, kind in owner.attributes.items()
        if kind.kind and (kind.kind in (owner, *owner.bases) or owner in kind.kind.bases)
    }


def untyped() -> dict[tuple[str, str], str]:
    """Return, by module and class, one attribute of each class whose type is any object."""
    found: dict[tuple[str, str], str] = {}
    for owner in classes():
        if any("__setattr__" in one.defined for one in (owner, *owner.bases)):  # setting an attribute writes a register
            continue
        for name, kind in owner.attributes.items():
            if kind.c == OBJECT and not name.startswith("__"):
                found.setdefault((owner.source.name, owner.name), name)
    return found


RELEASE = """
import gc, sys, threading
from importlib import import_module
from itertools import repeat

gc.disable()  # because collecting garbage would take longer than making the chain
length = int(sys.argv[1])

def chain(module, name, attribute):
    kind = getattr(import_module(f"periph_sim.{module}"), name)
    first = None
    for one in map(kind.__new__, repeat(kind, length)):
        setattr(one, attribute, first)
        first = one
    return first

threading.stack_size(int(sys.argv[2]) * 1024)
for link in sys.argv[3:]:
    held = [chain(*link.split(":"))]
    thread = threading.Thread(target=held.clear)
    thread.start()
    thread.join()
    print(link, flush=True)
"""


def test_each_typed_attribute_that_links_objects_of_one_kind_is_named():
    assert links() == CHAINS | NO_CHAINS.keys()


def release(length: int, *links: tuple[str, str, str], kilobytes: int = 256) -> None:
    texts = [":".join(link) for link in links]
    command = [sys.executable, "-c", RELEASE, str(length), str(kilobytes), *texts]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.splitlines(), done.stderr) == (0, texts, "")


@pytest.mark.parametrize(
    "link", [("core.agent", "Event", "following"), ("timing.measures.modifies", "Access", "after")]
)
def test_a_chain_of_20_000_is_released_in_256_kilobytes_of_stack(link: tuple[str, str, str]):
    release(20_000, link)


@pytest.mark.long
def test_each_chain_of_100_000_is_released_in_256_kilobytes_of_stack():
    """If one overflows the stack, the output ends with the link before it."""
    release(100_000, *sorted(CHAINS))


def test_a_chain_through_attributes_that_hold_any_object_is_released_as_well():
    links = [(*owner, attribute) for owner, attribute in sorted(untyped().items())]
    assert len(links) > 30
    release(5_000, *links, kilobytes=64)  # as much stack per link as in the tests above
