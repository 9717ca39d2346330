"""The register slave agrees with an array of bytes after random writes and reads at both bus rates."""

from __future__ import annotations

from random import Random

import pytest

from periph_sim.outside import Session
from periph_sim.scene.case.model import BadCase
from tests.outside.sessions import begun, case, refuses


def slave(**settings: object) -> Session:
    return begun(case("register_slave", dsp={"settings": settings}))


def test_pointer_data_repeated_start_and_continued_reads() -> None:
    """S 50W 10 A1 A2 P   S 50W 10 Sr 50R A1 P   S 50R A2 P   S 50R 00 P"""
    master = slave().i2c
    assert master.transfer(0x50, b"\x10\xa1\xa2") == b""
    assert master.transfer(0x50, b"\x10", 1) == b"\xa1"
    assert master.transfer(0x50, count=1) == b"\xa2"
    assert master.transfer(0x50, count=1) == b"\x00"


def test_a_byte_loaded_in_advance_is_replaced_when_it_is_written() -> None:
    """The byte after the last read one is already in I2CDXR when a write changes it."""
    master = slave(registers="01 02 03").i2c
    assert master.transfer(0x50, b"\x00", 1) == b"\x01"
    assert master.transfer(0x50, b"\x01\x99") == b""
    assert master.transfer(0x50, b"\x01", 2) == b"\x99\x03"


def test_addresses_wrap_and_register_values_must_fit() -> None:
    master = slave(registers="01 02 03", size=3).i2c
    assert master.transfer(0x50, b"\x02", 4) == b"\x03\x01\x02\x03"
    said = "registers has 3 bytes, and there are 2 registers"
    refuses(said, slave, registers="01 02 03", size=2, error=BadCase)
    refuses("size is 257; a pointer of one byte addresses 1 to 256 registers", slave, size=257, error=BadCase)


def random_transfers(rate: str, number: int) -> None:
    draw = Random(rate)
    master = slave(address=0x2A).i2c
    master.rate = rate
    registers, pointer = bytearray(256), 0
    for _ in range(number):
        length = draw.randrange(1, 6)
        kind = draw.choice(("write", "read", "go on", "other", "pointer"))
        if kind == "go on":
            expected = bytes(registers[(pointer + n) % 256] for n in range(length))
            assert master.transfer(0x2A, count=length) == expected
            pointer = (pointer + length) % 256
        elif kind == "other":
            assert master.transfer(0x2B, b"\x01", length) is None
        else:
            pointer = draw.randrange(256)
            data = bytes(draw.randrange(256) for _ in range(length)) if kind == "write" else b""
            count = length if kind == "read" else 0
            expected = bytes(registers[(pointer + n) % 256] for n in range(count))
            assert master.transfer(0x2A, bytes([pointer]) + data, count) == expected
            for byte in data:
                registers[pointer] = byte
                pointer = (pointer + 1) % 256
            pointer = (pointer + count) % 256


@pytest.mark.parametrize("rate", ["100 kHz", "400 kHz"])
def test_random_transfers_agree_with_an_array(rate: str) -> None:
    random_transfers(rate, 60)


@pytest.mark.long
@pytest.mark.parametrize("rate", ["100 kHz", "400 kHz"])
def test_a_thousand_random_transfers_agree_with_an_array(rate: str) -> None:
    random_transfers(rate, 1000)
