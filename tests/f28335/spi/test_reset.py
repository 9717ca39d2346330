"""SPISWRESET, SPIRST, the system reset, changes between master and slave, and loop-back."""

from __future__ import annotations

import pytest

from tests.f28335.spi_rig import HALF, MASTER, SLAVE, SpiRig


@pytest.mark.rule("SPI-054")
@pytest.mark.parametrize("polarity", [0, 1])
def test_spiswreset_stops_a_master_at_once(polarity):
    rig = SpiRig(CLKPOLARITY=polarity)
    rig.write("SPITXBUF", 0)
    rig.run_until(rig.now + 1 + 3 * HALF)  # SPICLK is active
    assert rig.show("CLK") == 1 - polarity
    rig.set(SPISWRESET=0)
    assert (rig.show("CLK"), rig.show("STE")) == (polarity, 1)
    rig.set(SPISWRESET=1)
    edges = len(rig.edges)
    rig.wait(20)
    assert len(rig.edges) == edges


@pytest.mark.rule("SPI-052", "SPI-053")
def test_spiswreset_clears_the_flags_and_nothing_else():
    rig = SpiRig(SPICHAR=3, SPILBK=1, SPIPRI=0x10, SPIFFCT=7)
    for word in (1, 2, 3):
        rig.send(word << 12, 6)
    rig.write("SPITXBUF", *(word << 12 for word in (4, 5)))
    names = ["SPICTL", "SPIBRR", "SPIRXBUF", "SPITXBUF", "SPIFFTX", "SPIFFRX", "SPIFFCT", "SPIPRI"]
    kept = rig.flags(*names)
    assert rig.peek("SPISTS") == 0xE0
    rig.set(SPISWRESET=0)
    assert rig.flags("SPICCR", "SPISTS") == {"SPICCR": 0x13, "SPISTS": 0}
    assert rig.flags(*names) == kept


@pytest.mark.rule("SPI-055")
@pytest.mark.parametrize("register", ["SPITXBUF", "SPIDAT"])
def test_a_word_written_during_spiswreset_is_not_sent_after_it(register):
    rig = SpiRig({}, {**MASTER, "SPISWRESET": 0})
    rig.write(register, 0x5500)
    edges = len(rig.edges)
    rig.set(SPISWRESET=1)
    rig.wait(20)
    assert (len(rig.edges), rig.peek(register)) == (edges, 0x5500)
    assert len(rig.notes("lost")) == 1
    rig.send(0x5500, 9)
    assert rig.get("INT_FLAG") == 1


def test_spiswreset_discards_the_incomplete_character_of_a_slave():
    rig = SpiRig({}, SLAVE).select_idle()
    rig.clock("111")
    rig.set(SPISWRESET=0)
    rig.clock("11111")
    rig.set(SPISWRESET=1)
    assert rig.peek("SPIDAT") == 7
    rig.exchange(0xA5)
    assert (rig.get("INT_FLAG"), rig.read("SPIRXBUF") & 0xFF) == (1, 0xA5)


@pytest.mark.rule("SPI-076", "SPI-077")
def test_spirst_resets_the_channels_and_leaves_the_configuration():
    rig = SpiRig(fifo=True, SPILBK=1, TXFFIL=9, RXFFIL=1, TXFFIENA=1, SPIFFCT=0)
    rig.write("SPITXBUF", *(word << 8 for word in range(4)))
    rig.wait(9)
    assert rig.flags("TXFFST", "RXFFST", "RXFFINT") == {"TXFFST": 2, "RXFFST": 1, "RXFFINT": 1}
    rig.set(SPIRST=0)
    assert (rig.show("STE"), rig.peek("SPIFFTX"), rig.peek("SPIFFRX")) == (1, 0x6029, 0x2001)
    rig.send(0x5500, 9)
    rig.set(SPIRST=1)
    assert rig.flags("TXFFST", "TXFFINT") == {"TXFFST": 0, "TXFFINT": 1}
    rig.wait(9)
    assert rig.notes("lost") == ["SPI-A: SPITXBUF was written 0x5500 while a reset holds the transmit FIFO: it is lost"]
    rig.send(0x6600, 9)
    assert rig.received(mask=0xFF) == [0x66]


def test_spirst_0_stops_standard_mode_too():
    rig = SpiRig()
    rig.set(SPIRST=0)
    rig.send(0, 20)
    assert rig.get("INT_FLAG") == 0
    rig.set(SPIRST=1)
    rig.send(0, 10)
    assert rig.get("INT_FLAG") == 1


@pytest.mark.rule("SPI-002", "SPI-012", "SPI-084")
def test_after_a_system_reset_the_spi_is_a_slave_without_fifos_and_does_not_transmit():
    rig = SpiRig(fifo=True, SPILBK=1, SPIINTENA=1)
    rig.write("SPITXBUF", *(word << 8 for word in range(5)))
    rig.wait(12.5)
    rig.pin(rig.now, STE=0)
    rig.chip.reset(rig.now)
    rig.observe()
    assert (rig.chip.out, rig.chip.driven) == (0b1111, 0)
    assert rig.flags("MASTER_SLAVE", "TALK", "SPIFFENA", "SPISTS") == dict.fromkeys(
        ("MASTER_SLAVE", "TALK", "SPIFFENA", "SPISTS"), 0
    )
    rig.chip.gate(rig.now, True)
    rig.wait(50)
    assert rig.edges[-1][1] == 0b1111


def test_a_master_that_becomes_a_slave_discards_its_character():
    SpiRig().check("""
        > SPITXBUF      .  0  . . . . . . . . . .
        > MASTER_SLAVE  .  .  . . . 0 . . 1 . . .
        < CLK           0  .  1 0 1 . . . 0 . . .
        < CLK?          1  .  . . . 0 . . 1 . . .
        < STE           1  0  . . . 1 . . . . . .
    """)


@pytest.mark.rule("SPI-056")
def test_loop_back_receives_what_is_sent_and_shows_it_on_the_pins():
    rig = SpiRig(SPILBK=1)
    rig.pin(rig.now, SOMI=0)
    seen = []
    for word in (0xA5, 0x3C):
        rig.send(word << 8, 10)
        seen.append(rig.read("SPIRXBUF") & 0xFF)
    assert seen == [0xA5, 0x3C]
    assert rig.chip.touched.isdisjoint({"input_latency"})
    rig.set(SPILBK=0)
    rig.send(0xA500, 10)
    assert rig.read("SPIRXBUF") & 0xFF == 0


@pytest.mark.rule("SPI-057")
def test_loop_back_has_no_effect_on_a_slave():
    rig = SpiRig({}, SLAVE, SPILBK=1).select_idle()
    rig.write("SPITXBUF", 0x3C00)
    assert (rig.exchange(0xA5), rig.read("SPIRXBUF") & 0xFF) == (0x3C, 0xA5)
