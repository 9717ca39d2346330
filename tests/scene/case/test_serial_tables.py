"""Entries of the serial tables: what each takes over from its table, and lengths in the words of a case."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from periph_sim.bus.uart.frame_format import UartFormat
from periph_sim.scene.case.serial import ExpectTable, SendTable, SerialTable, in_words


@pytest.mark.parametrize(
    ("length", "words"),
    [
        (Fraction(3), "3 s"),
        (Fraction(3, 1000), "3 ms"),
        (Fraction(1500, 1000), "1500 ms"),
        (Fraction(7, 10**6), "7 us"),
        (Fraction(7, 10**9), "7 ns"),
        (Fraction(1, 3), "1/3 s"),
    ],
)
def test_a_length_has_the_largest_unit_in_which_it_is_whole(length: Fraction, words: str):
    assert in_words(length) == words


SEND = {"to": "dsp.SCI-A", "at": "1 ms", "bytes": "55"}
EXPECT = {"name": "e", "from": "dsp.SCI-A", "at": "1 ms", "text": "OK", "within": "1 ms"}
OWN = {"baud": 9600, "bits": 8, "parity": "odd", "stop": 1, "multiprocessor": "none"}


@pytest.mark.parametrize("kind", [SendTable, ExpectTable])
def test_an_entry_has_the_format_of_its_table_or_its_own(kind: Any):
    table = SerialTable.model_validate(
        {"baud": 1200, "bits": 7, "parity": "even", "stop": 2, "multiprocessor": "address-bit", "ppm": 20}
    )
    needed = SEND if kind is SendTable else EXPECT
    plain, own = kind.model_validate(needed), kind.model_validate(needed | OWN)
    for entry in (None, plain):
        assert (table.bit(entry), table.form(entry)) == (Fraction(1, 1200), UartFormat(7, "even", 2, True))
        assert (table.mode(entry), table.clock(entry)) == ("address-bit", 20)
    assert (table.bit(own), table.form(own)) == (Fraction(1, 9600), UartFormat(8, "odd", 1, False))
    assert table.mode(own) == "none"


@pytest.mark.parametrize(("ppm", "clock"), [(None, 20), (0, 0), (-7, -7)])
def test_a_send_may_have_a_clock_of_its_own(ppm: int | None, clock: int):
    send = SendTable.model_validate(SEND | ({} if ppm is None else {"ppm": ppm}))
    assert SerialTable.model_validate({"ppm": 20}).clock(send) == clock
