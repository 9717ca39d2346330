"""Frames of the SCI: start bit, data, address bit, parity and stop bits, of the transmitter and the receiver."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.f28335.sci_rig import SciRig, frame, levels

EVEN, ODD = {"PARITYENA": 1, "PARITY": 1}, {"PARITYENA": 1, "PARITY": 0}
ADDRESS = {"ADDRIDLE_MODE": 1}


@pytest.mark.rule("SCI-015", "SCI-028")
def test_a_frame_is_start_bit_data_from_bit_0_on_and_stop_bit():
    SciRig().check("""
        > SCITXBUF  .  a  ........  .  ..
        < TXD       1  0  .1010...  1  ..
    """)


@pytest.mark.rule("SCI-015", "SCI-016", "SCI-017", "SCI-019", "SCI-020", "SCI-021", "SCI-022", "SCI-024", "SCI-026")
@pytest.mark.parametrize(
    ("fields", "word", "drawn"),
    [
        ({}, 0x4B, "0 11010010 1 1"),
        ({"STOPBITS": 1}, 0x4B, "0 11010010 1 1 1"),
        (ODD, 0x4B, "0 11010010 1 1 1"),
        (EVEN, 0x4B, "0 11010010 0 1 1"),
        (ODD, 0x4A, "0 01010010 0 1 1"),
        (EVEN, 0x4A, "0 01010010 1 1 1"),
        (ADDRESS, 0x4B, "0 11010010 0 1 1"),
        (ADDRESS | {"TXWAKE": 1}, 0x4B, "0 11010010 1 1 1"),
        (ADDRESS | EVEN, 0x4A, "0 01010010 0 1 1 1"),
        (ADDRESS | EVEN | {"TXWAKE": 1}, 0x4A, "0 01010010 1 0 1 1"),
        (ADDRESS | ODD | {"TXWAKE": 1}, 0x4A, "0 01010010 1 1 1 1"),
        ({"SCICHAR": 6}, 0xCB, "0 1101001 1 1"),
        ({"SCICHAR": 4}, 0xEB, "0 11010 1 1"),
        ({"SCICHAR": 0}, 0xFE, "0 0 1 1"),
        ({"SCICHAR": 0}, 0x01, "0 1 1 1"),
        ({"SCICHAR": 2} | EVEN, 0xFB, "0 110 0 1 1"),
        ({"SCICHAR": 2} | ODD, 0xFB, "0 110 1 1 1"),
    ],
)
def test_the_frame_on_txd(fields, word, drawn):
    rig = SciRig(**fields)
    assert rig.transmit(word, len(levels(drawn))) == levels(drawn)


@pytest.mark.rule("SCI-024")
@pytest.mark.parametrize(("stop_bits", "length"), [(0, 10), (1, 11)])
def test_the_next_frame_follows_after_one_or_two_stop_bits(stop_bits, length):
    rig = SciRig(STOPBITS=stop_bits).put(0xFF, 1)
    rig.put(0xFF, 30)
    first, second = rig.falls()
    assert second - first == length * rig.bit


@pytest.mark.rule("SCI-016", "SCI-018")
@pytest.mark.parametrize("bits", range(1, 9))
def test_short_characters_are_received_right_justified(bits):
    rig = SciRig(SCICHAR=bits - 1)
    ones = (1 << bits) - 1
    rig.send(frame(ones, bits) + "1")
    assert rig.read("SCIRXBUF") == ones
    rig.send(frame(0x95 & ones, bits) + "1")
    assert rig.read("SCIRXBUF") == 0x95 & ones
    assert rig.get("RXERROR") == 0


@pytest.mark.rule("SCI-019")
def test_without_parity_the_bit_after_the_data_is_the_stop_bit():
    rig = SciRig(fifo=True)
    for data in (0x00, 0x01):
        rig.send(frame(data))
    assert rig.received(wait=1) == [0x00, 0x01]


@pytest.mark.rule("SCI-020", "SCI-021", "SCI-022", "SCI-023", "SCI-055")
@pytest.mark.parametrize("wanted", ["odd", "even"])
@pytest.mark.parametrize("sent", ["odd", "even"])
@pytest.mark.parametrize(("bits", "data"), [(8, 0x4A), (8, 0xFF), (7, 0x25), (5, 0x1C), (1, 1)])
@pytest.mark.parametrize("address", [None, 0, 1])
def test_parity_is_checked_over_data_and_address_bit(wanted, sent, bits, data, address):
    setting = (EVEN if wanted == "even" else ODD) | {"SCICHAR": bits - 1}
    rig = SciRig(**setting, ADDRIDLE_MODE=int(address is not None)).with_rxd(
        frame(data, bits, address=address, parity=sent) + "11"
    )
    assert rig.flags("RXRDY", "PE", "FE") == {"RXRDY": 1, "PE": int(wanted != sent), "FE": 0}
    assert rig.peek("SCIRXBUF") & 0xFF == data


@pytest.mark.rule("SCI-023")
@pytest.mark.parametrize(("word", "parity"), [(0x03, "1"), (0xFB, "1"), (0x01, "0"), (0x81, "0")])
def test_unused_bits_of_short_characters_do_not_count_in_the_parity_sent(word, parity):
    rig = SciRig(SCICHAR=2, **ODD)
    assert rig.transmit(word, 6)[4] == parity


@pytest.mark.rule("SCI-025", "SCI-052")
@pytest.mark.parametrize("stop_bits", [0, 1])
def test_only_the_first_stop_bit_is_checked(stop_bits):
    rig = SciRig(fifo=True, STOPBITS=stop_bits)
    rig.send("0 11010010 1" + "0 11110000 1" + "1")  # the sender omits the second stop bit
    assert rig.flags("FE", "RXFFST") == {"FE": 0, "RXFFST": 2}
    assert rig.received() == [0x4B, 0x0F]


@pytest.mark.rule("SCI-025", "SCI-051")
@pytest.mark.parametrize("stop_bits", [0, 1])
def test_the_first_stop_bit_is_checked(stop_bits):
    rig = SciRig(STOPBITS=stop_bits).with_rxd("0 11010010 0 1")
    assert rig.get("FE") == 1


@pytest.mark.rule("SCI-026")
def test_the_address_bit_is_expected_after_the_data_and_before_the_parity():
    rig = SciRig(**ADDRESS, **EVEN).with_rxd("0 01010010 1 0 1 1")
    assert rig.flags("RXRDY", "RXWAKE", "PE", "FE", "RXDT") == {"RXRDY": 1, "RXWAKE": 1, "PE": 0, "FE": 0, "RXDT": 0x4A}


@settings(max_examples=40, deadline=None)
@given(
    bits=st.integers(1, 8),
    word=st.integers(0, 255),
    parity=st.sampled_from(["none", "even", "odd"]),
    stops=st.integers(1, 2),
    address=st.sampled_from([None, 0, 1]),
)
def test_any_format_is_sent_and_received_as_specified(bits, word, parity, stops, address):
    fields = {"none": {}, "even": EVEN, "odd": ODD}[parity] | {"SCICHAR": bits - 1, "STOPBITS": stops - 1}
    rig = SciRig(brr=3, **fields, ADDRIDLE_MODE=int(address is not None))
    drawn = frame(word & (1 << bits) - 1, bits, address=address, parity=parity, stops=stops)
    if address:
        rig.set(TXWAKE=1)
    assert rig.transmit(word, len(drawn)) == drawn
    rig.send(drawn + "1")
    assert rig.flags("RXRDY", "RXERROR", "RXDT") == {"RXRDY": 1, "RXERROR": 0, "RXDT": word & (1 << bits) - 1}


@pytest.mark.rule("SCI-027")
def test_a_new_format_applies_from_the_next_sent_character_on():
    rig = SciRig().put(0x2A, 3)
    rig.set(SCICHAR=4)
    rig.write("SCITXBUF", 0x15)
    assert rig.sent(rig.falls()[0], 18) == levels("0 01010100 1" + "0 10101 1" + "1")


@pytest.mark.rule("SCI-027")
def test_a_new_format_applies_from_the_next_received_character_on():
    rig = SciRig(fifo=True)
    begin = rig.send("0 010")
    rig.set(SCICHAR=4)
    rig.send("10101 1" + "0 10101 1" + "1", at=begin + 4 * rig.bit)
    assert rig.flags("FE", "RXFFST") == {"FE": 0, "RXFFST": 2}
    assert rig.received() == [0xAA, 0x15]
