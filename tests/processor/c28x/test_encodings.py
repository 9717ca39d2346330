"""The table of the instruction set: no two forms match the same words, and undefined words match none."""

from __future__ import annotations

import dataclasses
import itertools
import re
from importlib import resources
from pathlib import Path

import pytest

from periph_sim.processor.c28x.decoder import decode
from periph_sim.processor.c28x.encodings import Encoding, by_id, encodings, read_table

ROOT = Path(__file__).parents[3]


def both(row: Encoding, other: Encoding) -> bool:
    """True if some words match the fixed bits of both forms."""
    return (row.value ^ other.value) & row.mask & other.mask == 0


def test_no_two_forms_match_the_same_words():
    rows = [row for row in encodings() if not row.alias_of]
    shared = [(row.id, other.id) for row, other in itertools.combinations(rows, 2) if both(row, other)]
    # the bound of n distinguishes these, which the fixed bits do not express
    assert [pair for pair in shared if not any("n" in by_id()[name].bounds for name in pair)] == []
    for name, other in shared:
        bounded = by_id()[name] if "n" in by_id()[name].bounds else by_id()[other]
        free = by_id()[other] if bounded is by_id()[name] else by_id()[name]
        assert not bounded.matches(free.pair(dict.fromkeys(free.fields, 0)))


def test_an_alias_is_one_value_of_its_form():
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
    """The count of first words that begin an instruction was taken from the manual's opcode rows."""
    begun = {(row.mask >> 16, row.value >> 16) for row in encodings()}
    known = 0
    for upper in range(0, 0x10000, 0x100):  # only forms with this upper byte, which is forty times faster
        near = [(mask, value) for mask, value in begun if (upper ^ value) & mask & 0xFF00 == 0]
        known += sum(any(first & mask == value for mask, value in near) for first in range(upper, upper + 0x100))
    assert known == 63_144
    assert decode(0x5612, 0) is None
    assert decode(0x761E, 0) is None
    assert decode(0xA100, 0) is None
    assert decode(0xFF60, 0) is None  # SXTB, an instruction of later tools


@pytest.mark.parametrize("word", [0xE271, 0xE274, 0xE206, 0xE2C1])
def test_instructions_that_only_an_f2837x_has_are_unknown(word: int):
    assert all(decode(word, second) is None for second in range(0, 0x10000, 0x101))


def test_32_bit_access_to_sp_and_reserved_conditions_are_no_instructions():
    assert decode(0x0600 | 0xAD, 0) is None  # MOVL ACC,@SP
    assert decode(0x9200 | 0xAD, 0).id == "MOV_AX_loc16"  # MOV AL,@SP
    assert decode(0xE586, 0) is None  # TESTTF with an undefined condition
    assert decode(0xE2AF, 0x00A0) is None  # MOV32 R0H,register, which is not an operand of this form


# Every column is read -----------------------------------------------------------------------------------------------


def table_with(line: str) -> str:
    """Return the shipped table with another column in its first row."""
    text = resources.files("periph_sim.processor.c28x").joinpath("encodings.toml").read_text(encoding="utf-8")
    return text.replace("[ITRAP0]\n", f"[ITRAP0]\n{line}\n", 1)


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ('cycles_note = "2"', r"encodings\.toml: ITRAP0: no code reads cycles_note; read the column"),
        ('cycles_where = "y has INTM: 2"', "is not a field condition"),
        ('cycles_rpt = "passes+3"', r"'passes\+3' is not the cycles of N \+ 1 executions"),
    ],
)
def test_unknown_columns_and_malformed_values_are_refused(line: str, sentence: str):
    assert read_table(table_with('cycles_rpt = "N+4"'))[0].repeated == 4
    with pytest.raises(ValueError, match=sentence):
        read_table(table_with(line))


@pytest.mark.parametrize("name", [field.name for field in dataclasses.fields(Encoding)])
def test_each_attribute_of_a_form_is_used(name: str):
    """`kind`, `depends`, `op` and the flags other than LVF are read by the tests of the execution only."""
    sources = [
        *(ROOT / "periph_sim").rglob("*.py"),
        *(ROOT / "tests" / "processor" / "c28x" / "execution").glob("*.py"),
    ]
    own = ROOT / "periph_sim" / "processor" / "c28x" / "encodings.py"
    used = [
        path for path in sources if re.search(rf"\b(encoding|row|form)\.{name}\b", path.read_text(encoding="utf-8"))
    ]
    inside = re.findall(rf"\bself\.{name}\b", own.read_text(encoding="utf-8"))
    assert inside or [path for path in used if path != own]
