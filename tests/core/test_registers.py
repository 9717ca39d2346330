"""Registers as data: access types, resets, write effects, validation of register maps, and decoded values."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.registers import Register, RegisterMap, RegisterMapError, Tie, Yields, field

EVERY = Register(
    "EVERY",
    0,
    "test",
    (
        field("RW", "15:12", "R/W", 5),
        field("RO", "11", "R", 1),
        field("FLAG", "10", "R/W1C"),
        field("HARD", "9", "R/W1C", tie=Tie.HARDWARE),
        field("ONCE", "8", "R/S"),
        field("CODE", "7:5", "RC"),
        field("FIRE", "4", "W1"),
        field("HIDDEN", "3", "W"),
    ),
)
FLAG, HARD, ONCE, RO = (EVERY[n].mask for n in ("FLAG", "HARD", "ONCE", "RO"))


@pytest.mark.parametrize(("yields", "data"), [(Yields.DATA, ""), (Yields.STATE, "B"), (Yields.TIME, "B")])
def test_a_register_that_yields_data_names_the_field_of_the_word(yields: Yields, data: str):
    with pytest.raises(RegisterMapError, match=f"^R yields {yields.name}, and its data field is '{data}'$"):
        Register("R", 0, "", (field("B", "7:0"),), yields=yields, data=data)


def test_reset_follows_from_the_fields():
    assert EVERY.reset == 0x5800


def test_a_read_shows_no_write_only_field_and_clears_what_reads_clear():
    seen, stored = EVERY.read(0xFFFF)
    assert seen == 0xFFFF & ~(1 << 4 | 1 << 3 | 7)
    assert EVERY["CODE"].extract(stored) == 0 and EVERY["RW"].extract(stored) == 0xF
    assert not EVERY.reads_are_harmless


@pytest.mark.parametrize(
    ("name", "stored", "written", "after"),
    [
        ("RW", 0, 0xF, 0xF),
        ("RO", 1, 0, 1),
        ("RO", 0, 1, 0),
        ("FLAG", 1, 1, 0),
        ("FLAG", 1, 0, 1),
        ("FLAG", 0, 1, 0),
        ("ONCE", 0, 1, 1),
        ("ONCE", 1, 0, 1),
        ("CODE", 3, 0, 3),
        ("FIRE", 0, 1, 0),
        ("HIDDEN", 0, 1, 1),
    ],
)
def test_a_write_changes_a_field_by_its_access_type(name, stored, written, after):
    f = EVERY[name]
    value, _ = EVERY.write(f.put(0, stored), f.put(0, written))
    assert f.extract(value) == after


def test_a_strobe_fires_and_stores_nothing():
    stored, fired = EVERY.write(0, 0xFFFF)
    assert fired == EVERY["FIRE"].mask and not stored & fired


def test_the_tie_decides_between_write_and_hardware_in_one_cycle():
    stored, _ = EVERY.write(FLAG | HARD, FLAG | HARD, set_now=FLAG | HARD)
    assert stored & FLAG == 0 and stored & HARD == HARD


@given(stored=st.integers(0, 0xFFFF), written=st.integers(0, 0xFFFF))
def test_no_write_changes_fields_that_only_hardware_changes(stored, written):
    value, _ = EVERY.write(stored, written)
    owned = RO | EVERY["CODE"].mask
    assert value & owned == stored & owned


def test_a_number_too_wide_is_cut_as_in_c():
    assert EVERY["RW"].put(0, 0x123) == 0x3000


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ((field("A", "3:0"), field("B", "3")), r"R\.B \[3\] overlaps"),
        ((field("A", "1:0", reset=4),), r"R\.A resets to 0x4, wider than \[1:0\]"),
        ((field("A", "16"),), r"R\.A \[16\] does not fit 16 bits"),
    ],
)
def test_a_map_that_contradicts_itself_is_refused(fields, message):
    with pytest.raises(RegisterMapError, match=message):
        Register("R", 0, "test", fields)


def test_the_error_of_an_unknown_name_suggests_the_nearest_one():
    with pytest.raises(RegisterMapError, match="access 'RX' is none of R/W"):
        field("A", "0", "RX")
    with pytest.raises(KeyError, match=r"EVERY has no field 'FLAGG'; did you mean FLAG\?"):
        EVERY["FLAGG"]
    registers = RegisterMap("M", "test", (EVERY,))
    with pytest.raises(KeyError, match=r"M has no register 'EVRY'; did you mean EVERY\?"):
        registers["EVRY"]
    with pytest.raises(RegisterMapError, match="share a name or an offset"):
        RegisterMap("M", "test", (EVERY, EVERY))


def test_decoding_shows_the_fields_that_are_not_zero():
    assert EVERY.decode(0x5800) == "EVERY=0x5800 (RW=0x5 RO=0x1)"
    assert EVERY.decode(0) == "EVERY=0x0000 (all zero)"
