"""The instruction set as data: no two forms claim the same words; what belongs to none is what the manual leaves."""

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
    """Whether some words fit the fixed bits of both."""
    return (row.value ^ other.value) & row.mask & other.mask == 0


def test_no_two_forms_match_the_same_words():
    rows = [row for row in encodings() if not row.alias_of]
    shared = [(row.id, other.id) for row, other in itertools.combinations(rows, 2) if both(row, other)]
    # told apart by the bound of n, which the fixed bits do not say
    assert [pair for pair in shared if not any("n" in by_id()[name].bounds for name in pair)] == []
    for name, other in shared:
        bounded = by_id()[name] if "n" in by_id()[name].bounds else by_id()[other]
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
    begun = {(row.mask >> 16, row.value >> 16) for row in encodings()}
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


# Every column is read -----------------------------------------------------------------------------------------------


def table_with(line: str) -> str:
    """The shipped table with another column in its first row."""
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
def test_a_column_that_no_code_reads_is_refused_and_a_value_that_none_understands(line: str, sentence: str):
    assert read_table(table_with('cycles_rpt = "N+4"'))[0].repeated == 4
    with pytest.raises(ValueError, match=sentence):
        read_table(table_with(line))


@pytest.mark.parametrize("name", [field.name for field in dataclasses.fields(Encoding)])
def test_what_a_form_says_of_itself_has_an_effect(name: str):
    """`kind`, `depends`, `op` and what `flags` says beside LVF decide what tests of the execution expect."""
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
