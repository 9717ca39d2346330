"""The register maps agree with the tables of the data sheets, and so do the chips when they are read over the bus."""

from __future__ import annotations

import pytest

from periph_sim.core.registers import OnWrite
from periph_sim.devices.chips.adxl345 import Adxl345
from periph_sim.devices.chips.hmc5883l import Hmc5883l
from periph_sim.devices.chips.itg3200 import Itg3200
from periph_sim.devices.chips.register_chip import RegisterChip
from tests.devices.bench import TIMEBASE, Bench, steady
from tests.devices.register_tables import ADXL345, HMC5883L, ITG3200

CHIPS = [(Adxl345, ADXL345), (Itg3200, ITG3200), (Hmc5883l, HMC5883L)]


def rows(table: str) -> list[tuple[int, str, str, int]]:
    split = [line.split() for line in table.strip().splitlines()]
    return [(int(number, 16), name, access, int(value, 16)) for number, name, access, value in split]


def chip_of(kind: type[RegisterChip]) -> RegisterChip:
    return kind(TIMEBASE, steady(0, 0, 0))


@pytest.mark.parametrize(("kind", "table"), CHIPS)
def test_the_register_map_agrees_with_the_data_sheet(kind: type[RegisterChip], table: str):
    typed = [
        (register.offset, register.name, "RW" if register.mask(OnWrite.STORE) else "R", register.reset)
        for register in kind.MAP
    ]
    assert typed == rows(table)
    assert all(register.source and register.width == 8 for register in kind.MAP)


def test_addresses_are_those_of_the_data_sheets():
    assert {kind.__name__: kind.ADDRESSES for kind, _ in CHIPS} == {
        "Adxl345": (0x53, 0x1D),
        "Itg3200": (0x68, 0x69),
        "Hmc5883l": (0x1E,),
    }
    assert all(chip_of(kind).address == kind.ADDRESSES[0] for kind, _ in CHIPS)


@pytest.mark.parametrize(("kind", "table"), CHIPS)
def test_every_register_reads_its_power_on_value_over_the_bus(kind: type[RegisterChip], table: str):
    bench = Bench(chip_of(kind), begin=30_000_000)  # after 30 ms: accessible, and the gyroscopes not yet started up
    assert {number: bench.read(number)[0] for number, *_ in rows(table)} == {
        number: value for number, _, _, value in rows(table)
    }


@pytest.mark.parametrize(("kind", "table"), CHIPS)
def test_a_write_is_stored_where_software_can_write_and_noted_elsewhere(kind: type[RegisterChip], table: str):
    for number, name, access, value in rows(table):
        chip = chip_of(kind)
        bench = Bench(chip)
        stored = dict(chip.stored)
        bits = kind.MAP[name].mask(OnWrite.STORE)
        lowest = (bits or 1) & -(bits or 1)
        assert bench.write(number, value ^ lowest)
        if access == "R":
            assert chip.stored == stored, name
            assert [note.code for note in chip.notes] == ["duty"] and "read-only" in chip.notes[0].text
        else:
            assert chip.stored[number] == value ^ lowest, name


@pytest.mark.parametrize(("kind", "table"), CHIPS)
def test_reserved_registers_read_0_and_ignore_writes(kind: type[RegisterChip], table: str):
    known = {number for number, *_ in rows(table)}
    chip = chip_of(kind)
    bench = Bench(chip)
    for number in (n for n in (0x01, 0x0D, 0x10, 0x14, 0x3A, 0x3F, 0x80, 0xFF) if n not in known):
        stored = dict(chip.stored)
        assert bench.read(number) == b"\0", hex(number)
        assert bench.write(number, 0x55) and chip.stored == stored
        assert any("reserved" in note.text for note in chip.notes)
        chip.notes.clear()
