"""Exchange of characters between two modules, and between a module and a simple SPI written in the test."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.f28335.spi_rig import FIFO, HALF, LSPCLK, MASTER, SCHEMES, SLAVE, SpiRig, Wires, decode

words = st.lists(st.integers(0, 0xFFFF), min_size=1, max_size=5)


@pytest.mark.rule("SPI-010", "SPI-011", "SPI-015", "SPI-023", "SPI-025", "SPI-026", "SPI-027")
@given(scheme=st.sampled_from(SCHEMES), bits=st.integers(1, 16), brr=st.integers(0, 12), sent=words, data=st.data())
def test_a_master_and_a_slave_exchange_all_characters(scheme, bits, brr, sent, data):
    answers = data.draw(st.lists(st.integers(0, 0xFFFF), min_size=len(sent), max_size=len(sent)))
    format_ = {"CLKPOLARITY": scheme[0], "CLK_PHASE": scheme[1], "SPICHAR": bits - 1}
    master = SpiRig({}, {**MASTER, **FIFO, **format_, "SPIBRR": brr})
    slave = SpiRig({}, {**SLAVE, **FIFO, **format_, "SPIBRR": 127})
    wires = Wires(master, slave)
    for word in answers:
        wires.write(slave, "SPITXBUF", word)
    for word in sent:
        wires.write(master, "SPITXBUF", word)
    wires.run_until(wires.now + len(sent) * bits * (max(brr, 3) + 1) * LSPCLK + 100)

    shown = decode(wires.history, *scheme, bits)
    high_bits = lambda words: [word >> 16 - bits for word in words]  # noqa: E731
    assert shown == (high_bits(sent), high_bits(answers))
    mask = (1 << bits) - 1
    assert [word & mask for word in slave.received()] == high_bits(sent)
    assert [word & mask for word in master.received()] == high_bits(answers)
    assert wires.history[-1][1] >> 2 == 0b10 | scheme[0]  # SPISTE high, SPICLK idle


@pytest.mark.rule("SPI-011", "SPI-015", "SPI-023", "SPI-025", "SPI-031")
@given(
    scheme=st.sampled_from(SCHEMES),
    bits=st.integers(1, 16),
    half=st.integers(2 * LSPCLK, 40),
    sent=st.lists(st.tuples(st.integers(0, 0xFFFF), st.integers(0, 0xFFFF)), min_size=1, max_size=4),
    brr=st.integers(0, 127),
)
def test_a_slave_exchanges_characters_with_a_master_written_in_the_test(scheme, bits, half, sent, brr):
    rig = SpiRig({}, SLAVE, CLKPOLARITY=scheme[0], CLK_PHASE=scheme[1], SPICHAR=bits - 1, SPIBRR=brr)
    rig.pin(rig.now + 10, CLK=scheme[0])
    rig.select()
    for out, answer in sent:
        rig.write("SPITXBUF", answer)
        out >>= 16 - bits
        assert rig.exchange(out, bits, half) == answer >> 16 - bits
        assert rig.read("SPIRXBUF") & (1 << bits) - 1 == out
    assert rig.chip.notes == []


@pytest.mark.rule("SPI-010", "SPI-015", "SPI-027")
@given(scheme=st.sampled_from(SCHEMES), bits=st.integers(1, 16), word=st.integers(0, 0xFFFF), answer=st.integers(0))
def test_a_master_exchanges_characters_with_a_slave_written_in_the_test(scheme, bits, word, answer):
    """The slave outputs a bit at each output edge; with CLK_PHASE = 1, the first at the fall of SPISTE."""
    polarity, phase = scheme
    answer &= (1 << bits) - 1
    rig = SpiRig(CLKPOLARITY=polarity, CLK_PHASE=phase, SPICHAR=bits - 1)
    rig.write("SPITXBUF", word)
    waiting = [int(mark) for mark in f"{answer:0{bits}b}"]
    clock, ste = polarity, 1
    for _ in range(2 * bits + 6):
        rig.run_until(rig.now + HALF // 2)
        before, clock = clock, rig.show("CLK")
        fell, ste = ste and not rig.show("STE"), rig.show("STE")
        puts_out = fell if phase and fell else before != clock and (clock != polarity) == (phase == 0)
        if puts_out and waiting:
            rig.pin(rig.now, SOMI=waiting.pop(0))
        rig.run_until(rig.now + HALF // 2)
    assert not waiting
    assert rig.read("SPIRXBUF") & (1 << bits) - 1 == answer


@pytest.mark.rule("SPI-022")
def test_of_two_slaves_the_selected_one_answers():
    """The other slave receives the same SPICLK and SPISIMO, but its SPISTE is 1: it neither answers nor receives."""
    master, selected, other = SpiRig(SPICHAR=7), SpiRig({}, SLAVE), SpiRig({}, SLAVE)
    wires = Wires(master, selected)
    for slave, answer in ((selected, 0x3C), (other, 0xA5)):
        slave.write("SPITXBUF", answer << 8)
    wires.settle()
    wires.write(master, "SPITXBUF", 0x5500)
    wires.wait(12)
    assert (master.read("SPIRXBUF"), selected.read("SPIRXBUF") & 0xFF) == (0x3C, 0x55)
    driven = set()
    for time, levels in wires.history:
        other.pin(time, SIMO=levels & 1, CLK=levels >> 2 & 1, STE=1)
        driven.add(other.show("SOMI?"))
    assert (other.peek("SPIDAT"), driven) == (0xA500, {0})


@pytest.mark.rule("SPI-028")
@pytest.mark.parametrize("level", [0, 1])
def test_bits_that_remain_are_shifted_to_the_left(level):
    """The example of the manual: a character of one bit, SPIDAT = 737Bh."""
    rig = SpiRig(SPICHAR=0)
    rig.pin(rig.now, SOMI=level)
    rig.write("SPIDAT", 0x737B)
    rig.wait(4)
    assert (rig.peek("SPIDAT"), rig.peek("SPIRXBUF")) == (0xE6F6 | level,) * 2
