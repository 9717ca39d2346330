"""Whole words instead of edges: `deliver` and `take_words` meet the same flags, FIFOs and requests."""

from __future__ import annotations

import pytest

from tests.f28335.sci_rig import SciRig, frame

FE, PE = 0x8000, 0x4000


def deliver(rig: SciRig, word: int, address_bit: int = 0) -> None:
    rig.chip.deliver(rig.now, word, address_bit)
    rig.line.look()
    rig.wait(cycles=10)


@pytest.mark.parametrize("fifo", [False, True])
@pytest.mark.parametrize("word", [0x4B, FE | 0x4B, PE | 0x4B, FE | PE | 0x4B])
def test_a_word_delivered_leaves_what_its_frame_leaves(word, fifo):
    fields = {"RXBKINTENA": 1, "RXERRINTENA": 1, "PARITYENA": 1, "RXFFIL": 1, "RXFFIENA": 1}
    rigs = [SciRig(fifo=fifo, **fields) for _ in range(2)]
    drawn = frame(0x4B, parity="odd")
    if word & PE:
        drawn = frame(0x4B, parity="odd", bad="parity")
    rigs[0].send((drawn[:-1] + "0" if word & FE else drawn) + "1")
    deliver(rigs[1], word)
    seen = [(rig.peek("SCIRXST") & 0xFC, rig.get("RXFFST"), rig.count("RXINT"), rig.read("SCIRXBUF")) for rig in rigs]
    assert seen[0] == seen[1]


def test_words_overrun_and_overflow_like_frames():
    rig = SciRig()
    deliver(rig, 0x11)
    deliver(rig, 0x22)
    assert rig.flags("OE", "RXDT") == {"OE": 1, "RXDT": 0x22}
    rig = SciRig(fifo=True)
    for word in range(17):
        deliver(rig, word)
    assert rig.flags("RXFFOVF", "OE") == {"RXFFOVF": 1, "OE": 1}
    assert rig.received() == list(range(1, 17))


@pytest.mark.parametrize("fields", [{}, {"ADDRIDLE_MODE": 1}])
def test_asleep_only_words_with_the_address_bit_come_in(fields):
    rig = SciRig(SLEEP=1, **fields)
    deliver(rig, 0x11, 0)
    assert rig.get("RXRDY") == 0
    deliver(rig, 0x22, 1)
    assert rig.flags("RXRDY", "RXWAKE", "RXDT") == {"RXRDY": 1, "RXWAKE": 1, "RXDT": 0x22}


@pytest.mark.parametrize("held", [{"SWRESET": 0}, {"SCIRST": 0}, {"RXENA": 0}])
def test_a_word_is_lost_while_the_receiver_is_held(held):
    rig = SciRig(**held)
    deliver(rig, 0x11)
    rig.chip.deliver_break(rig.now)
    assert rig.flags("RXRDY", "BRKDT") == {"RXRDY": 0, "BRKDT": 0}


def test_a_word_is_lost_without_a_clock():
    rig = SciRig()
    rig.chip.gate(rig.now, False)
    deliver(rig, 0x11)
    rig.chip.deliver_break(rig.now)
    assert len(rig.notes("lost")) == 1
    rig.chip.gate(rig.now, True)
    assert rig.flags("RXRDY", "BRKDT") == {"RXRDY": 0, "BRKDT": 0}


def test_a_break_delivered():
    rig = SciRig(RXBKINTENA=1)
    deliver(rig, FE)
    rig.chip.deliver_break(rig.now)
    rig.wait(1)
    assert rig.flags("FE", "BRKDT", "RXRDY") == {"FE": 1, "BRKDT": 1, "RXRDY": 1}
    assert rig.count("RXINT") == 2


def test_words_taken_instead_of_edges_come_when_their_frames_would():
    edges, words = SciRig(), SciRig()
    sent = words.chip.take_words()
    for rig in (edges, words):
        rig.write("SCITXBUF", 0x4B)
        rig.wait(1)
        rig.write("SCITXBUF", 0xA5)
        rig.wait(25)
    assert words.edges == []
    assert [(w.start, w.word) for w in sent] == list(zip((s for s, _ in edges.frames(10)), (0x4B, 0xA5), strict=True))
    assert [w.end - w.start for w in sent] == [10 * words.bit] * 2
    assert words.peek("SCICTL2") == edges.peek("SCICTL2")


def test_calls_that_no_simulation_should_make():
    rig = SciRig()
    with pytest.raises(ValueError, match="offset"):
        rig.chip.read(rig.now, 16)
    with pytest.raises(ValueError, match="offset"):
        rig.chip.write(rig.now, -1, 0)
    with pytest.raises(ValueError, match="LSPCLK"):
        rig.chip.set_lspclk(rig.now, 3, 0)
