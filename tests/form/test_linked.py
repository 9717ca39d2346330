"""Chains of objects are released in a loop: in a thread whose stack is small, in the form of the core that runs."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.form.linked import CHAINS, NO_CHAINS, links

RELEASE = """
import sys, threading
from importlib import import_module

module, name, attribute, length = *sys.argv[1:4], int(sys.argv[4])
kind = getattr(import_module(f"periph_sim.{module}"), name)

def chain():
    first = None
    for _ in range(length):
        one = kind.__new__(kind)
        setattr(one, attribute, first)
        first = one
    return first

def release(held):
    held.pop()
    print("released")

held = [chain()]
threading.stack_size(256 * 1024)
thread = threading.Thread(target=release, args=(held,))
thread.start()
thread.join()
"""


def test_each_typed_attribute_that_links_objects_of_one_kind_is_named():
    assert links() == CHAINS | NO_CHAINS.keys()


def release(link: tuple[str, str, str], length: int) -> None:
    done = subprocess.run(
        [sys.executable, "-c", RELEASE, *link, str(length)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "released\n", "")


@pytest.mark.parametrize("link", [("core.kernel", "Event", "following"), ("timing.measures.pair", "Open", "following")])
def test_a_chain_of_20_000_is_released_in_256_kilobytes_of_stack(link: tuple[str, str, str]):
    release(link, 20_000)


@pytest.mark.long
@pytest.mark.parametrize("link", sorted(CHAINS), ids=".".join)
def test_a_chain_of_a_million_is_released_in_256_kilobytes_of_stack(link: tuple[str, str, str]):
    release(link, 1_000_000)
