"""Pins of an SPI master: the four schemes of SPICLK, rates, the longer half period of odd dividers, and SPISTE."""

from __future__ import annotations

from itertools import pairwise

import pytest

from tests.f28335.spi_rig import HALF, LSPCLK, SCHEMES, SpiRig
from tests.waves import play, tidy

# Columns are half bits of 1010, which is written in the first column.
SCHEME = {
    (0, 0): """
        > SPITXBUF  .  a  . . . . . . . . .  .
        < STE       1  0  . . . . . . . . 1  .
        < CLK       0  .  1 0 1 0 1 0 1 0 .  .
        < SIMO      0  .  1 . 0 . 1 . 0 . .  .
        < INT_FLAG  0  .  . . . . . . . 1 .  .
    """,
    (0, 1): """
        > SPITXBUF  .  a  . . . . . . . . .  .
        < STE       1  0  . . . . . . . 1 .  .
        < CLK       0  .  1 0 1 0 1 0 1 0 .  .
        < SIMO      0  1  . 0 . 1 . 0 . . .  .
        < INT_FLAG  0  .  . . . . . . . 1 .  .
    """,
    (1, 0): """
        > SPITXBUF  .  a  . . . . . . . . .  .
        < STE       1  0  . . . . . . . . 1  .
        < CLK       1  .  0 1 0 1 0 1 0 1 .  .
        < SIMO      0  .  1 . 0 . 1 . 0 . .  .
        < INT_FLAG  0  .  . . . . . . . 1 .  .
    """,
    (1, 1): """
        > SPITXBUF  .  a  . . . . . . . . .  .
        < STE       1  0  . . . . . . . 1 .  .
        < CLK       1  .  0 1 0 1 0 1 0 1 .  .
        < SIMO      0  1  . 0 . 1 . 0 . . .  .
        < INT_FLAG  0  .  . . . . . . . 1 .  .
    """,
}


@pytest.mark.rule("SPI-010", "SPI-013", "SPI-018")
@pytest.mark.parametrize(
    "scheme",
    [
        pytest.param((0, 0), marks=pytest.mark.rule("SPI-032", "SPI-039")),
        pytest.param((0, 1), marks=pytest.mark.rule("SPI-033")),
        pytest.param((1, 0), marks=pytest.mark.rule("SPI-034", "SPI-039")),
        pytest.param((1, 1), marks=pytest.mark.rule("SPI-035")),
    ],
)
def test_pins_in_each_clocking_scheme(scheme):
    SpiRig(CLKPOLARITY=scheme[0], CLK_PHASE=scheme[1], SPICHAR=3).check(SCHEME[scheme])


# The master latches 1 0 1 from SOMI, which changes midway between two latching edges.
LATCHES = {
    0: """
        > SPITXBUF  7  . . . . . . .  .
        > SOMI      1  . . 0 . 1 . .  .
        < CLK       0  1 0 1 0 1 0 .  .
        < SPIDAT    0  . 1 . 2 . 5 .  .
    """,
    1: """
        > SPITXBUF  7  . . . . . . .  .
        > SOMI      1  . 0 . 1 . . .  .
        < CLK       0  1 0 1 0 1 0 .  .
        < SPIDAT    0  1 . 2 . 5 . .  .
    """,
}


@pytest.mark.rule("SPI-032", "SPI-033")
@pytest.mark.parametrize("phase", [0, 1])
def test_the_master_latches_at_the_edge_opposite_to_the_output_edge(phase):
    rig = SpiRig(CLK_PHASE=phase, SPICHAR=2)
    assert play(LATCHES[phase], rig, HALF, rig.now) == tidy(LATCHES[phase])


