"""Entries of the serial tables: what each takes over from its table, and lengths in the words of a case."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from periph_sim.bus.uart.frame_format import UartFormat
from periph_sim.core.convert import BadTable
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


TEXT = {key: value for key, value in SEND.items() if key != "bytes"}


@pytest.mark.parametrize(
    ("kind", "table", "said"),
    [
        *((SerialTable, {"baud": baud}, "") for baud in (1, 10_000_000)),
        *((SerialTable, {"baud": baud}, "baud") for baud in (0, 10_000_001)),
        *((SerialTable, {"bits": bits, "stop": stop}, "") for bits, stop in ((1, 1), (8, 2))),
        *((SerialTable, {"bits": bits}, "bits") for bits in (0, 9)),
        *((SerialTable, {"stop": stop}, "stop") for stop in (0, 3)),
        (SendTable, SEND | {"times": 1, "period": "1 ms", "wrong_parity": [0], "missing_stop": [0]}, ""),
        (SendTable, SEND | {"times": 0, "period": "1 ms"}, "times"),
        (SendTable, SEND | {"wrong_parity": [-1]}, "wrong_parity"),
        (SendTable, SEND | {"missing_stop": [-1]}, "missing_stop"),
        (SendTable, SEND | {"text": "U"}, "text and bytes cannot both be; leave one of them out"),
        (SendTable, TEXT, "a send needs one of text, bytes, file and break"),
        (SendTable, SEND | {"after": "x"}, "at and after cannot both be; leave one of them out"),
        (SendTable, {"to": "dsp.SCI-A", "bytes": "55"}, "a send needs one of at, after, after_text and after_bytes"),
        (SendTable, TEXT | {"text": ""}, "text is empty; write at least one character"),
        (SendTable, SEND | {"bytes": ""}, "bytes is empty; write at least one character"),
        (SendTable, {"to": "dsp.SCI-A", "text": "U", "after_text": ""}, "after_text is empty; write at least one"),
        (SendTable, {"to": "dsp.SCI-A", "text": "U", "after_bytes": ""}, "after_bytes is empty; write at least one"),
        (
            SendTable,
            SEND | {"times": 2},
            "times needs period, since a time comes once; give period, or leave times out",
        ),
        (SendTable, {"to": "dsp.SCI-A", "text": "U", "after_text": "x", "times": 2}, ""),
        (SendTable, TEXT | {"break": "1 ms"}, ""),
        (SendTable, TEXT | {"break": "0 s"}, "break"),
        (SendTable, TEXT | {"break": "1 ms", "address": 0}, "a break has no characters; send them apart"),
        (SendTable, TEXT | {"break": "1 ms", "wrong_parity": [0]}, "a break has no characters; send them apart"),
        (SendTable, TEXT | {"break": "1 ms", "missing_stop": [0]}, "a break has no characters; send them apart"),
        (ExpectTable, EXPECT | {"bytes": "55"}, "text and bytes cannot both be; leave one of them out"),
        (ExpectTable, EXPECT | {"after": "x"}, "after and at cannot both be; leave one of them out"),
        (ExpectTable, EXPECT | {"text": ""}, "text is empty; write at least one character"),
        (ExpectTable, EXPECT | {"within": "0 s"}, "within"),
    ],
)
def test_a_serial_table_at_its_limits(kind: Any, table: dict[str, Any], said: str):
    if not said:
        kind.model_validate(table)
        return
    with pytest.raises(BadTable) as caught:
        kind.model_validate(table)
    assert said in str(caught.value)
