"""The SPI as a slave: SPISTE, TALK, the words that it sends, and the limit of SPICLK."""

from __future__ import annotations

import pytest

from tests.f28335.spi_rig import HALF, LSPCLK, SCHEMES, SLAVE, SpiRig
from tests.waves import play, tidy

SELECTED = {
    0: """
        > SPITXBUF  a  .  . . . . . . . .  .
        > STE       1  0  . . . . . . . .  1
        > CLK       0  .  1 0 1 0 1 0 1 0  .
        > SIMO      0  .  . . 1 . . . . .  .
        < SOMI?     0  1  . . . . . . . .  0
        < SOMI      1  0  1 . 0 . 1 . 0 .  1
        < SPIDAT    0  .  . . . 1 . 3 . 7  .
        < INT_FLAG  0  .  . . . . . . . 1  .
    """,
    1: """
        > SPITXBUF  a  .  . . . . . . . .  .
        > STE       1  0  . . . . . . . .  1
        > CLK       0  .  1 0 1 0 1 0 1 0  .
        > SIMO      0  .  . 1 . . . . . .  .
        < SOMI?     0  1  . . . . . . . .  0
        < SOMI      1  .  . 0 . 1 . 0 . .  1
        < SPIDAT    0  .  . . 1 . 3 . 7 .  .
        < INT_FLAG  0  .  . . . . . . . 1  .
    """,
}


@pytest.mark.rule("SPI-011", "SPI-022", "SPI-023")
@pytest.mark.parametrize("phase", [0, 1])
def test_a_slave_follows_spiclk_while_spiste_is_low(phase):
    rig = SpiRig({}, SLAVE, CLK_PHASE=phase, SPICHAR=3)
    rig.pin(rig.now, CLK=0)
    assert play(SELECTED[phase], rig, HALF, rig.now) == tidy(SELECTED[phase])
    assert [rig.show(f"{pin}?") for pin in ("SIMO", "CLK", "STE")] == [0, 0, 0]


@pytest.mark.rule("SPI-022")
@pytest.mark.parametrize("scheme", SCHEMES)
def test_without_spiste_nothing_is_shifted(scheme):
    rig = SpiRig({}, SLAVE, CLKPOLARITY=scheme[0], CLK_PHASE=scheme[1])
    rig.write("SPITXBUF", 0x5A00)
    rig.pin(rig.now + 1, CLK=scheme[0])
    assert rig.clock("1" * 8) == [1] * 8
    assert rig.flags("SPIDAT", "INT_FLAG") == {"SPIDAT": 0x5A00, "INT_FLAG": 0}


def test_an_spiclk_edge_at_the_rise_of_spiste_counts_and_one_at_its_fall_does_not():
    rig = SpiRig({}, SLAVE, SPICHAR=0)
    rig.pin(rig.now + 1, CLK=1)
    rig.pin(rig.now + 8, CLK=0, STE=0)
    assert rig.get("INT_FLAG") == 0
    rig.pin(rig.now + 8, CLK=1)
    rig.pin(rig.now + 8, CLK=0, STE=1)
    assert rig.get("INT_FLAG") == 1


@pytest.mark.rule("SPI-019", "SPI-020", "SPI-021")
def test_talk_0_leaves_somi_undriven_and_receives():
    rig = SpiRig({}, SLAVE, SPIINTENA=1).select_idle()
    rig.write("SPITXBUF", 0)
    came = rig.clock("0110")
    rig.set(TALK=0)
    came += rig.clock("1001")
    assert came == [0] * 4 + [1] * 4
    assert (rig.read("SPIRXBUF"), len(rig.requested["RXINT"])) == (0x69, 1)
    rig.exchange(0x77)
    assert rig.read("SPIRXBUF") & 0xFF == 0x77


@pytest.mark.rule("SPI-023", "SPI-024", "SPI-051")
@pytest.mark.parametrize("phase", [0, 1])
def test_a_second_word_waits_in_spitxbuf_even_before_the_first_clock_edge(phase):
    rig = SpiRig({}, SLAVE, CLK_PHASE=phase).select_idle()
    full = []
    for word in (0x1200, 0x3400):
        rig.write("SPITXBUF", word)
        full.append(rig.get("BUFFULL_FLAG"))
    answers = [rig.exchange(0), rig.get("BUFFULL_FLAG"), rig.exchange(0)]
    assert (full, answers) == ([0, 1], [0x12, 0, 0x34])


@pytest.mark.parametrize("phase", [0, 1])
def test_a_slave_without_a_written_word_sends_the_value_in_spidat(phase):
    rig = SpiRig({}, SLAVE, CLK_PHASE=phase, SPICHAR=15).select_idle()
    assert [rig.exchange(word, 16) for word in (0x1234, 0x5678, 0)] == [0, 0x1234, 0x5678]


@pytest.mark.parametrize("phase", [0, 1])
def test_a_word_written_within_a_character_is_sent_after_it(phase):
    rig = SpiRig({}, SLAVE, CLK_PHASE=phase).select_idle()
    rig.clock("0000")
    rig.write("SPITXBUF", 0x8100)
    assert (rig.get("BUFFULL_FLAG"), rig.clock("0000")) == (1, [0] * 4)
    assert (rig.get("BUFFULL_FLAG"), rig.exchange(0)) == (0, 0x81)


@pytest.mark.rule("SPI-040")
def test_a_clock_above_a_quarter_of_lspclk_is_noted():
    for half, notes in ((2 * LSPCLK, []), (2 * LSPCLK - 1, ["14"])):
        rig = SpiRig({}, SLAVE).select_idle()
        rig.clock("10", half)
        texts = [
            f"SPI-A: a slave had an SPICLK period of {n} SYSCLKOUT cycles; at least four LSPCLK cycles are expected"
            for n in notes
        ]
        assert rig.notes("duty") == texts


def test_a_write_to_spidat_of_a_slave_shows_on_somi_before_the_first_edge():
    rig = SpiRig({}, SLAVE, CLK_PHASE=1).select_idle()
    shown = []
    for word in (0x8000, 0x0000):
        rig.write("SPIDAT", word)
        shown.append(rig.show("SOMI"))
    assert shown == [1, 0]
    assert rig.notes("lost") == ["SPI-A: SPIDAT was written 0x0000 while a character was in it: that one is lost"]
