"""SPISTS without FIFOs: the causes that set and clear each flag, and the flags that request RXINT."""

from __future__ import annotations

import pytest

from tests.f28335.spi_rig import BIT, SpiRig

FOUR = {"SPICHAR": 3, "SPILBK": 1}  # characters of four bits, received as they are sent


@pytest.mark.rule("SPI-041", "SPI-042", "SPI-044", "SPI-049")
def test_int_flag_is_set_with_a_character_and_cleared_by_reading_it():
    SpiRig(**FOUR, SPIINTENA=1).check("""
        > SPITXBUF  .  5  . . . . . . . .  .  .
        > READ      .  .  . . . . . . . .  .  1
        < CLK       0  .  1 0 1 0 1 0 1 0  .  .
        < INT_FLAG  0  .  . . . . . . . 1  .  0
        < SPIRXBUF  0  .  . . . . . . . 5  .  .
        < RXINT     0  .  . . . . . . . 1  .  .
        < TXINT     0  .  . . . . . . . .  .  .
    """)


@pytest.mark.rule("SPI-045")
def test_without_spiintena_nothing_is_requested():
    rig = SpiRig(**FOUR, OVERRUNINTENA=1)
    rig.send(0x5000, 5)
    assert (rig.get("INT_FLAG"), rig.requested) == (1, {"RXINT": [], "TXINT": []})


@pytest.mark.rule("SPI-044")
def test_spiintena_set_later_requests_at_once():
    rig = SpiRig(**FOUR)
    rig.set(SPIINTENA=1)
    assert rig.requested["RXINT"] == []
    rig.set(SPIINTENA=0)
    rig.send(0x5000, 5)
    rig.set(SPIINTENA=1)
    rig.set(OVERRUNINTENA=1)  # its flag is 0
    assert rig.requested["RXINT"] == [rig.now]


@pytest.mark.rule("SPI-043")
def test_spirxemu_shows_the_character_and_leaves_int_flag():
    rig = SpiRig(**FOUR)
    rig.send(0x5000, 5)
    assert rig.read("SPIRXEMU") & 0xF == rig.peek("SPIRXBUF") & 0xF == 5
    assert rig.get("INT_FLAG") == 1
    assert rig.read("SPIRXBUF") & 0xF == 5
    assert rig.read("SPIRXEMU") & 0xF == 5
    assert rig.get("INT_FLAG") == 0


@pytest.mark.rule("SPI-046", "SPI-048")
def test_a_character_that_was_not_read_is_overwritten_and_requests_once():
    SpiRig(**FOUR, OVERRUNINTENA=1).check(
        """
        > SPITXBUF      1...  2...  ....  3...  .
        > READ          ....  ....  ....  .1..  .
        < SPIRXBUF      0...  1...  2...  ....  3
        < INT_FLAG      0...  1...  ....  .0..  1
        < OVERRUN_FLAG  0...  ....  1...  ....  .
        < RXINT         0...  ....  1...  ....  .
    """,
        BIT,
    )


@pytest.mark.rule("SPI-048")
def test_further_overruns_request_nothing_until_the_flag_was_cleared():
    rig = SpiRig(**FOUR, OVERRUNINTENA=1)
    counts = []
    for clear in (0, 0, 0, 1, 0):
        rig.send(0x5000, 6)
        counts.append(len(rig.requested["RXINT"]))
        if clear:
            rig.write("SPISTS", 0x80)
    assert counts == [0, 1, 1, 1, 2]


@pytest.mark.rule("SPI-046")
def test_an_overrun_needs_an_unread_character():
    rig = SpiRig(**FOUR)
    for _ in range(3):
        rig.send(0x5000, 6)
        rig.read("SPIRXBUF")
    assert rig.get("OVERRUN_FLAG") == 0


@pytest.mark.rule("SPI-047")
def test_overrun_flag_is_cleared_by_writing_1():
    rig = SpiRig(**FOUR)
    for _ in range(2):
        rig.send(0x5000, 6)
    rig.read("SPIRXBUF")
    states = []
    for value in (0x00, 0x7F, 0x80):
        rig.write("SPISTS", value)
        states.append(rig.get("OVERRUN_FLAG"))
    assert states == [1, 1, 0]


@pytest.mark.rule("SPI-047")
def test_writing_spists_leaves_int_flag_and_buffull_flag():
    rig = SpiRig(**FOUR)
    for word in (1, 2, 3):
        rig.send(word << 12, 4.5 if word == 1 else 0)
    rig.write("SPISTS", 0xFF)
    assert rig.flags("INT_FLAG", "BUFFULL_FLAG") == {"INT_FLAG": 1, "BUFFULL_FLAG": 1}


@pytest.mark.rule("SPI-024", "SPI-050", "SPI-051")
def test_the_first_character_is_shifted_at_once_and_the_second_waits():
    SpiRig(**FOUR).check("""
        > SPITXBUF      .  5  6 . . . . . . .  . . . . . . . .
        < BUFFULL_FLAG  0  .  1 . . . . . . 0  . . . . . . . .
        < INT_FLAG      0  .  . . . . . . . 1  . . . . . . . .
        < SPIRXBUF      0  .  . . . . . . . 5  . . . . . . . 6
    """)


@pytest.mark.rule("SPI-050")
def test_a_character_that_is_overwritten_in_spitxbuf_is_noted():
    rig = SpiRig(**FOUR)
    rig.write("SPITXBUF", *(word << 12 for word in (1, 2, 3)))
    assert rig.notes("lost") == ["SPI-A: SPITXBUF was written 0x3000 while BUFFULL_FLAG = 1: one character is lost"]
    rig.wait(9)
    assert (rig.show("SPIRXBUF"), rig.peek("SPITXBUF")) == (3, 0x3000)


def test_a_write_to_spidat_within_a_character_replaces_the_bits_not_yet_sent():
    rig = SpiRig(SPICHAR=3).check("""
        > SPITXBUF  .  0  . . . . . . . .  .
        > SPIDAT    .  .  . . . f . . . .  .
        < SIMO      0  .  . . . . 1 . . .  .
        < CLK       0  .  1 0 1 0 1 0 1 0  .
    """)
    assert rig.notes("lost") == ["SPI-A: SPIDAT was written 0xf000 while a character was in it: that one is lost"]