# Columns are LSPCLK cycles; with SPIBRR = 4, a bit has five of them: two active and three inactive.
ODD = {
    (0, 0): """
        > SPITXBUF  a ..  .. ... .. ...  .
        < STE       0 ..  .. ... .. ...  1
        < CLK       0 ..  1. 0.. 1. 0..  .
        < SIMO      0 ..  1. ... 0. ...  .
    """,
    (0, 1): """
        > SPITXBUF  a ..  .. ... .. ...  .
        < STE       0 ..  .. ... .. 1..  .
        < CLK       0 ..  1. 0.. 1. 0..  .
        < SIMO      1 ..  .. 0.. .. 1..  .
    """,
    (1, 0): """
        > SPITXBUF  a ..  .. ... .. ...  .
        < STE       0 ..  .. ... .. ...  1
        < CLK       1 ..  0. 1.. 0. 1..  .
        < SIMO      0 ..  1. ... 0. ...  .
    """,
    (1, 1): """
        > SPITXBUF  a ..  .. ... .. ...  .
        < STE       0 ..  .. ... .. 1..  .
        < CLK       1 ..  0. 1.. 0. 1..  .
        < SIMO      1 ..  .. 0.. .. 1..  .
    """,
}


@pytest.mark.rule("SPI-037", "SPI-038")
@pytest.mark.parametrize("scheme", SCHEMES)
def test_pins_with_an_odd_divider(scheme):
    rig = SpiRig(CLKPOLARITY=scheme[0], CLK_PHASE=scheme[1], SPICHAR=1, SPIBRR=4)
    assert play(ODD[scheme], rig, LSPCLK, rig.now) == tidy(ODD[scheme])


def clock_edges(rig: SpiRig) -> list[int]:
    rig.write("SPITXBUF", 0xFFFF)
    rig.run_until(rig.now + 128 * LSPCLK * 18)
    edges = []
    for (_, before), (time, after) in pairwise(rig.edges):
        if (before ^ after) & 4:
            edges.append(time)
    return edges[-32:]


