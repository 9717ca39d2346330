"""Sampling of RXD: the search for a start bit, majority votes, and synchronisation to the start of each frame.

In diagrams with one column per SCICLK, column n of a bit contains exactly its sub-sample n + 1.
"""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.f28335.sci_rig import SciRig, frame

BITS_OF_0X4B = "11010010"


def samples(text: str) -> str:
    """Return the levels of bits as levels of SCICLK periods."""
    return "".join(mark * 8 for mark in text.replace(" ", ""))


@pytest.mark.rule("SCI-028", "SCI-031", "SCI-032")
def test_a_bit_is_eight_sciclk_and_seven_of_the_stop_bit_show_rxrdy():
    rig = SciRig()
    rig.check(
        """
        > RXD   1 0....... 1....... 1....... 0....... 1....... 0....... 0....... 1....... 0....... 1....... 1
        < RXRDY 0 ........ ........ ........ ........ ........ ........ ........ ........ ........ .......1 .
    """,
        rig.sciclk,
    )
    assert rig.read("SCIRXBUF") == 0x4B


@pytest.mark.rule("SCI-029", "SCI-030")
@pytest.mark.parametrize(("low", "found"), [(1, 0), (2, 0), (3, 0), (4, 1), (5, 1), (8, 1)])
def test_a_start_bit_is_four_low_samples(low, found):
    rig = SciRig(fifo=True)
    rig.send_samples("1" + "0" * low + "1" * 90)
    assert rig.flags("RXFFST", "RXERROR") == {"RXFFST": found, "RXERROR": 0}


@pytest.mark.rule("SCI-030")
@pytest.mark.parametrize("high", [1, 2, 3])
def test_one_high_sample_restarts_the_search(high):
    # The first samples of the start bit are noisy; the frame counts from the first of four consecutive low samples.
    rig = SciRig(fifo=True)
    rig.send_samples("0" * high + "1" + samples("0" + BITS_OF_0X4B + "1") + "1" * 8)
    assert rig.received() == [0x4B]
    assert rig.peek("SCIRXST") == 0


@pytest.mark.rule("SCI-030")
def test_incomplete_start_bits_have_no_effect():
    rig = SciRig(fifo=True, RXERRINTENA=1, RXBKINTENA=1, RXFFIENA=1, RXFFIL=1)
    rig.send_samples("0001" * 40 + "1" * 90)
    assert (rig.get("RXFFST"), rig.get("RXERROR"), rig.count("RXINT")) == (0, 0, 0)


@pytest.mark.rule("SCI-031")
@pytest.mark.parametrize("late", range(9))
def test_bits_are_counted_from_the_first_low_sample(late):
    # A frame that begins `late` samples later is received equally, because only its own edge counts.
    rig = SciRig(fifo=True)
    rig.send_samples("1" * late + samples("0" + BITS_OF_0X4B + "1") + "1" * 8)
    assert rig.received() == [0x4B]


@pytest.mark.rule("SCI-031", "SCI-032", "SCI-035")
@pytest.mark.parametrize("level", ["0", "1"])
@pytest.mark.parametrize("place", range(1, 9))
def test_only_sub_samples_4_5_and_6_decide(place, level):
    other = "10"[int(level)]
    wrong_outside = other * 3 + level * 3 + other * 2
    drawn = samples("0") + "".join(
        wrong_outside if i == place else samples(mark) for i, mark in enumerate("10101010", 1)
    )
    rig = SciRig(fifo=True)
    rig.send_samples(drawn + samples("11"))
    wanted = 0x55 & ~(1 << place - 1) | int(level) << place - 1
    assert rig.received() == [wanted]


@pytest.mark.parametrize(
    "sub",
    [
        *(pytest.param(sub, marks=pytest.mark.rule("SCI-035")) for sub in (1, 2, 3, 7, 8)),
        *(pytest.param(sub, marks=pytest.mark.rule("SCI-033")) for sub in (4, 5, 6)),
    ],
)
def test_a_glitch_outside_the_votes_or_one_wrong_vote_of_three_changes_nothing(sub):
    rig = SciRig(fifo=True)
    rig.send(frame(0x4B) + "1", glitches=tuple((bit, sub) for bit in range(1, 9)))
    assert rig.received() == [0x4B]


@pytest.mark.rule("SCI-032", "SCI-034")
@pytest.mark.parametrize("subs", [(4, 5), (5, 6), (4, 6)])
@pytest.mark.parametrize("place", range(1, 9))
def test_two_wrong_votes_change_the_bit(place, subs):
    rig = SciRig(fifo=True)
    rig.send(frame(0x4B) + "1", glitches=tuple((place, sub) for sub in subs))
    assert rig.received() == [0x4B ^ 1 << place - 1]


