"""The hard build ends a process at a fault of each kind; the same call without the fault succeeds."""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path
from shutil import which
from types import SimpleNamespace

import pytest

from periph_sim.form import INTERPRETED, PACKAGE, VARIABLE, build
from periph_sim.form.sources import UNCHECKED
from tests import hard
from tests.form.package import written

pytestmark = [
    pytest.mark.long,  # a build with sanitizers
    pytest.mark.skipif(find_spec("Cython") is None or which("cc") is None, reason="Cython or a C compiler is missing"),
]

SOURCE = """
# core: compiled
class Node:
    row: "Annotated[list[int], 4]"
    def __init__(self):
        self.value = 1
        self.row = [0] * 4

class Holder:
    def __init__(self, node: Node):
        self.node = node

class Faults:
    def product(self, a, b):
        return a * b
    def shifted(self, a, b):
        return a << b
    def value(self, holder):
        return holder.node.value
    def element(self, node, at):
        return node.row[at]
    def freed(self, at):
        return raw(at)
"""
TYPES = """cimport cython

cdef extern from *:
    '''
    #include <stdlib.h>
    static int raw(int at) {
      int *room = (int *)malloc(4 * sizeof(int)), found;
      for (int i = 0; i < 4; i++) room[i] = i;
      found = room[at];
      free(room);
      return found;
    }
    '''
    int raw(int at)

cdef class Node:
    cdef public long long value
    cdef long long[4] row

cdef class Holder:
    cdef public Node node

cdef class Faults:
    cpdef long long product(self, long long a, long long b)
    cpdef int shifted(self, int a, int b)
    cpdef long long value(self, Holder holder)
    cpdef long long element(self, Node node, long long at)
    cpdef int freed(self, int at)
"""
CALL = """
import sys
from pathlib import Path
from periph_sim import form
folder = Path(sys.argv[1])
sys.path.insert(0, sys.argv[1])
sys.path_hooks.insert(0, form.finders(folder / "planted", folder / "built", ["faults"]))
sys.path_importer_cache.clear()
from planted.faults import Faults, Holder, Node
faults, node = Faults(), Node()
print(eval(sys.argv[2]), flush=True)
print(eval(sys.argv[3]), flush=True)
"""
PLANTED = {
    "overflow": ("faults.product(1 << 31, 1 << 31)", "faults.product(1 << 32, 1 << 31)", "OverflowError"),
    "undefined shift": (
        "faults.shifted(1, 3)",
        "faults.shifted(1, 40)",
        "OverflowError|shift exponent",
    ),
    "None as an argument": ("faults.element(node, 0)", "faults.element(None, 0)", "TypeError"),
    "None in an attribute": ("faults.value(Holder(node))", "faults.value(Holder(None))", "AttributeError"),
    "index": (
        "faults.element(node, 3)",
        "faults.element(node, 4)",
        "index 4 is outside of the C array row|out of bounds",
    ),
    "address": ("faults.freed(3)", "faults.freed(4)", "insufficient space for an object|heap-buffer-overflow"),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("hard")
    planted = written(made, "planted", faults=SOURCE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            build, "declarations", lambda source: SimpleNamespace(text=TYPES)
        )  # because TYPES also contains a C function
        patch.syspath_prepend(made)
        build.build(planted, made / "built", 1, build.HARD)
    return made


@pytest.mark.parametrize("fault", PLANTED)
def test_a_planted_fault_ends_the_process(folder: Path, fault: str):
    right, wrong, said = PLANTED[fault]
    for second, ends in ((right, False), (wrong, True)):
        own = {"PYTHONPATH": str(PACKAGE.parent), VARIABLE: INTERPRETED}  # only the planted module is compiled
        done = hard.run_hard(["-c", CALL, str(folder), right, second], own)
        assert done.stdout.count("\n") == 1 + (not ends), done.stderr
        assert (done.returncode != 0) is ends
        assert not ends or re.search(said, done.stderr), done.stderr


def test_flags_that_hide_faults_are_left_out():
    assert not {"-fwrapv", "-DNDEBUG", "-w"} & {*build.HARD.flags}
    assert {"-fwrapv", "-DNDEBUG", "-w"} <= {*build.NORMAL.flags}
    unchecked = f"# core: {UNCHECKED}"
    assert build.directives(unchecked, build.HARD)["nonecheck"] and not build.directives(unchecked)["nonecheck"]
