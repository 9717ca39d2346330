"""What is said of a record."""

from __future__ import annotations

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.worst.words import happened


def record(kind: Kind, where: str, what: str, value: int, text: str = "") -> Record:
    return Record(1, 0, kind, where, what, value, text, 0)


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
def test_a_flag_is_set_or_cleared_and_a_number_is_told(where: str, what: str, value: int, said: str):
    assert happened(record(Kind.FLAG, where, what, value)) == said