@pytest.mark.rule("SCI-036")
@pytest.mark.parametrize(
    ("stop_bit", "fe"),
    [
        ("11111111", 0),
        ("11100011", 1),
        ("00011111", 0),
        ("11101111", 0),
        ("11110111", 0),
        ("11111011", 0),
        ("11100111", 1),
        ("11110011", 1),
        ("11101011", 1),
    ],
)
def test_the_stop_bit_is_voted_on_at_4_5_and_6(stop_bit, fe):
    rig = SciRig()
    rig.send_samples(samples("0" + BITS_OF_0X4B) + stop_bit + "1" * 8)
    assert rig.flags("RXRDY", "FE") == {"RXRDY": 1, "FE": fe}


@pytest.mark.rule("SCI-037")
def test_the_sampling_phase_is_within_one_sciclk_of_the_edge():
    rig = SciRig(brr=24)
    latencies = []
    for phase in range(0, rig.sciclk, 7):
        begin = rig.send("0 11010010", at=rig.align() + phase)
        rig.drive(rig.now, "RXD", 1)
        latencies.append(next(time for time, ready in rig.changes("RXRDY", 2 * rig.bit) if ready) - begin)
        rig.wait(2)
        rig.read("SCIRXBUF")
    assert rig.sciclk - 14 <= max(latencies) - min(latencies) < rig.sciclk


@pytest.mark.rule("SCI-037")
def test_the_receiver_synchronises_to_every_frame():
    # Each of ten frames has another phase than the one before, by a third of an SCICLK.
    rig = SciRig(fifo=True)
    for i in range(10):
        rig.send(frame(0x30 + i) + "1", at=rig.now + rig.sciclk // 3)
    assert rig.received() == [0x30 + i for i in range(10)]


@pytest.mark.rule("SCI-037", "SCI-038")
def test_frames_of_a_sender_with_a_rate_error_of_percents_are_received():
    # Without a gap, the stop bit of a fast sender must last until its second vote: 77 of 80 SCICLK, 3.75 % at worst.
    for skew in (0.965, 0.98, 1.0, 1.02, 1.04):
        rig = SciRig(fifo=True)
        for i in range(12):
            rig.send(frame(0x4B + i), bit=rig.bit * skew, at=rig.now)
        assert (skew, rig.received(wait=1)) == (skew, [0x4B + i for i in range(12)])
        assert rig.get("RXERROR") == 0


@pytest.mark.rule("SCI-038")
@pytest.mark.parametrize("second", range(0, 256, 5))
def test_frames_without_a_gap_are_all_received(second):
    rig = SciRig(brr=3, fifo=True).with_rxd(frame(0x4B) + frame(second) + frame(0xFF) + frame(0x00) + "1")
    assert rig.received() == [0x4B, second, 0xFF, 0x00]


@pytest.mark.rule("SCI-039", "SCI-044", "SCI-046")
def test_the_receiver_keeps_shifting_while_rxena_is_0():
    rig = SciRig().check("""
        > RXENA    0  .  ........  .  .  .  ........  .  .  .  ...1....  .  .
        > RXD      1  0  11010010  1  1  0  11010010  1  1  0  11010010  1  1
        < RXRDY    0  .  ........  .  .  .  ........  .  .  .  ........  1  .
    """)
    assert rig.read("SCIRXBUF") == 0x4B


@settings(max_examples=60, deadline=None)
@given(data=st.integers(0, 255), phase=st.integers(0, 799), skew=st.integers(-35, 35))
def test_any_byte_is_received_at_any_phase_and_up_to_three_and_a_half_percent_rate_error(data, phase, skew):
    rig = SciRig()
    rig.send(frame(data) + "1", bit=rig.bit * (1 + skew / 1000), at=rig.now + phase)
    rig.wait(1)
    assert rig.flags("RXRDY", "RXERROR", "RXDT") == {"RXRDY": 1, "RXERROR": 0, "RXDT": data}


@settings(max_examples=30, deadline=None)
@given(text=st.text("01", min_size=1, max_size=300))
def test_after_any_noise_and_ten_idle_bits_the_next_frame_is_received(text):
    rig = SciRig(fifo=True)
    rig.send_samples(text + "1" * 96)
    if rig.get("BRKDT"):
        return
    rig.received()
    rig.send(frame(0x5A) + "1")
    assert rig.received() == [0x5A]


def glitching(rig: SciRig, seed: int) -> None:
    """Make RXD change at random within each later cycle of an edge, before it has its final level."""
    chance, pins = random.Random(seed), rig.chip.pins

    def corrected(now: int, level: int) -> int:
        for wrong in chance.choices((0, 1), k=3):
            pins(now, wrong)
        return pins(now, level)

    rig.chip.pins = corrected


@settings(max_examples=40, deadline=None)
@given(data=st.lists(st.integers(0, 255), min_size=1, max_size=4), phase=st.integers(0, 799), seed=st.integers(0, 99))
def test_changes_of_rxd_within_a_cycle_have_no_effect(data, phase, seed):
    rig = SciRig(fifo=True)
    glitching(rig, seed)
    for byte in data:
        rig.send(frame(byte), at=rig.now + phase)
    assert rig.received(wait=1) == data and rig.get("RXERROR") == 0
