"""The SCI's transmitter in standard mode: SCITXBUF, TXSHF, TXRDY and TXEMPTY."""

from __future__ import annotations

import pytest

from tests.f28335.sci_rig import SciRig, frame, levels


@pytest.mark.rule("SCI-063", "SCI-064", "SCI-065", "SCI-069", "SCI-077")
def test_txrdy_and_txempty_while_one_character_is_sent():
    SciRig().check("""
        > SCITXBUF  .  3  ........  .  .  .
        < TXD       1  0  1.0.....  1  .  .
        < TXRDY     1  .  ........  .  .  .
        < TXEMPTY   1  0  ........  .  1  .
    """)


@pytest.mark.rule("SCI-066", "SCI-068", "SCI-069")
def test_a_second_character_waits_in_scitxbuf_and_follows_without_a_gap():
    rig = SciRig().check("""
        > SCITXBUF  .  3  .5......  .  .  ........  .  .  .
        < TXD       1  0  1.0.....  1  0  1010....  1  .  .
        < TXRDY     1  .  .0......  .  1  ........  .  .  .
        < TXEMPTY   1  0  ........  .  .  ........  .  1  .
    """)
    first, second = (start for start, _ in rig.frames(10))
    assert second - first == 10 * rig.bit


@pytest.mark.rule("SCI-063", "SCI-064")
def test_the_write_clears_txrdy_and_txempty_at_once():
    rig = SciRig()
    rig.write("SCITXBUF", 0x55)
    assert rig.flags("TXRDY", "TXEMPTY") == {"TXRDY": 0, "TXEMPTY": 0}


@pytest.mark.rule("SCI-065")
@pytest.mark.parametrize("phase", range(0, 100, 9))
def test_the_start_bit_begins_within_an_sciclk_and_txrdy_rises_with_it(phase):
    rig = SciRig()
    rig.wait(cycles=phase)
    written = rig.now
    rig.write("SCITXBUF", 0x55)
    ready = next(time for time, level in rig.changes("TXRDY", 2 * rig.sciclk) if level)
    assert rig.edges == [(ready, 0)]
    assert 0 <= ready - written <= rig.sciclk


@pytest.mark.rule("SCI-067")
def test_a_write_while_txrdy_is_0_replaces_the_waiting_character():
    rig = SciRig().put(0x11, 1)
    for word in (0x22, 0x33):
        rig.write("SCITXBUF", word)
        assert rig.get("TXRDY") == 0
    assert rig.characters(wait=40) == [0x11, 0x33]


@pytest.mark.rule("SCI-069")
@pytest.mark.parametrize(("stop_bits", "bits"), [(0, 10), (1, 11)])
def test_txempty_rises_at_the_end_of_the_last_stop_bit(stop_bits, bits):
    rig = SciRig(brr=3, STOPBITS=stop_bits)
    rig.write("SCITXBUF", 0x55)
    rose = [time for time, level in rig.changes("TXEMPTY", 14 * rig.bit) if level]
    assert rose == [rig.falls()[0] + bits * rig.bit]


@pytest.mark.rule("SCI-070")
def test_txempty_requests_no_interrupt():
    rig = SciRig(TXINTENA=1).put(0x55, 2)
    requested = rig.count("TXINT")
    rig.wait(20)
    assert rig.get("TXEMPTY") == 1
    assert rig.count("TXINT") == requested


@pytest.mark.parametrize(
    "reset",
    [
        pytest.param(
            lambda rig: rig.set(SWRESET=0), marks=pytest.mark.rule("SCI-071", "SCI-072", "SCI-202"), id="SW RESET"
        ),
        pytest.param(SciRig.reset, marks=pytest.mark.rule("SCI-073"), id="XRS"),
    ],
)
def test_a_reset_sets_txrdy_and_txempty_and_the_line_becomes_1(reset):
    rig = SciRig().put(0x00, 2)
    rig.write("SCITXBUF", 0x00)
    assert (rig.show("TXD"), rig.flags("TXRDY", "TXEMPTY")) == (0, {"TXRDY": 0, "TXEMPTY": 0})
    reset(rig)
    assert (rig.show("TXD"), rig.flags("TXRDY", "TXEMPTY")) == (1, {"TXRDY": 1, "TXEMPTY": 1})


@pytest.mark.rule("SCI-074", "SCI-077")
def test_without_txena_no_character_is_sent():
    SciRig().check("""
        > TXENA     0  .  ........  ........  1  ........  .  .
        > SCITXBUF  .  3  ........  ........  .  ........  .  .
        < TXD       1  .  ........  ........  0  1.0.....  1  .
        < TXRDY     1  0  ........  ........  1  ........  .  .
    """)


@pytest.mark.rule("SCI-075")
def test_a_character_is_completed_after_txena_is_cleared():
    SciRig().check("""
        > SCITXBUF  .  5  ........  .  .  ........
        > TXENA     .  .  ..0.....  .  .  ........
        < TXD       1  0  1010....  1  .  ........
        < TXEMPTY   1  0  ........  .  1  ........
    """)


@pytest.mark.rule("SCI-076")
def test_a_waiting_character_is_sent_after_txena_is_cleared():
    SciRig().check("""
        > SCITXBUF  .  5  3.......  .  .  ........  .  .
        > TXENA     .  .  ..0.....  .  .  ........  .  .
        < TXD       1  0  1010....  1  0  1.0.....  1  .
        < TXEMPTY   1  0  ........  .  .  ........  .  1
    """)


@pytest.mark.rule("SCI-077")
def test_the_idle_line_is_1():
    rig = SciRig()
    rig.wait(100)
    assert (rig.show("TXD"), rig.edges) == (1, [])


@pytest.mark.rule("SCI-078")
def test_both_directions_work_at_the_same_time_with_independent_timing():
    rig = SciRig(fifo=True)
    out, back = list(range(0x10, 0x20)), list(range(0xA0, 0xB0))
    rig.write("SCITXBUF", *out)
    rig.wait(sciclk=3)
    for word in back:
        rig.send(frame(word), bit=rig.bit * 1.02, at=rig.now)
    assert rig.characters(wait=5) == out
    assert rig.received() == back
    assert rig.peek("SCIRXST") == 0


def test_bits_above_the_eighth_of_a_written_word_are_ignored():
    rig = SciRig()
    assert rig.transmit(0xFF4B, 10) == levels("0 11010010 1")