@pytest.mark.rule("SPI-029", "SPI-030", "SPI-036")
@pytest.mark.parametrize(
    ("brr", "first", "second"), [(0, 2, 2), (1, 2, 2), (2, 2, 2), (3, 2, 2), (4, 2, 3), (5, 3, 3), (127, 64, 64)]
)
def test_the_rate_depends_on_spibrr(brr, first, second):
    rig = SpiRig(SPIBRR=brr, SPICHAR=15)
    edges = clock_edges(rig)
    pulses = [(after - before) // LSPCLK for before, after in pairwise(edges)]
    assert pulses == [first, second] * 15 + [first]


@pytest.mark.rule("SPI-029")
@pytest.mark.parametrize("divider", [1, 2, 4, 6, 8, 10, 12, 14])
def test_the_rate_follows_lspclk(divider):
    rig = SpiRig(SPIBRR=3)
    rig.chip.set_lspclk(rig.now, divider, 1)
    rig.send(0, 20 * divider)
    edges = [time for (_, before), (time, after) in pairwise(rig.edges) if (before ^ after) & 4][-16:]
    assert [after - before for before, after in pairwise(edges)] == [2 * divider] * 15
    assert edges[0] % divider == 1 % divider


@pytest.mark.parametrize("divider", [0, 3, 5, 15, 16])
def test_other_dividers_of_lspclk_are_refused(divider):
    with pytest.raises(ValueError, match=f"LSPCLK is SYSCLKOUT / 1, 2, 4, 6, 8, 10, 12 or 14, not / {divider}"):
        SpiRig().chip.set_lspclk(100, divider, 0)


def test_a_change_of_lspclk_keeps_the_lspclk_cycles_to_the_next_edge():
    rig = SpiRig(SPIBRR=9)
    rig.write("SPITXBUF", 0)
    rig.run_until(rig.now + 1 + 2 * LSPCLK)  # SPISTE fell two LSPCLK cycles ago; SPICLK rises in three
    rig.chip.set_lspclk(rig.now, 10, rig.now)
    rig.run_until(rig.now + 29)
    before = rig.show("CLK")
    rig.run_until(rig.now + 1)
    assert (before, rig.show("CLK")) == (0, 1)


# Two characters of two bits, 10 and 01; the second is written while the first is sent.
BACK_TO_BACK = {
    0: """
        > SPITXBUF      8  . 4 . .  . . . .  . .
        < STE           0  . . . .  . . . .  1 .
        < CLK           0  1 0 1 0  1 0 1 0  . .
        < SIMO          0  1 . 0 .  . . 1 .  . .
        < BUFFULL_FLAG  0  . 1 . 0  . . . .  . .
    """,
    1: """
        > SPITXBUF      8  . 4 . .  . . . .  . .
        < STE           0  . . . .  . . . 1  . .
        < CLK           0  1 0 1 0  1 0 1 0  . .
        < SIMO          1  . 0 . .  . 1 . 0  . .
        < BUFFULL_FLAG  0  . 1 . 0  . . . .  . .
    """,
}


@pytest.mark.rule("SPI-017", "SPI-018", "SPI-050", "SPI-051")
@pytest.mark.parametrize("phase", [0, 1])
def test_a_waiting_character_follows_at_once_with_spiste_low(phase):
    rig = SpiRig(CLK_PHASE=phase, SPICHAR=1)
    rig.pin(rig.now, SOMI=0)
    rig.check(BACK_TO_BACK[phase])


@pytest.mark.rule("SPI-016")
def test_spiclk_stops_when_no_character_waits():
    rig = SpiRig()
    rig.send(0x5500, 9)
    edges = len(rig.edges)
    rig.wait(50)
    assert (len(rig.edges), rig.show("CLK"), rig.show("STE")) == (edges, 0, 1)


@pytest.mark.rule("SPI-014")
def test_a_write_to_spidat_begins_a_transfer_too():
    SpiRig(SPICHAR=3).check("""
        > SPIDAT  .  9  . . . . . . . . .  .
        < STE     1  0  . . . . . . . . 1  .
        < CLK     0  .  1 0 1 0 1 0 1 0 .  .
        < SIMO    0  .  1 . 0 . . . 1 . .  .
    """)


def test_a_character_written_while_spiste_is_still_low_keeps_it_low():
    rig = SpiRig(SPICHAR=1)
    begin = rig.now
    rig.check(
        """
        > SPITXBUF  8  . . . . 8  . . . . .  .
        < STE       0  . . . . .  . . . . 1  .
        < CLK       0  1 0 1 0 .  1 0 1 0 .  .
    """,
        start=begin,
    )
    rises = [time - begin - 1 for time, levels in rig.edges if levels & 8 and time > begin]
    assert rises == [10 * HALF]


@pytest.mark.rule("SPI-019", "SPI-020", "SPI-021")
def test_talk_0_leaves_simo_undriven_and_continues_the_transfer():
    rig = SpiRig(SPICHAR=3).check("""
        > SPITXBUF  .  5  . . . . . . . .  .
        > TALK      .  .  . . . 0 . . . .  .
        < SIMO?     1  .  . . . 0 . . . .  .
        < SIMO      0  .  . . 1 . . . . .  .
        < CLK       0  .  1 0 1 0 1 0 1 0  .
        < INT_FLAG  0  .  . . . . . . . 1  .
        < SPIRXBUF  0  .  . . . . . . . f  .
    """)
    rig.write("SPITXBUF", 0)  # a transfer that begins with TALK = 0
    rig.pin(rig.now, SOMI=0)
    rig.wait(6)
    assert rig.show("SPIRXBUF") == 0


@pytest.mark.rule("SPI-010")
def test_a_master_drives_simo_clk_and_ste():
    rig = SpiRig()
    assert [rig.show(f"{pin}?") for pin in ("SIMO", "SOMI", "CLK", "STE")] == [1, 0, 1, 1]


def test_words_with_an_odd_divider_keep_the_longer_half_between_them():
    rig = SpiRig(SPIBRR=4, SPICHAR=1)
    rig.write("SPITXBUF", 0x8000, 0x4000)
    rig.wait(12)
    edges = [time for (_, before), (time, after) in pairwise(rig.edges) if (before ^ after) & 4]
    assert [(after - before) // LSPCLK for before, after in pairwise(edges)] == [2, 3, 2, 3, 2, 3, 2]
