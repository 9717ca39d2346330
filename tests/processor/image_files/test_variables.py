"""Variables by name: numbers, members, elements of arrays and words by address; invalid names are refused."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import pytest

from periph_sim.processor.image_files.model import Symbol
from periph_sim.processor.image_files.variables import BadVariable, Variable, Variables, inside, members_of, number_type
from tests.processor.image_files.typed_data import typed_image


class Value(NamedTuple):
    value: Any


class Entry:
    """An entry of debug data with the interface of pyelftools.

    attributes: names without DW_AT_; `type` is another entry.
    """

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
def test_types_of_numbers(kind: Any, number: tuple[int, str] | None):
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
def test_a_member_or_element_has_its_offset_and_type(path: str, offset: int, kind: Any):
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
def test_invalid_members_and_elements_are_refused(path: str, sentence: str):
    with pytest.raises(BadVariable) as refused:
        inside(WHOLE, "v", path)
    assert str(refused.value).startswith(sentence)


def test_void_and_a_circular_typedef_have_no_members_and_no_elements():
    for kind in (LOOP, Entry("const_type")):
        for path, what in ((".x", "members"), ("[0]", "array")):
            with pytest.raises(BadVariable, match=what):
                inside(kind, "v", path)


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        (WHOLE, ["points", "grid", "either", "open", "unknown", "counted", "computed", "empty", "bits"]),
        (INT, []), (LOOP, []), (array(POINT, 3), []),
    ],
)  # fmt: skip
def test_members_of_a_type(kind: Any, names: list[str]):
    assert members_of(kind) == names


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
def test_the_distance_of_elements_is_the_size_of_their_type(kind: Any, words: int):
    found, _ = inside(array(kind, 9), "v", "[5]")
    assert found == 5 * words


def test_damaged_debug_data_give_a_variable_or_one_sentence(variables: Variables):
    """One byte at a time is damaged: a variable is found, or refused in one sentence."""
    image = typed_image()
    entries = image.debug[".debug_info"]
    sentences = set()
    for place in range(len(entries)):
        damaged = entries[:place] + bytes((entries[place] ^ 0x15,)) + entries[place + 1 :]
        found = Variables(replace(image, debug={**image.debug, ".debug_info": damaged}))
        for name in ("state.inner.gain", "state.parts[2][1]", "words[1]", "_plain"):
            try:
                assert found.find(name).words in (1, 2)
            except BadVariable as refused:
                sentences.add(str(refused))
    assert any("cannot be read" in sentence for sentence in sentences)


@pytest.fixture(scope="module")
def variables() -> Variables:
    return Variables(typed_image())


@pytest.mark.parametrize(
    ("name", "address", "words", "kind"),
    [
        ("state-long", 0x9040, 2, "unsigned"),
        ("state.count", 0x9040, 2, "signed"),
        ("_state.count", 0x9040, 2, "signed"),
        ("state.parts[0][1]", 0x9043, 1, "unsigned"),
        ("state.parts[2][0]", 0x9046, 1, "unsigned"),
        ("state.inner.sign", 0x9048, 1, "signed"),
        ("state.inner.gain", 0x904A, 2, "float"),
        ("words[4]", 0x9064, 1, "unsigned"),
        ("words[2]-long", 0x9062, 2, "unsigned"),
        ("pointers[2]", 0x90A4, 2, "unsigned"),
        ("state.inner-long", 0x9048, 2, "unsigned"),
        ("wide-long", 0x9070, 2, "unsigned"),
        ("_plain", 0x9080, 1, "unsigned"),
        ("_plain[3]", 0x9083, 1, "unsigned"),
        ("0x9084", 0x9084, 1, "unsigned"),
        ("0x9084-long", 0x9084, 2, "unsigned"),
    ],
)
def test_a_variable_has_its_address_and_width(variables: Variables, name: str, address: int, words: int, kind: str):
    found = variables.find(name)
    assert (found.name, found.address, found.words, found.kind) == (name, address, words, kind)


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("of_a_frame", "the image has no variable 'of_a_frame'; "),
        ("computed", "the image has no variable 'computed'; "),
        ("stat.count", "the image has no variable 'stat'; did you mean state"),
        ("state.cuont", "state has no member 'cuont'; did you mean count?"),
        ("state", "state is not a number of 16 or 32 bits; give one of its members, count, parts, inner, low"),
        ("_state", "_state is not a number of 16 or 32 bits; give one of its members, count, parts, inner, low"),
        ("words", "words is not a number of 16 or 32 bits; give the address of a word, for example 0x9060 for words"),
        ("wide", "wide is not a number of 16 or 32 bits; give the address of a word, for example 0x9070 for wide"),
        ("state.inner", "state.inner is not a number of 16 or 32 bits; give one of its members, sign, gain"),
        ("state.parts", "state.parts is not a number of 16 or 32 bits; give the address of a word, for example 0x9042"),
        ("state.parts[1]", "state.parts[1] is not a number of 16 or 32 bits"),
        ("state.low", "state.low is a bit-field; give the address of its word"),
        ("words[5]", "'words[5]': words has 5 elements, from 0 on"),
        ("state.parts[1][2]", "'state.parts[1][2]': state.parts[1] has 2 elements, from 0 on"),
        ("pointers[3]", "'pointers[3]': pointers has 3 elements, from 0 on"),
        ("words.x", "words has no members, so none is called 'x'"),
        ("state[0]", "state is not an array, so it has no element [0]"),
        ("words[x]", "'words[x]': '[x]' is neither a member, .NAME, nor an element, [NUMBER]"),
        ("_plain.x", "the debug data do not describe _plain, so '_plain.x' is unknown; give the address of a word"),
        ("_regs", "_regs is at 0x7900, which is not memory; write a register's field as MODULE.REGISTER.FIELD"),
        ("0x7900", "0x7900 is at 0x7900, which is not memory"),
    ],
)  # fmt: skip
def test_a_name_that_is_no_number_is_refused_with_advice(variables: Variables, name: str, sentence: str):
    with pytest.raises(BadVariable) as refused:
        variables.find(name)
    assert str(refused.value).startswith(sentence)


@pytest.mark.parametrize(
    ("kind", "words", "bits", "value"),
    [
        ("unsigned", 1, 0xFFFF, 0xFFFF), ("unsigned", 2, 0xFFFF_FFFF, 0xFFFF_FFFF),
        ("float", 2, 0xC000_0000, 0xC000_0000),
        ("signed", 1, 0x7FFF, 0x7FFF), ("signed", 1, 0x8000, -0x8000), ("signed", 1, 0xFFFF, -1), ("signed", 1, 0, 0),
        ("signed", 2, 0x8000, 0x8000), ("signed", 2, 0x8000_0000, -0x8000_0000), ("signed", 2, 0xFFFF_FFFE, -2),
    ],
)  # fmt: skip
def test_bits_are_converted_to_a_number_of_the_type(kind: str, words: int, bits: int, value: int):
    variable = Variable("x", 0x9000, words, kind)
    assert variable.value_of(bits) == value
    assert kind == "float" or variable.bits_of(value) == bits


def test_a_float_accepts_any_number_in_its_range_and_other_variables_accept_integers():
    assert (
        Variable("x", 0x9000, 2, "float").bits_of(-2.0) == Variable("x", 0x9000, 2, "float").bits_of(-2) == 0xC000_0000
    )
    for value in (1e40, -1e40, 10**400):
        with pytest.raises(BadVariable, match=rf"^x is a float of 32 bits, so {re.escape(str(value))} does not fit$"):
            Variable("x", 0x9000, 2, "float").bits_of(value)
    with pytest.raises(BadVariable, match=r"^x is not a float, so 1\.0 does not fit; give an integer$"):
        Variable("x", 0x9000, 1, "signed").bits_of(1.0)


def test_symbols_with_brackets_and_dots_are_found_and_symbols_of_code_are_not():
    symbols = (
        Symbol("a.b", 0x9001, ".ebss"), Symbol("a[1]", 0x9002, ".ebss"), Symbol("a", 0x9003, ".ebss"),
        Symbol("f", 0x9000, ".text"), Symbol("SIZE", 0x9004, ""),
    )  # fmt: skip
    found = Variables(replace(typed_image(), symbols=symbols, debug={}))
    assert [found.find(name).address for name in ("a.b", "a[1]", "a[2]", "a[99]-long")] == [
        0x9001, 0x9002, 0x9005, 0x9003 + 99
    ]  # fmt: skip
    for name in ("f", "SIZE", "0x1234567"):
        with pytest.raises(BadVariable):
            found.find(name)


@pytest.mark.parametrize(
    ("words", "value", "bits"), [(1, -0x8000, 0x8000), (1, 0xFFFF, 0xFFFF), (2, -(1 << 31), 1 << 31)]
)
def test_the_limits_of_a_variable(words: int, value: int, bits: int):
    """The limits of signed and of unsigned numbers fit; one beyond them does not."""
    variable = Variable("x", 0x9000, words, "signed")
    assert variable.bits_of(value) == bits
    beyond = value - 1 if value < 0 else value + 1
    with pytest.raises(BadVariable, match=f"x has {16 * words} bits, so {beyond} does not fit"):
        variable.bits_of(beyond)
