"""Texts that describe a record."""

from __future__ import annotations

import pytest

from periph_sim.core.records import TIMED_OUT, Kind, Record
from periph_sim.records.record_text import happened, happened_where, on_the_bus


def record(kind: Kind, where: str, what: str, value: int, text: str = "", field: str = "") -> Record:
    return Record(1, 0, kind, where, what, value, text, 0, field)


@pytest.mark.parametrize(
    ("where", "what", "value", "said"),
    [
        ("dsp.I2C-A", "I2CSTR.SDIR", 1, "I2C-A.I2CSTR.SDIR set"),
        ("dsp.I2C-A", "I2CSTR.SDIR", 0, "I2C-A.I2CSTR.SDIR cleared"),
        ("dsp.SCI-A", "SCIFFRX.RXFFST", 12, "SCI-A.SCIFFRX.RXFFST = 0xc"),
        ("dsp.SCI-A", "SCIFFRX.RXFFST", 1, "SCI-A.SCIFFRX.RXFFST = 1"),
        ("dsp.SCI-A", "SCIFFRX.RXFFST", 0, "SCI-A.SCIFFRX.RXFFST = 0"),
        ("dsp.NEW", "REG.FLAG", 1, "NEW.REG.FLAG = 1"),
    ],
)
def test_a_flag_is_set_or_cleared_and_a_number_has_its_value(where: str, what: str, value: int, said: str):
    assert happened(record(Kind.FLAG, where, what, value)) == said


@pytest.mark.parametrize(
    ("what", "value", "said"),
    [
        ("START", 0, "START"),
        ("STOP", 0, "STOP"),
        ("address", 0x21 << 2 | 2, "0x21 R ACK"),
        ("address", 0x68 << 2 | 1, "0x68 W NACK"),
        ("address", 0x2A5 << 2, "0x2A5 W ACK"),
        ("byte", 0x11 << 1, "0x11 ACK"),
        ("byte", 0x05 << 1 | 1, "0x05 NACK"),
    ],
)
def test_addresses_and_bytes_are_written_in_the_usual_notation(what: str, value: int, said: str):
    made = record(Kind.BUS, "controller", what, value, "gyroscope")
    assert on_the_bus(made) == said
    assert happened_where(made) == f"controller: {said} (gyroscope)"


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (
            record(Kind.ACCESS, "dsp", "W I2C-A.I2CSTR", 0x5638, "batch_read:125", "SCD"),
            "dsp: I2C-A.I2CSTR written, 0x5638 (SCD = 1) at batch_read:125",
        ),
        (record(Kind.ACCESS, "dsp", "R I2C-A.I2CSTR", 0x11, "f:1"), "dsp: I2C-A.I2CSTR read, 0x0011 at f:1"),
        (record(Kind.ACCESS, "dsp", "R NEW.REG", 0x11, "f:1", "X"), "dsp: NEW.REG read, 0x0011 at f:1"),
        (record(Kind.FRAME, "host", "byte", 0x55), "host: 0x55"),
        (record(Kind.EDGE, "SCL", "level", 0, "controller"), "SCL falls, pulled low by controller"),
        (record(Kind.HOLD, "SCL", "held", 0, "dsp.SCLA"), "SCL stays low, held by dsp.SCLA"),
        (record(Kind.IRQ, "dsp", "SCIRXINTA", 1, "sci:76"), "dsp: SCIRXINTA entered at sci:76"),
        (record(Kind.IRQ, "dsp", "SCIRXINTA", 0), "dsp: SCIRXINTA left"),
        (record(Kind.FLAG, "dsp.I2C-A", "I2CSTR.SDIR", 1), "dsp.I2C-A.I2CSTR.SDIR set"),
        (record(Kind.FLAG, "dsp.RAM", "x", 10, "f:1"), "dsp.RAM.x = 0xa at f:1"),
        (record(Kind.FLAG, "dsp.RAM", "x", 9), "dsp.RAM.x = 9"),
        (record(Kind.FLAG, "dsp.RAM", "x", -1), "dsp.RAM.x = -0x1"),
        (record(Kind.EDGE, "SCL", "level", 1, "controller"), "SCL rises"),
        (record(Kind.EDGE, "SCL", "level", 0), "SCL falls"),
        (record(Kind.SPAN, "dsp", "model", 1, "f:1"), "dsp: span model begins at f:1"),
        (record(Kind.SPAN, "dsp", "model", 0), "dsp: span model ends"),
        (record(Kind.WAIT, "dsp", "AAS", 1, "f:1"), "dsp: wait for AAS begins at f:1"),
        (record(Kind.WAIT, "dsp", "AAS", 0, "f:1"), "dsp: wait for AAS is over at f:1"),
        (record(Kind.NOTE, "dsp", "duty", 1, "half"), "dsp: note: half"),
        (record(Kind.NOTE, "dsp", "duty", 1), "dsp: note duty"),
        (record(Kind.BUS, "head", "STOP", 0), "head: STOP"),
        (record(Kind.FRAME, "host", "begin", 0), "host: frame begins"),
        (record(Kind.FRAME, "host", "end", 0x55), "host: 0x55 is over"),
        (record(Kind.FRAME, "host", "error", 0x05), "host: 0x05 is over, with an error"),
        (record(Kind.FRAME, "pair", "collision", 0, "a and b"), "pair: a collision, a and b"),
    ],
)
def test_a_record_with_its_unit_and_place(made: Record, said: str):
    assert happened_where(made) == said


def test_a_wait_that_timed_out_is_described_as_given_up():
    ends = [Record(1, 0, Kind.WAIT, "dsp", "SCI-A.SCIFFRX.RXFFST", 0, text, 0) for text in (TIMED_OUT, "")]
    assert [happened_where(end) for end in ends] == [
        "dsp: wait for SCI-A.SCIFFRX.RXFFST gave up (timeout)",
        "dsp: wait for SCI-A.SCIFFRX.RXFFST is over",
    ]
