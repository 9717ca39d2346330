"""C functions are neither imported nor looked up as objects; lines stay where they are."""

from __future__ import annotations

import pytest

from periph_sim.form.functions import by_name, cimported, without_imports

PXD = """\
from .registers cimport Cpu, half, whole

cdef void ADD(Cpu cpu)
cdef void SUB(Cpu cpu)
cdef long long helper(Cpu cpu)
cpdef void bind(Cpu cpu, str name)
"""
SOURCE = """\
from .registers import (
    SIZE,
    Cpu,
    half,
)
from .registers import whole

def helper(cpu): return half(cpu) + SIZE

def bind(cpu, name):
    cpu.does = globals()[name]
"""


def test_what_is_cimported_is_not_imported():
    text = without_imports(SOURCE, cimported(PXD))
    assert text.splitlines()[0] == "from .registers import SIZE, Cpu"
    assert "whole" not in text and len(text.splitlines()) == len(SOURCE.splitlines())
    assert text.splitlines().index("def helper(cpu): return half(cpu) + SIZE") == 7


def test_a_look_up_by_name_is_spelled_out():
    names = {"KeyError": KeyError, "ADD": 1, "SUB": 2, "__builtins__": {}}
    text = by_name(SOURCE, PXD).split("\n\n")[-1]
    exec(text, names)

    class Box:
        does = 0

    box = Box()
    names["bind"](box, "SUB")
    assert box.does == 2
    with pytest.raises(KeyError, match="helper"):
        names["bind"](box, "helper")


def test_a_source_without_a_look_up_stays():
    assert by_name("x = 1\n", PXD) == "x = 1\n"
