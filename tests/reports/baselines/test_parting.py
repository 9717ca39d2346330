"""How two chains part: the event that moved most, and the first that differs."""

from __future__ import annotations

import pytest

from periph_sim.reports.baselines.event_chain import first_divergence

START, WRITE, ENTER = "START gyroscope on the bus", "I2C-A.I2CDXR written by dsp", "SCIRXINTA entered by dsp"


# before, now: "S0 W5" is a START after 0 cycles and a write after 5; I is an interrupt's entry.
@pytest.mark.parametrize(
    ("before", "now", "told"),
    [
        ("", "", ""),
        ("S0 W5", "S0 W5", ""),
        ("S0 W5", "S0 W19", f"{WRITE} 14 cycles later"),
        ("S0 W5", "S0 W4", f"{WRITE} 1 cycle earlier"),
        ("S0 W5 I7", "S0 W9 I11", f"{WRITE} 4 cycles later"),
        ("S0 W5 I7", "S0 I7 W9", f"{WRITE} 4 cycles later"),
        ("S0 W5 I9", "S0 W6 I20", f"{ENTER} 11 cycles later; first to differ: {WRITE} 1 cycle later"),
        ("S0 W5", "S0 I3 W9", f"{WRITE} 4 cycles later; first to differ: {ENTER} after 3 cycles, which is new"),
        ("S0 W5", "S0 W5 W8", f"{WRITE} after 8 cycles, which is new"),
        ("S0 W5", "S0", f"no more {WRITE}, which was after 5 cycles"),
        ("S0 W0", "S0", f"no more {WRITE}, which was after 0 cycles"),
    ],
)
def test_what_is_told(before: str, now: str, told: str):
    names = {"S": START, "W": WRITE, "I": ENTER}
    chains = [[f"{event[1:]} {names[event[0]]}" for event in drawn.split()] for drawn in (before, now)]
    assert first_divergence(*chains, str) == told
