"""Autobaud: the baud divider is measured with a received 'A' or 'a'."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.f28335.sci.test_rx_sampling import glitching
from tests.f28335.sci_rig import SciRig, frame


def measuring(**fields: int) -> SciRig:
    """Return a rig whose module waits for its first character, set up as in the guide: BRR = 1, CDC = 1, ABD = 0."""
    return SciRig(brr=1, **{"CDC": 1, **fields})


def brr(rig: SciRig) -> int:
    return rig.get("SCIHBAUD") << 8 | rig.get("SCILBAUD")


@pytest.mark.rule("SCI-192", "SCI-193")
@pytest.mark.parametrize("letter", ["A", "a"])
@pytest.mark.parametrize("divider", [40, 80, 121, 243, 487])
def test_an_a_of_any_rate_sets_abd_and_the_divider(letter, divider):
    rig = measuring()
    rig.send(frame(ord(letter)) + "1", bit=32 * (divider + 1))
    assert (rig.get("ABD"), brr(rig)) == (1, divider)


@pytest.mark.rule("SCI-193")
@settings(max_examples=30, deadline=None)
@given(divider=st.integers(20, 2000), phase=st.integers(0, 63), letter=st.sampled_from("Aa"))
def test_the_divider_is_found_for_any_rate_at_any_phase(divider, phase, letter):
    rig = measuring()
    rig.send(frame(ord(letter)) + "1", bit=32 * (divider + 1), at=rig.now + phase)
    assert (rig.get("ABD"), brr(rig)) == (1, divider)


@pytest.mark.rule("SCI-193")
def test_abd_and_the_divider_change_in_the_same_cycle():
    rig = measuring()
    rig.send("0 1000001", bit=1312)
    rig.drive(rig.now, "RXD", 0)
    seen = [(rig.get("ABD"), brr(rig))]
    for cycle in range(3 * 1312):
        if cycle == 1312:
            rig.drive(rig.now, "RXD", 1)
        rig.wait(cycles=1)
        if (rig.get("ABD"), brr(rig)) != seen[-1]:
            seen.append((rig.get("ABD"), brr(rig)))
    assert seen == [(0, 1), (1, 40)]


@pytest.mark.rule("SCI-194")
@pytest.mark.parametrize("letter", [0x00, 0x01, 0x21, 0x40, 0x42, 0x43, 0x51, 0x55, 0x81, 0xC1, 0xE1, 0xFF])
def test_any_other_first_character_does_not_set_abd(letter):
    rig = measuring()
    rig.send(frame(letter) + "11", bit=1312)
    assert (rig.get("ABD"), rig.count("TXINT")) == (0, 0)


@pytest.mark.rule("SCI-194")
@pytest.mark.parametrize(("high", "abd"), [(6, 0), (8, 1)])
def test_abd_needs_a_stop_bit_that_is_high_for_seven_eighths(high, abd):
    rig = measuring()
    eighths = "".join(mark * 8 for mark in "0100000100"[:9]) + "1" * high + "0" * 16
    rig.send(eighths + "1" * 40, bit=164)
    assert rig.get("ABD") == abd


@pytest.mark.rule("SCI-195")
def test_without_cdc_nothing_is_measured():
    rig = measuring(CDC=0)
    rig.send(frame(ord("A")) + "11", bit=1312)
    assert (rig.get("ABD"), brr(rig), rig.count("TXINT")) == (0, 1, 0)


@pytest.mark.rule("SCI-196", "SCI-192")
def test_without_scirst_nothing_is_measured():
    rig = measuring(SCIRST=0)
    rig.send(frame(ord("A")) + "11", bit=1312)
    assert (rig.get("ABD"), brr(rig), rig.count("TXINT")) == (0, 1, 0)
    rig.set(SCIRST=1)
    rig.send(frame(ord("A")) + "11", bit=1312)
    assert (rig.get("ABD"), brr(rig)) == (1, 40)


@pytest.mark.rule("SCI-192", "SCI-199")
def test_while_abd_is_1_nothing_is_measured_again():
    rig = measuring()
    rig.send(frame(ord("A")) + "11", bit=1312)
    rig.send(frame(ord("A")) + "11", bit=2592)
    assert (rig.get("ABD"), brr(rig)) == (1, 40)
    rig.set(ABDCLR=1)
    assert (rig.get("ABD"), rig.get("CDC")) == (0, 1)


@pytest.mark.rule("SCI-197")
@pytest.mark.parametrize("fifo", [False, True])
def test_abd_requests_txint_without_any_enable(fifo):
    rig = measuring(SCIFFENA=int(fifo))
    assert rig.flags("TXINTENA", "TXFFIENA") == {"TXINTENA": 0, "TXFFIENA": 0}
    rig.send(frame(ord("A")) + "11", bit=1312)
    assert (rig.get("ABD"), rig.count("TXINT")) == (1, 1)


@pytest.mark.rule("SCI-198")
def test_cdc_left_1_gives_no_further_request():
    rig = measuring()
    rig.send(frame(ord("A")) + "11", bit=1312)
    for _ in range(3):
        rig.send(frame(ord("A")) + "11", bit=1312)
    rig.wait(cycles=100_000)
    assert rig.count("TXINT") == 1


@pytest.mark.rule("SCI-200")
@pytest.mark.parametrize("letter", ["A", "a"])
@pytest.mark.parametrize("fifo", [False, True])
def test_the_letter_itself_is_received_and_must_be_read(letter, fifo):
    rig = measuring(SCIFFENA=int(fifo))
    rig.send(frame(ord(letter)) + "1", bit=1312)
    if fifo:
        assert rig.get("RXFFST") == 1
    else:
        assert rig.get("RXRDY") == 1
    assert rig.read("SCIRXBUF") == ord(letter)
    assert rig.peek("SCIRXST") & 0b1011_1100 == 0


@pytest.mark.rule("SCI-193", "SCI-200")
def test_the_next_characters_are_received_and_sent_at_the_measured_rate():
    rig = measuring()
    rig.send(frame(ord("A")) + "1", bit=1312)
    rig.read("SCIRXBUF")
    rig.set(ABDCLR=1, CDC=0)
    rig.send(frame(0x4B) + "1", bit=1312)
    assert rig.flags("RXRDY", "RXDT") == {"RXRDY": 1, "RXDT": 0x4B}
    rig.put(0x55, cycles=20_000)
    assert {b - a for (a, _), (b, _) in pairwise(rig.edges)} == {1312}


@pytest.mark.rule("SCI-201")
@pytest.mark.parametrize(("divider", "duty"), [(1, 0), (9, 0), (40, 0), (8, 1), (3, 1)])
def test_a_faster_rate_before_the_measurement_is_noted(divider, duty):
    # The guide allows BRR = 1 and also any rate of at most 500 kbit/s: BRR = 9 gives 468.75 kbit/s.
    rig = SciRig(brr=divider)
    rig.set(CDC=1)
    rig.send(frame(ord("A")) + "11", bit=2592)
    assert len(rig.notes("duty")) == duty
    assert all("500" in text for text in rig.notes("duty"))


@pytest.mark.rule("SCI-193")
@settings(max_examples=30, deadline=None)
@given(before=st.integers(0, 255), letter=st.sampled_from("Aa"), seed=st.integers(0, 99))
def test_changes_of_rxd_within_a_cycle_are_not_measured(before, letter, seed):
    rig = measuring()
    glitching(rig, seed)
    rig.send(frame(before) + "1", bit=1312)
    rig.send(frame(ord(letter)) + "1", bit=1312)
    assert (rig.get("ABD"), brr(rig)) == (1, 40)
