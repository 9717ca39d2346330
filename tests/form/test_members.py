"""Members of enumerations get names of their own where a compiled module would look them up; lines stay."""

from __future__ import annotations

import ast
from enum import Enum

from periph_sim.form.members import with_members_bound


class Kind(Enum):
    EDGE = "edge"
    FLAG = "flag"


SOURCE = """\
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
    lines = with_members_bound(SOURCE, {"Kind": Kind, "Own": Kind}).split("\n")
    assert lines[3].startswith(")") and sorted(lines[3].split("; ")[1:]) == [
        "Kind_EDGE = Kind.EDGE",
        "Kind_FLAG = Kind.FLAG",
    ]
    assert lines[6] == "    µ = Kind_EDGE; also = Kind_FLAG"
    # what is no member, a class of this very module and a class of another stay
    said = "    return kind is Kind_FLAG or Kind_FLAG.value == Kind.names or Own.EDGE or other.Kind.EDGE"
    assert lines[9] == said
    assert len(lines) == len(SOURCE.split("\n"))
    ast.parse("\n".join(lines))


def test_what_is_no_enumeration_stays():
    assert with_members_bound(SOURCE, {"Kind": object()}) == SOURCE
