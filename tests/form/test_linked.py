"""Chains of objects are released in a loop: in a thread whose stack is small, in the form of the core that runs."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.form.linked import CHAINS, NO_CHAINS, links, untyped

RELEASE = """
import gc, sys, threading
from importlib import import_module
from itertools import repeat

gc.disable()  # to look through the chain for garbage takes longer than to make it
length = int(sys.argv[1])

def chain(module, name, attribute):
    kind = getattr(import_module(f"periph_sim.{module}"), name)
    first = None
    for one in map(kind.__new__, repeat(kind, length)):
        setattr(one, attribute, first)
        first = one
    return first

threading.stack_size(256 * 1024)
for link in sys.argv[2:]:
    held = [chain(*link.split(":"))]
    thread = threading.Thread(target=held.clear)
    thread.start()
    thread.join()
    print(link, flush=True)
"""


def test_each_typed_attribute_that_links_objects_of_one_kind_is_named():
    assert links() == CHAINS | NO_CHAINS.keys()


def release(length: int, *links: tuple[str, str, str]) -> None:
    texts = [":".join(link) for link in links]
    command = [sys.executable, "-c", RELEASE, str(length), *texts]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.splitlines(), done.stderr) == (0, texts, "")


@pytest.mark.parametrize(
    "link", [("core.event_queue", "Event", "following"), ("timing.measures.modifies", "Access", "after")]
)
def test_a_chain_of_20_000_is_released_in_256_kilobytes_of_stack(link: tuple[str, str, str]):
    release(20_000, link)


@pytest.mark.long
@pytest.mark.parametrize("link", sorted(CHAINS), ids=".".join)
def test_a_chain_of_a_million_is_released_in_256_kilobytes_of_stack(link: tuple[str, str, str]):
    release(1_000_000, link)


def test_a_chain_through_attributes_that_hold_any_object_is_released_as_well():
    links = [(*owner, attribute) for owner, attribute in sorted(untyped().items())]
    assert len(links) > 30
    release(20_000, *links)
