"""The instruction set as data: no two forms claim the same words; what belongs to none is what the manual leaves."""

from __future__ import annotations

import itertools

import pytest

from periph_sim.c28x.decoder import decode
from periph_sim.c28x.encodings import Encoding, by_id, encodings


def both(row: Encoding, other: Encoding) -> bool:
    """Whether some words fit the fixed bits of both."""
    return (row.value ^ other.value) & row.mask & other.mask == 0


def without_shift_0(row: Encoding) -> bool:
    return ("s", 1) in row.at_least


@pytest.mark.parametrize("objmode", ["1", "0"])
def test_no_two_forms_of_a_mode_match_the_same_words(objmode: str):
    rows = [row for row in encodings() if row.objmode in ("X", objmode) and not row.alias_of]
    shared = [(row.id, other.id) for row, other in itertools.combinations(rows, 2) if both(row, other)]
    # told apart by the bound of n, which the fixed bits do not say
    assert [pair for pair in shared if not any(by_id()[name].at_most for name in pair)] == []
    for name, other in shared:
        bounded = by_id()[name] if by_id()[name].at_most else by_id()[other]
        free = by_id()[other] if bounded is by_id()[name] else by_id()[name]
        assert not bounded.matches(free.pair(dict.fromkeys(free.fields, 0)))


def test_an_alias_is_one_value_of_the_form_it_stands_for():
    for row in encodings():
        if row.alias_of:
            assert by_id()[row.alias_of].matches(row.value), row.id


def test_fields_and_words_of_every_form_are_each_others_inverse():
    for row in encodings():
        ends = {name: place.mask for name, place in row.fields.items()}
        for values in (ends, dict.fromkeys(ends, 0)):
            assert row.values(row.pair(values)) == values, row.id
            assert row.pair(values) & row.mask == row.value, row.id


def test_a_number_too_wide_for_its_field_is_refused():
    with pytest.raises(ValueError, match="at most 255"):
        by_id()["ADDB_ACC_8"].pair({"c": 256})


def test_first_words_that_begin_no_instruction():
    """How many do was counted from the manual's opcode rows."""
    rows = [row for row in encodings() if row.objmode != "0"]
    begun = {(row.mask >> 16, row.value >> 16) for row in rows}
    known = 0
    for upper in range(0, 0x10000, 0x100):  # those of this upper byte only: forty times quicker
        near = [(mask, value) for mask, value in begun if (upper ^ value) & mask & 0xFF00 == 0]
        known += sum(any(first & mask == value for mask, value in near) for first in range(upper, upper + 0x100))
    assert known == 63_144
    assert decode(0x5612, 0) is None
    assert decode(0x761E, 0) is None
    assert decode(0xA100, 0) is None
    assert decode(0xFF60, 0) is None  # SXTB of later tools


@pytest.mark.parametrize("word", [0xE271, 0xE274, 0xE206, 0xE2C1])
def test_words_of_the_units_that_an_f2837x_has_beside_belong_to_no_form(word: int):
    assert all(decode(word, second) is None for second in range(0, 0x10000, 0x101))


def test_32_bits_at_sp_and_reserved_conditions_are_no_instruction():
    assert decode(0x0600 | 0xAD, 0) is None  # MOVL ACC,@SP
    assert decode(0x9200 | 0xAD, 0).id == "MOV_AX_loc16"  # MOV AL,@SP
    assert decode(0xE586, 0) is None  # TESTTF of a condition that nobody defined
    assert decode(0xE2AF, 0x00A0) is None  # MOV32 R0H,register: not of this form
