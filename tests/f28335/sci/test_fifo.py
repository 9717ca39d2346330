"""The two FIFOs of the SCI: counts, levels, interrupts, overflow, resets, and the transfer delay."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.f28335.sci_rig import FIFO, SciRig, frame


def fill(rig: SciRig, words: range) -> None:
    for word in words:
        rig.send(frame(word))
    rig.wait(sciclk=2)


# Transmit.


@pytest.mark.rule("SCI-148", "SCI-150", "SCI-151", "SCI-154")
def test_txffst_counts_the_words():
    rig = SciRig(fifo=True).check("""
        > SCITXBUF  .  1  2.......  .  3  ........  .  .  ........  .  .
        < TXFFST    0  .  1.......  .  .  ........  .  0  ........  .  .
        < TXD       1  0  10......  1  0  .10.....  1  0  1.0.....  1  .
    """)
    assert rig.characters(wait=5) == [1, 2, 3]


@pytest.mark.rule("SCI-148")
def test_sciffena_turns_fifo_mode_on_and_off():
    rig = SciRig(fifo=True, TXENA=0)
    rig.write("SCITXBUF", 0x11)
    assert rig.get("TXFFST") == 1
    rig = SciRig(fifo=True, SCIFFENA=0, TXENA=0)
    rig.write("SCITXBUF", 0x11)
    assert rig.flags("TXFFST", "TXRDY") == {"TXFFST": 0, "TXRDY": 0}
    rig.send(frame(0x22) + "1")
    assert rig.flags("RXFFST", "RXRDY") == {"RXFFST": 0, "RXRDY": 1}


@pytest.mark.rule("SCI-148")
def test_fifo_mode_can_be_left_again():
    rig = SciRig(fifo=True).with_rxd(frame(0x11) + "1")
    rig.set(SCIFFENA=0)
    rig.send(frame(0x22) + "1")
    assert rig.flags("RXRDY", "RXDT") == {"RXRDY": 1, "RXDT": 0x22}
    rig.wait(1)
    assert rig.transmit(0x4B, 10) == frame(0x4B)


@pytest.mark.rule("SCI-148")
def test_scitxbuf_and_the_fifo_keep_their_words_when_sciffena_changes():
    rig = SciRig(fifo=True, SCIFFENA=0, TXENA=0).check("""
        > SCITXBUF  .  5  .  3  .  .  .........  .  .........
        > SCIFFENA  .  .  1  .  0  .  .........  1  .........
        > TXENA     .  .  .  .  .  1  .........  .  .........
        < TXFFST    0  .  .  1  .  .  .........  0  .........
        < TXRDY     1  0  1  .  0  1  .........  .  .........
        < TXD       1  .  .  .  .  0  1010....1  0  1.0.....1
    """)
    assert rig.notes("lost") == []


@pytest.mark.rule("SCI-149", "SCI-150", "SCI-152")
def test_the_transmit_fifo_holds_sixteen_words():
    rig = SciRig(fifo=True, TXENA=0)
    counts = []
    for word in range(17):
        rig.write("SCITXBUF", word)
        counts.append(rig.get("TXFFST"))
    assert counts == [*range(1, 17), 16]


@pytest.mark.rule("SCI-152", "SCI-153", "SCI-151")
def test_seventeen_words_fit_in_the_transmit_fifo_and_txshf():
    rig = SciRig(fifo=True).put(0x40, 1)
    assert rig.get("TXFFST") == 0
    rig.write("SCITXBUF", *range(0x41, 0x51))
    assert rig.get("TXFFST") == 16
    assert rig.characters(wait=17 * 10 + 2) == list(range(0x40, 0x51))
    assert rig.flags("TXFFST", "TXEMPTY") == {"TXFFST": 0, "TXEMPTY": 1}


@pytest.mark.rule("SCI-149")
def test_a_transmit_word_has_eight_bits():
    rig = SciRig(fifo=True).put(0xFF4B, 14)
    assert rig.characters() == [0x4B]


@pytest.mark.rule("SCI-153")
@settings(max_examples=20, deadline=None)
@given(words=st.lists(st.integers(0, 255), min_size=1, max_size=16))
def test_words_are_sent_in_the_order_written(words):
    rig = SciRig(brr=1, fifo=True)
    rig.write("SCITXBUF", *words)
    assert rig.characters(wait=10 * len(words) + 3) == words


@pytest.mark.rule("SCI-154")
def test_txffst_falls_when_the_previous_word_has_been_sent():
    rig = SciRig(brr=1, fifo=True)
    rig.write("SCITXBUF", *range(3))
    rig.wait(1)
    assert rig.get("TXFFST") == 2
    fell = [time for time, _ in rig.changes("TXFFST", 22 * rig.bit)]
    starts = [start for start, _ in rig.frames(10)]
    assert fell == starts[1:]
    assert starts[1] - starts[0] == 10 * rig.bit


@pytest.mark.rule("SCI-065")
def test_words_written_to_a_new_module_wait_for_txena():
    rig = SciRig(raw=True)
    rig.set(SCIFFENA=1)
    rig.write("SCITXBUF", 0x55)
    rig.set(SWRESET=1)
    rig.wait(20)
    assert (rig.edges, rig.get("TXFFST"), rig.chip.touched & {"txena_clear_drains"}) == ([], 1, set())


@pytest.mark.rule("SCI-155", "SCI-156")
def test_the_transmit_fifo_reset_empties_the_fifo_and_keeps_it_empty():
    rig = SciRig(fifo=True, TXENA=0)
    rig.write("SCITXBUF", *range(5))
    rig.set(TXFIFOXRESET=0)
    assert rig.get("TXFFST") == 0
    rig.write("SCITXBUF", 0x11)
    assert rig.get("TXFFST") == 0
    rig.set(TXFIFOXRESET=1)
    assert rig.get("TXFFST") == 0
    rig.write("SCITXBUF", 0x22)
    assert rig.get("TXFFST") == 1
    rig.set(TXENA=1)
    assert rig.characters(wait=25) == [0x22]


@pytest.mark.rule("SCI-160")
@pytest.mark.parametrize("enabled", [0, 1])
def test_enabling_the_fifos_requests_if_txffint_is_1_and_enabled(enabled):
    rig = SciRig(fifo=True, TXFFIENA=0)
    rig.set(SCIFFENA=0)
    rig.set(TXFFIENA=enabled)
    assert (rig.get("TXFFINT"), rig.count("TXINT")) == (1, 0)
    rig.set(SCIFFENA=1)
    assert (rig.get("TXFFINT"), rig.count("TXINT")) == (1, enabled)


@pytest.mark.rule("SCI-157", "SCI-158", "SCI-160")
def test_txffint_is_set_when_the_count_has_fallen_to_the_level():
    rig = SciRig(brr=1, fifo=True, TXENA=0)
    rig.write("SCITXBUF", *range(6))
    rig.set(TXFFIL=2, TXFFIENA=1, TXFFINTCLR=1)
    assert (rig.flags("TXFFST", "TXFFINT"), rig.count("TXINT")) == ({"TXFFST": 6, "TXFFINT": 0}, 0)
    at = {6: rig.get("TXFFINT")}
    rig.set(TXENA=1)
    for _ in range(60 * 8):
        rig.wait(sciclk=1)
        at.setdefault(rig.get("TXFFST"), rig.get("TXFFINT"))
    assert at == {6: 0, 5: 0, 4: 0, 3: 0, 2: 1, 1: 1, 0: 1}
    assert rig.count("TXINT") == 1


@pytest.mark.rule("SCI-157")
def test_txffint_is_set_at_once_by_an_empty_fifo():
    # A register dump of a related device shows this: 0xE040 was written, and 0xE080 was read.
    rig = SciRig(raw=True)
    rig.write("SCIFFTX", 0xE040)
    assert rig.read("SCIFFTX") == 0xE080


@pytest.mark.rule("SCI-159", "SCI-158")
def test_writing_1_to_txffintclr_clears_txffint():
    rig = SciRig(fifo=True, TXENA=0)
    assert rig.get("TXFFINT") == 1
    rig.write("SCITXBUF", 0x11)
    assert rig.get("TXFFINT") == 1
    rig.set(TXFFINTCLR=1)
    assert rig.get("TXFFINT") == 0


@pytest.mark.rule("SCI-160")
@pytest.mark.parametrize("enabled", [0, 1])
def test_txffiena_enables_the_request_of_txffint(enabled):
    rig = SciRig(fifo=True, TXENA=0)
    rig.write("SCITXBUF", 0x11)
    rig.set(TXFFINTCLR=1, TXFFIENA=enabled)
    assert rig.count("TXINT") == 0
    rig.set(TXENA=1)
    rig.wait(2)
    assert (rig.get("TXFFINT"), rig.count("TXINT")) == (1, enabled)


@pytest.mark.rule("SCI-160")
def test_a_handler_that_refills_and_clears_is_requested_once_per_batch():
    rig = SciRig(fifo=True, TXFFIL=0)
    rig.write("SCITXBUF", 0x11)
    rig.write("SCITXBUF", 0x22)
    rig.set(TXFFINTCLR=1, TXFFIENA=1)
    for batch in range(1, 4):
        rig.wait(25)
        assert rig.count("TXINT") == batch
        rig.write("SCITXBUF", 0x11)
        rig.write("SCITXBUF", 0x22)
        rig.set(TXFFINTCLR=1)


@pytest.mark.rule("SCI-161")
def test_in_fifo_mode_txrdy_requests_nothing():
    rig = SciRig(fifo=True, TXINTENA=1)
    rig.write("SCITXBUF", *range(3))
    rig.wait(40)
    rig.set(TXINTENA=0)
    rig.set(TXINTENA=1)
    assert rig.count("TXINT") == 0


@pytest.mark.rule("SCI-162", "SCI-164")
def test_scirst_0_stops_both_channels_and_1_resumes_them():
    rig = SciRig(fifo=True)
    rig.write("SCITXBUF", 0x00, 0x11)
    rig.send("0 1101")
    assert rig.show("TXD") == 0
    rig.set(SCIRST=0)
    assert rig.show("TXD") == 1
    edges = len(rig.edges)
    rig.send("0010 1" + "1" * 12 + frame(0x33) + "11")
    assert (rig.get("RXFFST"), len(rig.edges)) == (0, edges)
    rig.set(SCIRST=1)
    rig.set(TXFIFOXRESET=0, RXFIFORESET=0)
    rig.set(TXFIFOXRESET=1, RXFIFORESET=1)
    rig.wait(1)
    assert rig.transmit(0x44, 10) == frame(0x44)
    rig.send(frame(0x55) + "1")
    assert rig.received() == [0x55]


@pytest.mark.rule("SCI-163")
def test_scirst_leaves_the_configuration():
    kept = {
        "SCIFFENA": 1,
        "TXFIFOXRESET": 1,
        "RXFIFORESET": 1,
        "TXFFIENA": 1,
        "TXFFIL": 5,
        "RXFFIENA": 1,
        "RXFFIL": 9,
        "FFTXDLY": 0x77,
    }
    rig = SciRig(fifo=True, **{n: v for n, v in kept.items() if n not in FIFO})
    rig.set(SCIRST=0)
    assert rig.flags(*kept) == kept
    rig.set(SCIRST=1)
    assert rig.flags(*kept) == kept


# Receive.


@pytest.mark.rule("SCI-166", "SCI-167")
def test_rxffst_counts_the_words():
    SciRig(fifo=True).check("""
        > RXD     1  0  11010010  1  0  10100101  1  1  1  1
        > READ    .  .  ........  .  .  ........  .  1  1  .
        < RXFFST  0  .  ........  1  .  ........  2  1  0  .
    """)


@pytest.mark.rule("SCI-165", "SCI-166", "SCI-167")
def test_the_receive_fifo_holds_sixteen_words_in_order():
    rig = SciRig(fifo=True)
    fill(rig, range(0x40, 0x50))
    assert rig.flags("RXFFST", "RXFFOVF") == {"RXFFST": 16, "RXFFOVF": 0}
    for left, word in zip(range(15, -1, -1), range(0x40, 0x50), strict=True):
        assert (rig.read("SCIRXBUF"), rig.get("RXFFST")) == (word, left)


@pytest.mark.rule("SCI-168")
def test_scirxemu_reads_the_oldest_word_without_removing_it():
    rig = SciRig(fifo=True)
    fill(rig, range(0x40, 0x43))
    assert [rig.read("SCIRXEMU") for _ in range(3)] == [0x40, 0x40, 0x40]
    assert rig.get("RXFFST") == 3
    rig.read("SCIRXBUF")
    assert (rig.read("SCIRXEMU"), rig.get("RXFFST")) == (0x41, 2)


@pytest.mark.rule("SCI-165", "SCI-169", "SCI-170")
def test_each_word_carries_its_own_error_marks():
    rig = SciRig(fifo=True, PARITYENA=1).with_rxd(frame(0x11, parity="odd") + frame(0x22, parity="odd", bad="parity"))
    rig.send(frame(0x33, parity="odd", bad="stop") + "1" + frame(0x44, parity="odd"))
    rig.wait(1)
    assert rig.flags("SCIFFFE", "SCIFFPE") == {"SCIFFFE": 0, "SCIFFPE": 0}
    assert rig.received() == [0x0011, 0x4022, 0x8033, 0x0044]


@pytest.mark.rule("SCI-171")
def test_without_the_fifo_the_error_marks_read_0():
    rig = SciRig(PARITYENA=1).with_rxd(frame(0x33, parity="even", bad="stop") + "1")
    assert rig.flags("FE", "PE") == {"FE": 1, "PE": 1}
    assert rig.read("SCIRXBUF") == 0x0033


@pytest.mark.rule("SCI-172", "SCI-173")
def test_the_receive_fifo_reset_empties_the_fifo_and_keeps_it_empty():
    rig = SciRig(fifo=True)
    fill(rig, range(3))
    rig.set(RXFIFORESET=0)
    assert rig.get("RXFFST") == 0
    fill(rig, range(0x10, 0x12))
    assert rig.get("RXFFST") == 0
    rig.set(RXFIFORESET=1)
    assert rig.get("RXFFST") == 0
    fill(rig, range(0x20, 0x22))
    assert rig.received() == [0x20, 0x21]


@pytest.mark.rule("SCI-174", "SCI-175", "SCI-177")
@pytest.mark.parametrize("level", [1, 2, 5, 16])
def test_rxffint_is_set_when_the_count_reaches_the_level(level):
    rig = SciRig(brr=3, fifo=True, RXFFIL=level, RXFFIENA=1)
    for count in range(1, 17):
        fill(rig, range(count, count + 1))
        reached = int(count >= level)
        assert (count, rig.flags("RXFFINT"), rig.count("RXINT")) == (count, {"RXFFINT": reached}, reached)


@pytest.mark.rule("SCI-175")
def test_with_the_reset_level_of_31_rxffint_is_never_set():
    rig = SciRig(fifo=True, RXFFIENA=1)
    assert rig.get("RXFFIL") == 31
    fill(rig, range(20))
    assert (rig.get("RXFFINT"), rig.count("RXINT")) == (0, 0)


@pytest.mark.rule("SCI-174")
def test_a_level_of_0_is_reached_as_soon_as_the_fifos_are_on():
    rig = SciRig(fifo=True, SCIFFENA=0, RXFFIL=0, RXFFIENA=1)
    assert (rig.get("RXFFINT"), rig.count("RXINT")) == (0, 0)
    rig.set(SCIFFENA=1)
    assert (rig.get("RXFFINT"), rig.count("RXINT")) == (1, 1)


@pytest.mark.rule("SCI-176")
def test_writing_1_to_rxffintclr_clears_rxffint():
    rig = SciRig(fifo=True, RXFFIL=2, RXFFIENA=1)
    fill(rig, range(2))
    rig.received()
    assert rig.get("RXFFINT") == 1
    rig.set(RXFFINTCLR=1)
    assert rig.get("RXFFINT") == 0
    fill(rig, range(2))
    assert (rig.get("RXFFINT"), rig.count("RXINT")) == (1, 2)


@pytest.mark.rule("SCI-176")
def test_without_the_clear_no_further_request_comes():
    rig = SciRig(fifo=True, RXFFIL=1, RXFFIENA=1)
    for data in range(4):
        fill(rig, range(data, data + 1))
        rig.received()
    assert rig.count("RXINT") == 1


@pytest.mark.rule("SCI-177")
def test_without_rxffiena_rxffint_requests_nothing():
    rig = SciRig(fifo=True, RXFFIL=1, RXFFIENA=0)
    fill(rig, range(3))
    assert (rig.get("RXFFINT"), rig.count("RXINT")) == (1, 0)


@pytest.mark.rule("SCI-178", "SCI-179", "SCI-181")
def test_the_seventeenth_word_sets_rxffovf_and_removes_the_oldest():
    rig = SciRig(fifo=True)
    fill(rig, range(0x40, 0x50))
    assert rig.get("RXFFOVF") == 0
    fill(rig, range(0x50, 0x51))
    assert rig.flags("RXFFOVF", "RXFFST") == {"RXFFOVF": 1, "RXFFST": 16}
    rig.set(RXFFOVRCLR=1)
    assert rig.flags("RXFFOVF", "RXFFST") == {"RXFFOVF": 0, "RXFFST": 16}
    assert rig.received() == list(range(0x41, 0x51))


@pytest.mark.rule("SCI-181")
def test_only_its_clear_bit_clears_rxffovf():
    rig = SciRig(fifo=True)
    fill(rig, range(17))
    rig.received()
    rig.set(RXFFINTCLR=1)
    assert rig.get("RXFFOVF") == 1


@pytest.mark.rule("SCI-180")
def test_rxffovf_requests_no_interrupt():
    rig = SciRig(fifo=True, RXFFIENA=1, RXFFIL=31)
    fill(rig, range(18))
    assert (rig.get("RXFFOVF"), rig.count("RXINT")) == (1, 0)


@pytest.mark.rule("SCI-182", "SCI-141")
@pytest.mark.parametrize("enabled", [0, 1])
def test_in_fifo_mode_rxerror_requests_if_rx_err_int_ena_is_1(enabled):
    rig = SciRig(fifo=True, RXERRINTENA=enabled, RXFFIENA=0, RXBKINTENA=0).with_rxd(frame(0x11, bad="stop") + "1")
    assert (rig.get("RXERROR"), rig.count("RXINT")) == (1, enabled)


@pytest.mark.rule("SCI-183")
def test_in_fifo_mode_rx_bk_int_ena_enables_no_request_of_a_break():
    rig = SciRig(fifo=True, RXBKINTENA=1).with_rxd("0" * 25 + "1")
    assert (rig.get("BRKDT"), rig.count("RXINT")) == (1, 0)


@pytest.mark.rule("SCI-183")
def test_in_fifo_mode_rx_err_int_ena_enables_the_request_of_a_break():
    # in sleep, so that FE has not set RXERROR before
    rig = SciRig(fifo=True, RXERRINTENA=1, ADDRIDLE_MODE=1, SLEEP=1).with_rxd("0" * 25 + "1")
    assert (rig.flags("BRKDT", "FE"), rig.count("RXINT")) == ({"BRKDT": 1, "FE": 0}, 1)


@pytest.mark.rule("SCI-184")
def test_in_fifo_mode_rx_bk_int_ena_enables_no_request_of_a_character():
    rig = SciRig(fifo=True, RXBKINTENA=1)
    fill(rig, range(3))
    assert rig.count("RXINT") == 0


@pytest.mark.rule("SCI-185")
def test_in_fifo_mode_rxrdy_stays_0():
    rig = SciRig(fifo=True)
    fill(rig, range(3))
    assert rig.flags("RXRDY", "RXFFST") == {"RXRDY": 0, "RXFFST": 3}


@pytest.mark.rule("SCI-186")
def test_in_fifo_mode_oe_means_overflow():
    rig = SciRig(fifo=True)
    fill(rig, range(16))
    assert rig.get("OE") == 0
    fill(rig, range(1))
    assert rig.get("OE") == 1


# The transfer delay.


def gap(rig: SciRig, words: int = 3) -> list[int]:
    """Return the pauses in cycles from the last stop bit of a word to the start bit of the next."""
    rig.write("SCITXBUF", *range(words))
    rig.wait(words * (10 + 1) + words * 257)
    starts = [start for start, _ in rig.frames(10)]
    return [b - a - 10 * rig.bit for a, b in pairwise(starts)]


@pytest.mark.rule("SCI-187", "SCI-188", "SCI-189", "SCI-154")
@pytest.mark.parametrize("delay", [0, 1, 2, 10, 254, 255])
def test_the_delay_is_the_pause_between_two_words(delay):
    rig = SciRig(brr=3, fifo=True, FFTXDLY=delay)
    assert gap(rig) == [delay * rig.bit] * 2


@pytest.mark.rule("SCI-187", "SCI-151")
def test_during_the_delay_the_word_is_still_in_the_fifo():
    SciRig(fifo=True, FFTXDLY=3).check("""
        > SCITXBUF  .  1  2.......  .  ...  .  ........  .  ....
        < TXD       1  0  10......  1  ...  0  .10.....  1  ....
        < TXFFST    0  .  1.......  .  ...  0  ........  .  ....
    """)


@pytest.mark.rule("SCI-187")
def test_a_delay_written_during_a_word_applies_to_the_pause_after_it():
    rig = SciRig(fifo=True, FFTXDLY=3)
    rig.write("SCITXBUF", 0x11)
    rig.put(0x22, 4)
    rig.set(FFTXDLY=7)
    rig.wait(30)
    one, two = (start for start, _ in rig.frames(10))
    assert two - one == (10 + 7) * rig.bit


@pytest.mark.rule("SCI-190")
@pytest.mark.parametrize("delay", [1, 200])
def test_a_word_written_to_an_idle_fifo_starts_at_once(delay):
    rig = SciRig(fifo=True, FFTXDLY=delay)
    for _ in range(2):
        written = rig.now
        seen = len(rig.edges)
        rig.put(0x11, 12)
        assert rig.edges[seen][0] - written <= rig.sciclk
        rig.wait(300)


@pytest.mark.rule("SCI-191")
def test_in_standard_mode_there_is_no_delay():
    rig = SciRig(FFTXDLY=100).put(0x11, 1)
    rig.put(0x22, 25)
    first, second = (start for start, _ in rig.frames(10))
    assert second - first == 10 * rig.bit


@pytest.mark.parametrize(
    ("held", "note"),
    [
        (
            {"TXFIFOXRESET": 0},
            "SCI-A: SCITXBUF was written while TXFIFOXRESET = 0 holds the transmit FIFO: the word is lost",
        ),
        ({"SCIRST": 0}, "SCI-A: SCITXBUF was written while SCIRST = 0 holds the transmit channel: the word is lost"),
        ({}, None),
    ],
)
def test_a_word_written_to_a_transmit_fifo_in_reset_is_lost_and_noted_each_time(held, note):
    rig = SciRig(fifo=True)
    rig.set(**held)
    rig.write("SCITXBUF", 0x55, 0x55)
    assert rig.notes("lost") == ([note, note] if note else [])
    assert rig.get("TXFFST") == (0 if note else 2)
    rig.set(TXFIFOXRESET=1, SCIRST=1)
    rig.wait(30)
    assert bool(rig.edges) == (note is None)
