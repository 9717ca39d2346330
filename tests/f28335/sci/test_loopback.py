"""Loop-back: the transmitter's output is the receiver's input, inside the module."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.f28335.sci_rig import SciRig, frame


@pytest.mark.rule("SCI-135", "SCI-136")
@settings(max_examples=30, deadline=None)
@given(
    word=st.integers(0, 255),
    bits=st.integers(1, 8),
    parity=st.sampled_from([{}, {"PARITYENA": 1}, {"PARITYENA": 1, "PARITY": 1}]),
)
def test_a_character_sent_is_received(word, bits, parity):
    rig = SciRig(brr=3, LOOPBKENA=1, SCICHAR=bits - 1, **parity).put(word, 14)
    assert rig.flags("RXRDY", "RXERROR", "RXDT") == {"RXRDY": 1, "RXERROR": 0, "RXDT": word & (1 << bits) - 1}


@pytest.mark.rule("SCI-136")
def test_an_address_bit_is_received_as_sent():
    rig = SciRig(LOOPBKENA=1, ADDRIDLE_MODE=1)
    for wake in (1, 0):
        rig.set(TXWAKE=wake)
        rig.put(0x4B, 13)
        assert rig.flags("RXRDY", "RXWAKE", "RXDT") == {"RXRDY": 1, "RXWAKE": wake, "RXDT": 0x4B}
        rig.read("SCIRXBUF")


@pytest.mark.rule("SCI-136")
def test_an_overrun_happens_in_loop_back_too():
    rig = SciRig(LOOPBKENA=1)
    for word in (0x11, 0x22):
        rig.put(word, 12)
    assert rig.flags("RXRDY", "OE", "RXDT") == {"RXRDY": 1, "OE": 1, "RXDT": 0x22}


@pytest.mark.rule("SCI-136")
def test_all_words_of_a_full_transmit_fifo_are_received_in_order():
    rig = SciRig(fifo=True, LOOPBKENA=1)
    rig.write("SCITXBUF", *range(0xA0, 0xB0))
    assert rig.received(wait=16 * 10 + 3) == list(range(0xA0, 0xB0))
    assert rig.peek("SCIRXST") & 0b1011_1100 == 0


@pytest.mark.rule("SCI-135")
def test_in_loop_back_the_pin_is_not_received():
    rig = SciRig(LOOPBKENA=1).with_rxd(frame(0x4B) + "111")
    assert rig.get("RXRDY") == 0


@pytest.mark.rule("SCI-137")
def test_without_loop_back_the_directions_are_independent():
    rig = SciRig(LOOPBKENA=0).put(0x4B, 14)
    assert rig.get("RXRDY") == 0
    rig.send(frame(0xA5) + "1")
    assert rig.flags("RXRDY", "RXDT") == {"RXRDY": 1, "RXDT": 0xA5}
    assert rig.characters() == [0x4B]
