"""How two chains part: the event that moved most, and the first that differs."""

from __future__ import annotations

import pytest

from periph_sim.interfaces.reports.baselines.event_chain import EventLine, first_divergence, first_moved

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
        ("S1 W5 I9", "W6 S12 I30", f"{ENTER} 21 cycles later; first to differ: {START} 11 cycles later"),
        ("S0 W5", "S0 W5 W8", f"{WRITE} after 8 cycles, which is new"),
        ("S0 W5", "S0", f"{WRITE} is missing, which was after 5 cycles"),
        ("S0 W0", "S0", f"{WRITE} is missing, which was after 0 cycles"),
    ],
)
def test_what_is_told(before: str, now: str, told: str):
    assert first_divergence(lines(before), lines(now), str) == told


def lines(drawn: str) -> list[str]:
    names = {"S": START, "W": WRITE, "I": ENTER}
    return [f"{event[1:]} {names[event[0]]}" for event in drawn.split()]


@pytest.mark.parametrize(
    ("before", "now", "told"),
    [
        ("S0 W5", "S0 W7", ""),  # within the tolerance of two
        ("S0 W5", "S0 W3", ""),
        ("S0 W5", "S0 W8", f"{WRITE} 3 cycles later [f:1]"),
        ("S0 W5", "S0 W2", f"{WRITE} 3 cycles earlier [f:1]"),
        ("S0 W5 I9", "S0 W8 I20", f"{WRITE} 3 cycles later [f:1]"),
        ("S1 W5 I9", "W8 S12 I9", f"{START} 11 cycles later [f:1]"),
        ("S0 W5 W6", "S0 W6 W10", f"{WRITE} 4 cycles later [f:2]"),
        ("S0 W5", "S0 W5 W6", f"{WRITE} after 6 cycles, which is new [f:2]"),
        ("S0 W5", "S0 W5 W6 W7", f"{WRITE} after 6 cycles, which is new [f:2]"),
        ("S0 W5 I6", "S0 W5", f"{ENTER} is missing, which was after 6 cycles"),
    ],
)
def test_the_first_that_moved_beyond_the_tolerance_is_told_with_its_place(before: str, now: str, told: str):
    chain = EventLine(lines(now), ["", "f:1", "f:2", "f:3"])
    assert first_moved(lines(before), chain, str, 2) == told
