"""Suspension by a debugger, with each value of SOFT and FREE, and the clock gate during transfers of the SPI."""

from __future__ import annotations

import pytest

from tests.f28335.spi_rig import LSPCLK, SLAVE, SpiRig

FOUR = {"SPICHAR": 3, "SPILBK": 1}


@pytest.mark.rule("SPI-078", "SPI-079")
def test_soft_0_free_0_freezes_a_character_and_a_whole_one_follows():
    """Two of four bits are sent before the suspension, and the character is completed after it."""
    rig = SpiRig(SPICHAR=3)
    rig.pin(rig.now, SOMI=0)
    rig.check("""
        > SPITXBUF  .  5  . . . .  . . . . .  . . . . . . . .  .
        > SUSPEND   .  .  . . . .  1 . . . 0  . . . . . . . .  .
        < STE       1  0  . . . .  . . . . .  . . . . . . . 1  .
        < CLK       0  .  1 0 1 0  . . . . 1  0 1 0 1 0 1 0 .  .
        < SIMO      0  .  . . 1 .  . . . . 0  . 1 . 0 . . . .  .
        < INT_FLAG  0  .  . . . .  . . . . .  . . . . . . 1 .  .
    """)


@pytest.mark.rule("SPI-078")
def test_soft_0_free_0_freezes_a_slave():
    rig = SpiRig({"bits_after_suspend": "remainder"}, SLAVE).select_idle()
    rig.clock("1010")
    rig.chip.suspend(rig.now, True)
    rig.clock("111111")
    rig.chip.suspend(rig.now, False)
    rig.clock("0110")
    assert (rig.get("INT_FLAG"), rig.read("SPIRXBUF")) == (1, 0xA6)


@pytest.mark.rule("SPI-080")
@pytest.mark.parametrize("soft", [0, 1])
def test_a_transfer_does_not_begin_during_a_suspension(soft):
    SpiRig(**FOUR, SOFT=soft).check("""
        > SPITXBUF  .  5  . . . . .  . . . . . . . .  . .
        > SUSPEND   .  .  1 . . . 0  . . . . . . . .  . .
        < STE       1  0  . . . . .  . . . . . . . 1  . .
        < CLK       0  .  . . . . 1  0 1 0 1 0 1 0 .  . .
    """)


@pytest.mark.rule("SPI-081")
@pytest.mark.parametrize("phase", [0, 1])
def test_soft_1_sends_the_character_and_the_waiting_one(phase):
    rig = SpiRig(**FOUR, CLK_PHASE=phase, SOFT=1, SPIINTENA=1)
    rig.write("SPITXBUF", *(word << 12 for word in (5, 6)))
    rig.wait(1.2)
    rig.chip.suspend(rig.now, True)
    rig.observe()
    rig.wait(12)
    assert rig.flags("SPIRXBUF", "OVERRUN_FLAG") == {"SPIRXBUF": 6, "OVERRUN_FLAG": 1}
    assert (rig.show("STE"), rig.show("CLK")) == (1, 0)
    rig.write("SPITXBUF", 0x7000)  # written during the suspension: it waits
    edges = len(rig.edges)
    rig.wait(12)
    assert len(rig.edges) == edges
    rig.chip.suspend(rig.now, False)
    rig.wait(12)
    assert rig.show("SPIRXBUF") == 7


@pytest.mark.rule("SPI-082")
@pytest.mark.parametrize("at", [1.2, 4.7, 6.0])
def test_soft_1_sends_all_words_of_the_fifo(at):
    """The suspension begins within the first word, between two words, or within the delay TXDLY."""
    rig = SpiRig(**FOUR, fifo=True, SOFT=1, SPIFFCT=0 if at < 5 else 3)
    rig.write("SPITXBUF", *(word << 12 for word in range(5)))
    rig.wait(at)
    rig.chip.suspend(rig.now, True)
    assert rig.received(wait=5 * 7, mask=0xF) == [0, 1, 2, 3, 4]


def test_soft_1_lets_a_slave_finish_its_character():
    rig = SpiRig({}, SLAVE, SOFT=1).select_idle()
    rig.clock("101")
    rig.chip.suspend(rig.now, True)
    rig.clock("00101")
    assert rig.peek("SPIRXBUF") == 0xA5
    rig.clock("11111111")
    assert rig.flags("SPIDAT", "OVERRUN_FLAG") == {"SPIDAT": 0xA5, "OVERRUN_FLAG": 0}


def test_soft_1_stops_a_slave_between_characters_at_once():
    rig = SpiRig({}, SLAVE, SOFT=1).select_idle()
    rig.chip.suspend(rig.now, True)
    rig.clock("11111111")
    assert rig.get("INT_FLAG") == 0


@pytest.mark.rule("SPI-083")
@pytest.mark.parametrize("soft", [0, 1])
def test_free_1_continues_transfers(soft):
    rig = SpiRig(**FOUR, fifo=True, SOFT=soft, FREE=1)
    rig.write("SPITXBUF", *(word << 12 for word in range(3)))
    rig.wait(1.2)
    rig.chip.suspend(rig.now, True)
    rig.send(0x7000, 17)
    assert rig.received(mask=0xF) == [0, 1, 2, 7]


@pytest.mark.rule("SPI-009")
def test_the_clock_gate_freezes_a_transfer():
    rig = SpiRig(SPICHAR=3)
    rig.pin(rig.now, SOMI=0)
    rig.check("""
        > SPITXBUF  .  5  . . . .  . . . . .  . . . .  .
        > GATE      1  .  . . . .  0 . . . 1  . . . .  .
        < STE       1  0  . . . .  . . . . .  . . . 1  .
        < CLK       0  .  1 0 1 0  . . . . 1  0 1 0 .  .
        < SIMO      0  .  . . 1 .  . . . . 0  . 1 . .  .
        < INT_FLAG  0  .  . . . .  . . . . .  . . 1 .  .
    """)


@pytest.mark.rule("SPI-009")
def test_a_slave_without_a_clock_sees_no_edges():
    rig = SpiRig({}, SLAVE).select_idle()
    rig.chip.gate(rig.now, False)
    rig.clock("1111")
    rig.chip.gate(rig.now, True)
    rig.clock("00000000")
    assert (rig.get("INT_FLAG"), rig.read("SPIRXBUF")) == (1, 0)


@pytest.mark.parametrize("bits", [1, 7])
def test_soft_1_lets_a_slave_finish_after_any_bit(bits):
    rig = SpiRig({}, SLAVE, SOFT=1).select_idle()
    rig.clock("1" * bits)
    rig.chip.suspend(rig.now, True)
    rig.clock("0" * (8 - bits))
    assert (rig.get("INT_FLAG"), rig.peek("SPIRXBUF")) == (1, 0xFF << (8 - bits) & 0xFF)


@pytest.mark.parametrize("stop", ["gate", "suspend", "set_lspclk"])
def test_changes_due_before_a_stop_are_applied_first(stop):
    rig = SpiRig()
    rig.pin(rig.now, SOMI=0)
    rig.write("SPIDAT", 0xFF00)
    later = rig.now + 40 * LSPCLK
    arguments = {"gate": (later, False), "suspend": (later, True), "set_lspclk": (later, 2, 0)}[stop]
    getattr(rig.chip, stop)(*arguments)
    assert rig.chip.peek(later, 7) == 0
    assert rig.chip.peek(later, 2) == 0x40
