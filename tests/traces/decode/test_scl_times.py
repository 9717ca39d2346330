"""Sampling rates that cannot be true, told by the clock that they would give the bus."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.traces import formats
from periph_sim.traces.decode.scl_times import impossible_rate
from tests.traces.decode.drawing import drawn
from tests.traces.formats.make_traces import FOLDER

NACK = FOLDER / "nack.sr"  # 100 kHz, seen at 4 MHz


@pytest.mark.parametrize(
    ("rate", "clock"),
    [(1, "0.025 Hz"), (1000, "25 Hz"), (4_000, ""), (4 * 10**6, ""), (200 * 10**6, ""), (4 * 10**9, "1e+08 Hz")],
)
def test_a_rate_is_impossible_where_scl_would_run_at_no_rate_of_a_bus(rate: int, clock: str):
    said = impossible_rate(formats.read(NACK, Fraction(rate)), "SCL")
    assert (f"SCL would run at {clock}; expected 100 Hz to 5 MHz" in said) if clock else said == ""


def test_with_few_clocks_or_no_rate_nothing_is_said():
    assert impossible_rate(drawn("SCL -_-_-_-_-_-_-_-_", rate=1), "SCL") == "", "fewer than a byte"
    assert impossible_rate(drawn("SCL -" + "_-" * 9, rate=1), "SCL") != ""
    assert impossible_rate(drawn("SCL -" + "_-" * 9, rate=None), "SCL") == ""
