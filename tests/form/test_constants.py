"""Integers become literals, and members of enumerations global names; lines stay where they are."""

from __future__ import annotations

import ast
from enum import Enum

from periph_sim.core import chip
from periph_sim.form.constants import declared, with_constants

SOURCE = """\
WORD = 16

class Box:
    __slots__ = ("level",)
    level: int

    def f(self, x):
        return x | WORD if x > at.NO_CHANGE else LOW
"""


def test_constants_stand_in_their_places():
    text = with_constants(SOURCE, {"WORD": 16, "LOW": -3, "at": chip})
    assert text.splitlines()[-1] == f"        return x | 16 if x > {chip.NO_CHANGE} else (-3)"
    assert len(text.splitlines()) == len(SOURCE.splitlines())


def test_what_is_no_whole_number_stays():
    text = with_constants(SOURCE, {"WORD": True, "LOW": "low", "at": chip})
    assert text.splitlines()[-1] == f"        return x | WORD if x > {chip.NO_CHANGE} else LOW"


def test_a_wide_constant_is_declared_as_wide_as_it_is():
    text = with_constants(SOURCE, {"WORD": 1 << 62})
    assert f"PERIPH_SIM_{1 << 62}" in text
    assert f"const long long PERIPH_SIM_{1 << 62}" in declared(text, "")
    beyond = with_constants(SOURCE, {"WORD": 1 << 63, "LOW": 1 << 88})
    assert "WORD" in beyond and "LOW" in beyond and "PERIPH_SIM" not in beyond
    assert declared("x = 1", "cdef class Box: pass") == "cdef class Box: pass"


class Kind(Enum):
    EDGE = "edge"
    FLAG = "flag"


MEMBERS = """\
from .records import (
    Kind,
    Record,
)

class Own(Kind):
    µ = Kind.EDGE; also = Kind.FLAG

def told(kind):
    return kind is Kind.FLAG or Kind.FLAG.value == Kind.names or Own.EDGE or other.Kind.EDGE
"""


def test_a_member_is_bound_where_its_class_is_imported():
    lines = with_constants(MEMBERS, {"Kind": Kind, "Own": Kind}).split("\n")
    assert lines[3].startswith(")") and sorted(lines[3].split("; ")[1:]) == [
        "Kind_EDGE = Kind.EDGE",
        "Kind_FLAG = Kind.FLAG",
    ]
    assert lines[6] == "    µ = Kind_EDGE; also = Kind_FLAG"
    # what is no member, a class of this very module and a class of another stay
    said = "    return kind is Kind_FLAG or Kind_FLAG.value == Kind.names or Own.EDGE or other.Kind.EDGE"
    assert lines[9] == said
    assert len(lines) == len(MEMBERS.split("\n"))
    ast.parse("\n".join(lines))


def test_what_is_no_enumeration_stays():
    assert with_constants(MEMBERS, {"Kind": object()}) == MEMBERS
