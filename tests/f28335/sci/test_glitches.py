"""The length and position that a glitch must have to change a bit.

sub-sample   1     2     3     4     5     6     7     8
tick         |     |     |     |     |     |     |     |       100 cycles apart, two cycles after the pin
vote                           ^     ^     ^
"""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.f28335.sci_rig import SciRig, frame

SYNC = 2  # cycles from the pin to the receiver
DATA = 0b0100_1011
BIT_3, BIT_6 = 1 << 3, 1 << 6  # of DATA, both 1
STOP = 9  # the bit's number in the frame, the start bit being 0


def received(place: int, begin: int, end: int) -> tuple[int, int]:
    """Return (word, FE) of a frame whose bit `place` is inverted from `begin` to `end`, cycles after its tick 1."""
    rig = SciRig()
    start = rig.now
    tick = start + place * rig.bit + rig.sciclk // 2
    level = int(frame(DATA)[place])
    edges = {start + i * rig.bit: int(mark) for i, mark in enumerate(frame(DATA))}
    edges |= {tick + begin: 1 - level, tick + end: level}
    for time in sorted(edges):
        rig.rxd(time, edges[time])
    rig.wait(15)
    return rig.get("RXDT"), rig.get("FE")


@pytest.mark.rule("SCI-031", "SCI-032", "SCI-033", "SCI-034", "SCI-035")
@pytest.mark.parametrize("pattern", range(256))
def test_a_bit_is_the_majority_of_its_three_samples_in_every_pattern(pattern: int):
    seen = f"{pattern:08b}"
    rig = SciRig()
    rig.send_samples("0" * 8 + "1" * 16 + "0" * 8 + seen + "0" * 16 + "1" * 8 + "0" * 8 + "1" * 16)
    voted = int(seen[3:6].count("1") >= 2)
    assert rig.flags("RXRDY", "RXDT", "FE") == {"RXRDY": 1, "RXDT": DATA & ~BIT_3 | voted << 3, "FE": 0}


@pytest.mark.rule("SCI-032", "SCI-033", "SCI-034")
@pytest.mark.parametrize(
    ("begin", "end", "flips"),
    [
        (
            300,
            401,
            True,
        ),  # sub-samples 4 and 5: one cycle longer than an SCICLK, the shortest glitch that flips the bit
        (301, 401, False),
        (300, 400, False),
        (400, 501, True),  # sub-samples 5 and 6
        (401, 501, False),
        (400, 500, False),
        (301, 500, False),  # sub-sample 5 alone, almost two SCICLK long
        (-40, 400, False),  # from the start of the bit to just before sub-sample 5
        (-40, 401, True),
        (401, 740, False),  # sub-sample 6 and all later ones
    ],
)
def test_a_glitch_flips_a_bit_if_it_covers_two_of_the_three_ticks(begin: int, end: int, flips: bool):
    assert received(4, begin - SYNC, end - SYNC)[0] == (DATA ^ BIT_3 if flips else DATA)


@pytest.mark.rule("SCI-036", "SCI-051")
@pytest.mark.parametrize(
    ("begin", "end", "fe"), [(300, 401, 1), (301, 401, 0), (400, 501, 1), (400, 500, 0), (200, 400, 0)]
)
def test_a_glitch_in_the_stop_bit_is_a_framing_error_if_it_covers_two_ticks(begin: int, end: int, fe: int):
    assert received(STOP, begin - SYNC, end - SYNC) == (DATA, fe)


@settings(max_examples=60, deadline=None)
@given(begin=st.integers(-48, 700), length=st.integers(1, 700))
def test_the_effect_of_any_glitch_depends_on_the_ticks_that_it_covers(begin: int, length: int):
    """Bit 6, which is between two zeros, is inverted in part; its first tick is half an SCICLK after its start."""
    end = min(begin + length, 706)
    covered = sum(begin <= tick < end for tick in (300, 400, 500))
    if begin >= end:
        return
    assert received(7, begin - SYNC, end - SYNC)[0] == (DATA ^ BIT_6 if covered >= 2 else DATA)


@pytest.mark.rule("SCI-029", "SCI-030")
@pytest.mark.parametrize(("length", "starts"), [(300, 0), (301, 1), (399, 1)])
def test_a_low_on_an_idle_line_is_a_start_bit_if_it_covers_four_ticks(length: int, starts: int):
    """The fall is in the cycle of a tick, so a low of 3 SCICLK and one cycle is enough."""
    rig = SciRig()
    first = rig.now + rig.sciclk // 2 - SYNC
    rig.rxd(first, 0)
    rig.rxd(first + length, 1)
    rig.wait(12)
    assert rig.flags("RXRDY", "RXDT") == {"RXRDY": starts, "RXDT": 0xFF * starts}


@pytest.mark.rule("SCI-029", "SCI-030")
@pytest.mark.parametrize(("length", "starts"), [(399, 0), (400, 1)])
def test_a_low_that_begins_just_after_a_tick_is_a_start_bit_from_four_sciclk_on(length: int, starts: int):
    rig = SciRig()
    missed = rig.now + rig.sciclk // 2 - SYNC + 1
    rig.rxd(missed, 0)
    rig.rxd(missed + length, 1)
    rig.wait(12)
    assert rig.get("RXRDY") == starts
