"""Types by hand, as DWARF declares them, and what a path into each comes to."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import pytest

from periph_sim.processor.image_files.number_types import BadVariable, inside, members_of, number_type


class Value(NamedTuple):
    value: Any


class Entry:
    """An entry of debug data, as pyelftools gives it. attributes: without DW_AT_; `type` is another entry."""

    def __init__(self, tag: str, *children: Entry, **attributes: Any) -> None:
        self.tag = tag if tag.startswith("DW_TAG_lo_user") else f"DW_TAG_{tag}"
        self.attributes = {f"DW_AT_{name}": Value(value) for name, value in attributes.items()}
        self._children = children

    def get_DIE_from_attribute(self, name: str) -> Entry:
        found = self.attributes[name].value
        assert isinstance(found, Entry)
        return found

    def iter_children(self) -> Iterator[Entry]:
        return iter(self._children)


def base(words: int, encoding: int) -> Entry:
    return Entry("base_type", byte_size=words, encoding=encoding)


def array(kind: Entry, *sizes: int, counted: bool = False) -> Entry:
    ranges = [Entry("subrange_type", **({"count": n} if counted else {"upper_bound": n - 1})) for n in sizes]
    return Entry("array_type", *ranges, type=kind)


def member(name: str, kind: Entry, place: Any = None, **more: Any) -> Entry:
    at = {} if place is None else {"data_member_location": place}
    return Entry("member", name=name.encode(), type=kind, **at, **more)


INT, UNSIGNED, LONG, CHAR, FLOAT, BOOL = base(1, 5), base(1, 7), base(2, 5), base(1, 6), base(2, 4), base(1, 2)
WIDE = base(4, 5)
POINTER = Entry("pointer_type", type=INT)
LOOP = Entry("typedef")
LOOP.attributes["DW_AT_type"] = Value(LOOP)


def named(kind: Entry, times: int) -> Entry:
    for _ in range(times):
        kind = Entry("typedef", type=kind)
    return kind


@pytest.mark.parametrize(
    ("kind", "number"),
    [
        (INT, (1, "signed")), (CHAR, (1, "signed")), (UNSIGNED, (1, "unsigned")), (BOOL, (1, "unsigned")),
        (LONG, (2, "signed")), (FLOAT, (2, "float")), (WIDE, None), (base(0, 5), None), (base(3, 5), None),
        (POINTER, (2, "unsigned")), (Entry("pointer_type", byte_size=1), (1, "unsigned")),
        (Entry("enumeration_type"), (2, "unsigned")), (Entry("enumeration_type", byte_size=1), (1, "unsigned")),
        (array(INT, 1), None), (Entry("structure_type", byte_size=1), None),
        (Entry("volatile_type", type=Entry("const_type", type=Entry("DW_TAG_lo_user", type=LONG))), (2, "signed")),
        (named(INT, 63), (1, "signed")), (named(INT, 64), None), (LOOP, None), (Entry("const_type"), None),
    ],
)  # fmt: skip
def test_types_that_are_one_number(kind: Any, number: tuple[int, str] | None):
    assert number_type(kind) == number


POINT = Entry("structure_type", member("x", INT, 0), member("y", LONG, [0x23, 2]), byte_size=4)
UNION = Entry("union_type", member("all", UNSIGNED), member("far", INT, [0x23, 0x83, 0x02]), byte_size=1)
WHOLE = Entry(
    "class_type",
    member("points", named(array(POINT, 3), 1), 1),
    member("grid", array(array(INT, 5), 2, 3), 0x20),
    member("either", UNION, 0x40),
    member("open", array(INT), 0x50),
    member("unknown", Entry("array_type", Entry("subrange_type"), type=INT), 0x58),
    member("counted", array(POINTER, 2, 4, counted=True), 0x60),
    member("computed", INT, [0x22]),
    member("empty", INT, []),
    member("bits", INT, 0x70, bit_size=3),
    Entry("member", type=INT),  # without a name
    Entry("subprogram", name=b"method", type=INT),
    byte_size=0x80,
)


@pytest.mark.parametrize(
    ("path", "offset", "kind"),
    [
        ("", 0, WHOLE), (".points[0].x", 1, INT), (".points[2].y", 1 + 2 * 4 + 2, LONG), (".points[1]", 5, POINT),
        (".grid[0][0][0]", 0x20, INT), (".grid[1][2][4]", 0x20 + 15 + 10 + 4, INT), (".grid[1][1]", 0x34, None),
        (".either.all", 0x40, UNSIGNED), (".either.far", 0x40 + 0x103, INT), (".counted[1][3]", 0x60 + 14, POINTER),
    ],
)  # fmt: skip
def test_a_part_has_its_offset_and_type(path: str, offset: int, kind: Any):
    found, inner = inside(WHOLE, "v", path)
    assert found == offset and (kind is None or inner is kind)


@pytest.mark.parametrize(
    ("path", "sentence"),
    [
        (".points[3]", "'v.points[3]': v.points has 3 elements, from 0 on"),
        (".grid[0][3]", "'v.grid[0][3]': v.grid[0] has 3 elements, from 0 on"),
        (".grid[0][0][5]", "'v.grid[0][0][5]': v.grid[0][0] has 5 elements, from 0 on"),
        (".open[0]", "'v.open[0]': v.open has an unknown number of elements"),
        (".unknown[0]", "'v.unknown[0]': v.unknown has an unknown number of elements"),
        (".counted[2]", "'v.counted[2]': v.counted has 2 elements, from 0 on"),
        (".either[0]", "v.either is not an array, so it has no element [0]"),
        (".points.x", "v.points has no members, so none is called 'x'"),
        (".pionts", "v has no member 'pionts'; did you mean points or bits?"),
        (".method", "v has no member 'method'; "),
        (".computed", "v.computed: the debug data give its offset as an expression; use its address"),
        (".empty", "v.empty: the debug data give its offset as an expression; use its address"),
        (".bits", "v.bits is a bit-field; give the address of its word, for example 0x9042"),
        (".points[1]x", "'v.points[1]x': 'x' is neither a member, .NAME, nor an element, [NUMBER]"),
    ],
)
def test_what_is_no_part_is_refused(path: str, sentence: str):
    with pytest.raises(BadVariable) as refused:
        inside(WHOLE, "v", path)
    assert str(refused.value).startswith(sentence)


def test_nothing_is_inside_void_and_what_leads_round_in_a_circle():
    for kind in (LOOP, Entry("const_type")):
        for path, what in ((".x", "members"), ("[0]", "array")):
            with pytest.raises(BadVariable, match=what):
                inside(kind, "v", path)


def test_members_of_a_type():
    shown: Any = WHOLE
    assert members_of(shown) == ["points", "grid", "either", "open", "unknown", "counted", "computed", "empty", "bits"]
    for kind in (INT, LOOP, array(POINT, 3)):
        other: Any = kind
        assert members_of(other) == []


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        (POINTER, 2),
        (Entry("const_type"), 0),
        (WIDE, 4),
        (array(INT, 2, 3), 6),
        (Entry("array_type", Entry("subrange_type"), type=LONG), 2),
    ],
)
def test_elements_lie_as_far_apart_as_their_type_is_long(kind: Any, words: int):
    found, _ = inside(array(kind, 9), "v", "[5]")
    assert found == 5 * words
