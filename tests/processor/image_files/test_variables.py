"""Variables by name: numbers, members of structures, elements of arrays, words by address; and what is refused."""

from __future__ import annotations

from dataclasses import replace

import pytest

from periph_sim.processor.image_files.model import Symbol
from periph_sim.processor.image_files.number_types import BadVariable
from periph_sim.processor.image_files.variables import Variable, Variables
from tests.processor.image_files.typed_data import typed_image


def test_damaged_debug_data_are_said_to_be(variables: Variables):
    """Each byte of them wrong, one at a time: a variable, or one sentence."""
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
        ("state", 0x9040, 1, "unsigned"),
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
        ("wide", 0x9070, 1, "unsigned"),
        ("_plain", 0x9080, 1, "unsigned"),
        ("_plain[3]", 0x9083, 1, "unsigned"),
        ("0x9084", 0x9084, 1, "unsigned"),
        ("0x9084-long", 0x9084, 2, "unsigned"),
    ],
)
def test_a_part_has_its_place_and_width(variables: Variables, name: str, address: int, words: int, kind: str):
    found = variables.find(name)
    assert (found.name, found.address, found.words, found.kind) == (name, address, words, kind)


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("of_a_frame", "the image has no variable 'of_a_frame'; "),
        ("computed", "the image has no variable 'computed'; "),
        ("stat.count", "the image has no variable 'stat'; did you mean state"),
        ("state.cuont", "state has no member 'cuont'; did you mean count?"),
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
def test_what_is_no_number_is_refused_with_the_way_out(variables: Variables, name: str, sentence: str):
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
def test_bits_are_the_number_of_their_type(kind: str, words: int, bits: int, value: int):
    variable = Variable("x", 0x9000, words, kind)
    assert variable.value_of(bits) == value
    assert kind == "float" or variable.bits_of(value) == bits


def test_a_float_takes_any_number_and_other_variables_whole_ones():
    assert (
        Variable("x", 0x9000, 2, "float").bits_of(-2.0) == Variable("x", 0x9000, 2, "float").bits_of(-2) == 0xC000_0000
    )
    with pytest.raises(BadVariable, match=r"^x is not a float, so 1\.0 does not fit; give an integer$"):
        Variable("x", 0x9000, 1, "signed").bits_of(1.0)


def test_symbols_with_brackets_and_dots_are_known_whole_and_those_of_code_not_at_all():
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
def test_the_ends_of_what_a_variable_holds(words: int, value: int, bits: int):
    """As signed and as unsigned numbers; one further does not fit."""
    variable = Variable("x", 0x9000, words, "signed")
    assert variable.bits_of(value) == bits
    beyond = value - 1 if value < 0 else value + 1
    with pytest.raises(BadVariable, match=f"x has {16 * words} bits, so {beyond} does not fit"):
        variable.bits_of(beyond)
