"""The two FIFOs of the SPI: counts, levels, interrupts, overflow, resets, and the delay between words."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.f28335.spi_rig import BIT, FIFO, HALF, MASTER, SLAVE, SpiRig

LOOP = {"SPICHAR": 3, "SPILBK": 1}


def send(rig: SpiRig, *words: int) -> None:
    """Send four-bit characters through the loop-back, one after the other."""
    for word in words:
        rig.send(word << 12, 6)


@pytest.mark.rule("SPI-058", "SPI-059", "SPI-060", "SPI-075", "SPI-084", "SPI-085")
def test_txffst_and_rxffst_count_the_words():
    rig = SpiRig(fifo=True, **LOOP).check(
        """
        > SPITXBUF  .  1  2  3 . . .  . . . .  . . . .  .
        < TXFFST    0  .  1  2 . 1 .  . . 0 .  . . . .  .
        < RXFFST    0  .  .  . . 1 .  . . 2 .  . . 3 .  .
        < STE       1  0  .  . . . .  . . . .  . . 1 .  .
        < INT_FLAG  0  .  .  . . . .  . . . .  . . . .  .
    """,
        BIT,
    )
    assert rig.received(mask=0xF) == [1, 2, 3]


@pytest.mark.rule("SPI-058")
def test_fifo_mode_can_be_left_and_entered_again():
    rig = SpiRig(fifo=True, **LOOP)
    send(rig, 1, 2)
    rig.set(SPIFFENA=0)
    send(rig, 3)
    assert rig.flags("RXFFST", "INT_FLAG") == {"RXFFST": 2, "INT_FLAG": 1}
    assert rig.read("SPIRXBUF") & 0xF == 3
    rig.set(SPIFFENA=1)
    assert rig.received(mask=0xF) == [1, 2]


@pytest.mark.rule("SPI-058")
def test_spitxbuf_and_the_fifo_keep_their_words_when_spiffena_changes():
    rig = SpiRig({}, SLAVE, SPIRST=1, TXFIFO=1)
    rig.write("SPITXBUF", 0x3300)  # moves on to SPIDAT
    rig.write("SPITXBUF", 0x5500)
    rig.set(SPIFFENA=1)
    rig.write("SPITXBUF", 0xFF00)
    assert (rig.get("TXFFST"), rig.get("BUFFULL_FLAG"), rig.read("SPITXBUF")) == (1, 0, 0x5500)
    rig.set(SPIFFENA=0)
    assert (rig.get("TXFFST"), rig.get("BUFFULL_FLAG"), rig.read("SPITXBUF")) == (1, 1, 0x5500)
    assert rig.notes("lost") == []


@pytest.mark.rule("SPI-059", "SPI-061")
def test_sixteen_words_fit_beside_the_one_in_spidat():
    rig = SpiRig(fifo=True)
    rig.write("SPITXBUF", *(word << 8 for word in range(18)))
    assert rig.get("TXFFST") == 16
    assert rig.notes("lost") == ["SPI-A: SPITXBUF was written 0x1100 while TXFFST = 16: one word is lost"]
    rig.set(TXFIFO=0)
    rig.write("SPITXBUF", 0x5500)
    assert (rig.get("TXFFST"), rig.notes("lost")[1:]) == (
        0,
        ["SPI-A: SPITXBUF was written 0x5500 while a reset holds the transmit FIFO: it is lost"],
    )
    rig.wait(10)
    rig.set(TXFIFO=1)
    rig.write("SPITXBUF", *(word << 8 for word in range(3)))
    assert rig.get("TXFFST") == 2


@pytest.mark.rule("SPI-061")
def test_txfifo_0_leaves_the_character_that_is_being_sent():
    rig = SpiRig(fifo=True, **LOOP)
    rig.send(0x5000, 2)
    rig.set(TXFIFO=0)
    assert rig.received(wait=4, mask=0xF) == [5]


@pytest.mark.rule("SPI-062", "SPI-063", "SPI-064")
def test_txffint_is_set_when_the_count_falls_to_the_level():
    rig = SpiRig(fifo=True, **LOOP, TXFFIL=1, TXFFIENA=1, SPIINTENA=1)
    rig.requested["TXINT"].clear()  # the request at enabling the empty FIFO
    rig.check(
        """
        > SPITXBUF    .  1  2  3 . . . . . . . . . . . .  .
        > TXFFINTCLR  .  .  .  . 1 . . . . . . 1 . . . .  .
        < TXFFST      0  .  1  2 . 1 . . . 0 . . . . . .  .
        < TXFFINT     1  .  .  . 0 1 . . . . . . . . . .  .
        < TXINT       0  .  .  . . 1 . . . . . 2 . . . .  .
        < RXINT       0  .  .  . . . . . . . . . . . . .  .
    """,
        BIT,
    )


@pytest.mark.rule("SPI-062", "SPI-064")
@pytest.mark.parametrize("level", [0, 1, 7, 16, 31])
def test_txffint_for_each_level(level):
    rig = SpiRig(fifo=True, TXFFIL=level)
    seen = []
    for word in range(17):
        rig.write("SPITXBUF", word)
        rig.set(TXFFINTCLR=1)
        seen.append(rig.flags("TXFFST", "TXFFINT"))
    assert seen == [{"TXFFST": n, "TXFFINT": int(n <= level)} for n in range(17)]
    assert rig.requested["TXINT"] == []
    rig.set(TXFFIENA=1)
    assert len(rig.requested["TXINT"]) == (level >= 16)


@pytest.mark.rule("SPI-064")
def test_txffiena_set_together_with_spiffena_requests_at_once():
    rig = SpiRig()
    rig.write("SPIFFTX", 0xE020)
    assert len(rig.requested["TXINT"]) == 1


@pytest.mark.rule("SPI-064", "SPI-069")
@pytest.mark.parametrize(("register", "line", "value"), [("SPIFFTX", "TXINT", 0xA020), ("SPIFFRX", "RXINT", 0x2021)])
def test_fifo_mode_entered_with_a_flag_and_its_enable_requests(register, line, value):
    rig = SpiRig(fifo=True, **LOOP, RXFFIL=1)
    send(rig, 1)
    rig.set(SPIFFENA=0)
    rig.write(register, value)
    assert rig.requested[line] == []
    rig.set(SPIFFENA=1)
    assert rig.requested[line] == [rig.now]


@pytest.mark.rule("SPI-065", "SPI-067", "SPI-068", "SPI-069", "SPI-073")
def test_rxffint_is_set_when_the_count_rises_to_the_level():
    SpiRig(fifo=True, **LOOP, RXFFIL=2, RXFFIENA=1, SPIINTENA=1, OVERRUNINTENA=1).check(
        """
        > SPITXBUF    1  .....  2  .....  .  .  3  .....  .
        > RXFFINTCLR  .  .....  .  .....  .  .  .  .....  1
        > READ        .  .....  .  .....  1  1  .  .....  .
        < RXFFST      0  ...1.  .  ...2.  1  0  .  ...1.  .
        < RXFFINT     0  .....  .  ...1.  .  .  .  .....  0
        < RXINT       0  .....  .  ...1.  .  .  .  .....  .
    """,
        BIT,
    )


@pytest.mark.rule("SPI-067")
@pytest.mark.parametrize("level", [0, 1, 5, 16, 17, 31])
def test_rxffint_for_each_level(level):
    rig = SpiRig(fifo=True, **LOOP, RXFFIL=level)
    seen = []
    for word in range(17):
        rig.set(RXFFINTCLR=1)
        seen.append(rig.flags("RXFFST", "RXFFINT"))
        if word < 16:
            send(rig, word)
    assert seen == [{"RXFFST": n, "RXFFINT": int(n >= level)} for n in range(17)]
    assert rig.requested["RXINT"] == []
    rig.set(RXFFIENA=1)
    assert len(rig.requested["RXINT"]) == (level <= 16)


@pytest.mark.rule("SPI-065", "SPI-070", "SPI-071")
def test_the_first_word_is_lost_when_a_seventeenth_comes():
    rig = SpiRig(fifo=True, **LOOP)
    send(rig, *range(16))
    assert rig.flags("RXFFST", "RXFFOVF") == {"RXFFST": 16, "RXFFOVF": 0}
    rig.chip.loaded = 0
    send(rig, 5)
    assert rig.chip.loaded == 7 << 6
    rig.write("SPIFFRX", 0x201F)
    assert rig.flags("RXFFST", "RXFFOVF") == {"RXFFST": 16, "RXFFOVF": 1}
    rig.set(RXFFOVFCLR=1)
    assert rig.get("RXFFOVF") == 0
    assert rig.received(mask=0xF) == [*range(1, 16), 5]


@pytest.mark.rule("SPI-072")
def test_an_overflow_requests_rxint():
    rig = SpiRig(fifo=True, **LOOP, RXFFIENA=1)
    send(rig, *range(16))
    assert rig.requested["RXINT"] == []
    send(rig, 5)
    assert len(rig.requested["RXINT"]) == 1


@pytest.mark.rule("SPI-066")
def test_rxfiforeset_0_holds_the_receive_fifo_empty():
    rig = SpiRig(fifo=True, **LOOP, RXFFIL=0)
    send(rig, 1, 2)
    rig.set(RXFIFORESET=0)
    rig.set(RXFFINTCLR=1)
    rig.chip.loaded = 0
    send(rig, 3)
    assert rig.flags("RXFFST", "RXFFINT") == {"RXFFST": 0, "RXFFINT": 0}
    assert rig.chip.loaded == 1 << 8
    rig.set(RXFIFORESET=1)
    send(rig, 4)
    assert rig.get("RXFFINT") == 1
    assert rig.received(mask=0xF) == [4]


@pytest.mark.rule("SPI-065")
def test_spirxemu_reads_the_oldest_word_without_removing_it():
    rig = SpiRig(fifo=True, **LOOP)
    send(rig, 1, 2)
    assert [rig.read("SPIRXEMU") & 0xF for _ in range(3)] == [1, 1, 1]
    assert [rig.read("SPIRXBUF") & 0xF for _ in range(2)] == [1, 2]
    assert rig.read("SPIRXEMU") & 0xF == 2  # the last word again


@given(st.lists(st.tuples(st.sampled_from(["write", "wait", "read"]), st.integers(0, 15)), max_size=60))
@pytest.mark.rule("SPI-059", "SPI-060", "SPI-065", "SPI-085")
def test_no_word_is_lost_or_doubled(steps):
    """All words that are written and not lost are received in order."""
    rig = SpiRig(fifo=True, **LOOP)
    written: list[int] = []
    read: list[int] = []
    for step, n in steps:
        if step == "write":
            full = rig.get("TXFFST") == 16
            rig.write("SPITXBUF", n << 12)
            written += [] if full else [n]
        elif step == "wait":
            rig.wait(n)
        elif rig.get("RXFFST"):
            read.append(rig.read("SPIRXBUF") & 0xF)
        under_way = len(written) - len(read) - rig.get("TXFFST") - rig.get("RXFFST")
        assert rig.get("RXFFOVF") or under_way in (0, 1)
    rig.wait(4 * 18)
    if not rig.get("RXFFOVF"):
        assert read + rig.received(mask=0xF) == written


# TXDLY.


def gaps(rig: SpiRig) -> list[int]:
    """Return the pauses between characters in bits, from last edge to first edge minus half a bit."""
    edges = [time for (_, before), (time, after) in pairwise(rig.edges) if (before ^ after) & 4]
    return [(after - before - HALF) // BIT for before, after in pairwise(edges) if after - before > HALF]


@pytest.mark.rule("SPI-074", "SPI-075")
@pytest.mark.parametrize("delay", [0, 1, 5, 255])
def test_txdly_is_the_pause_between_words(delay):
    rig = SpiRig(fifo=True, **LOOP, TXDLY=delay)
    rig.write("SPITXBUF", *(word << 12 for word in (1, 2, 3)))
    rig.wait(3 * 4 + 2 * delay + 2)
    assert gaps(rig) == ([delay] * 2 if delay else [])
    assert rig.received(mask=0xF) == [1, 2, 3]
    assert rig.show("STE") == 1


@pytest.mark.rule("SPI-074")
@pytest.mark.parametrize("phase", [0, 1])
def test_a_word_stays_in_the_fifo_until_txdly_is_over(phase):
    rig = SpiRig(fifo=True, SPICHAR=1, CLK_PHASE=phase, TXDLY=1)
    rig.pin(rig.now, SOMI=0)
    rig.check(
        {
            0: """
            > SPITXBUF  8  c . . . . . . . . .  .
            < CLK       0  1 0 1 0 . . 1 0 1 0  .
            < SIMO      0  1 . 0 . . . 1 . . .  .
            < TXFFST    0  1 . . . . 0 . . . .  .
            < STE       0  . . . . . . . . . .  1
        """,
            1: """
            > SPITXBUF  8  c . . . . . . . . .  .
            < CLK       0  1 0 1 0 . . 1 0 1 0  .
            < SIMO      1  . 0 . . . 1 . . . 0  .
            < TXFFST    0  1 . . . . 0 . . . .  .
            < STE       0  . . . . . . . . . 1  .
        """,
        }[phase]
    )


def test_txdly_has_no_effect_without_fifos():
    rig = SpiRig(**LOOP, SPIFFCT=9)
    rig.write("SPITXBUF", *(word << 12 for word in (1, 2)))
    rig.wait(9)
    assert (gaps(rig), rig.get("OVERRUN_FLAG")) == ([], 1)


def test_txdly_has_no_effect_on_a_slave():
    rig = SpiRig({}, {**SLAVE, **FIFO, "SPIFFCT": 9}).select_idle()
    rig.write("SPITXBUF", 0x1200, 0x3400)
    assert [rig.get("TXFFST"), rig.exchange(0), rig.exchange(0), rig.get("TXFFST")] == [1, 0x12, 0x34, 0]


def test_words_written_to_the_fifo_during_spiswreset_are_sent_after_it():
    rig = SpiRig({}, {**MASTER, **FIFO, **LOOP, "SPISWRESET": 0})
    rig.write("SPITXBUF", *(word << 12 for word in (1, 2)))
    rig.wait(10)
    assert rig.flags("TXFFST", "RXFFST") == {"TXFFST": 2, "RXFFST": 0}
    rig.set(SPISWRESET=1)
    assert rig.received(wait=9, mask=0xF) == [1, 2]
