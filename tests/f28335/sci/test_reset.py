"""SW RESET and the system reset: activities that they stop, and flags and fields that they change or leave."""

from __future__ import annotations

import pytest

from tests.f28335.sci_rig import FIFO, SciRig, frame


@pytest.mark.rule("SCI-202")
def test_transmission_stops_at_once():
    SciRig().check("""
        > SCITXBUF  .  0  ....  .  .  .  .......
        > SWRESET   .  .  ....  0  .  1  .......
        < TXD       1  0  ....  1  .  .  .......
        < TXEMPTY   1  0  ....  1  .  .  .......
    """)


@pytest.mark.rule("SCI-202")
def test_the_line_becomes_1_in_the_cycle_of_the_write():
    rig = SciRig().put(0x00, 3, cycles=17)
    rig.set(SWRESET=0)
    assert rig.edges[-1] == (rig.now, 1)


@pytest.mark.rule("SCI-202", "SCI-207")
def test_reception_stops_at_once():
    # SW RESET ends within the frame, whose last bits are all 1. The receiver does not continue the frame.
    rig = SciRig().check("""
        > RXD      1  0  1010 1111  1  ........  1  0  11010010  1  1
        > SWRESET  .  .  ..0. 1...  .  ........  .  .  ........  .  .
        < RXRDY    0  .  .... ....  .  ........  .  .  ........  1  .
    """)
    assert rig.read("SCIRXBUF") == 0x4B


@pytest.mark.rule("SCI-203")
def test_no_flag_changes_during_sw_reset():
    rig = SciRig(PARITYENA=1, RXBKINTENA=1, RXERRINTENA=1, TXINTENA=0)
    rig.set(SWRESET=0)
    for text in (
        frame(0x11, parity="odd") + frame(0x11, parity="odd"),
        frame(0x11, parity="even"),
        frame(0x11, parity="odd", bad="stop") + "1",
        "0" * 30 + "1" * 30,
    ):
        rig.send(text)
        assert rig.peek("SCIRXST") == 0
        assert rig.flags("TXRDY", "TXEMPTY") == {"TXRDY": 1, "TXEMPTY": 1}
    rig.put(0x55, 30)
    assert rig.flags("TXRDY", "TXEMPTY") == {"TXRDY": 1, "TXEMPTY": 1}
    assert (rig.edges, rig.count("RXINT"), rig.count("TXINT")) == ([], 0, 0)


@pytest.mark.rule("SCI-204", "SCI-084", "SCI-134")
def test_sw_reset_leaves_the_configuration():
    kept = {
        "STOPBITS": 1,
        "PARITY": 1,
        "PARITYENA": 1,
        "LOOPBKENA": 1,
        "ADDRIDLE_MODE": 1,
        "SCICHAR": 5,
        "RXERRINTENA": 1,
        "SLEEP": 1,
        "TXENA": 1,
        "RXENA": 1,
        "RXBKINTENA": 1,
        "TXINTENA": 1,
        "SCIRST": 1,
        "SCIFFENA": 1,
        "TXFIFOXRESET": 1,
        "TXFFIENA": 1,
        "TXFFIL": 3,
        "RXFIFORESET": 1,
        "RXFFIENA": 1,
        "RXFFIL": 7,
        "CDC": 1,
        "FFTXDLY": 0x5A,
        "SOFT": 1,
        "FREE": 1,
    }
    rig = SciRig(brr=0x1234, **kept)
    for reset in (0, 1):
        rig.set(SWRESET=reset)
        assert rig.flags(*kept, "SCIHBAUD", "SCILBAUD") == kept | {"SCIHBAUD": 0x12, "SCILBAUD": 0x34}


@pytest.mark.rule("SCI-205")
def test_sw_reset_leaves_the_fifos_and_their_flags():
    rig = SciRig(fifo=True, RXFFIL=1, TXFFIL=16)
    for word in range(17):
        rig.send(frame(0x40 + word))
    rig.wait(1)
    rig.set(TXENA=0)
    rig.write("SCITXBUF", *(0x50 + word for word in range(3)))
    kept = {"TXFFST": 3, "TXFFINT": 1, "RXFFST": 16, "RXFFINT": 1, "RXFFOVF": 1}
    assert rig.flags(*kept) == kept
    for reset in (0, 1):
        rig.set(SWRESET=reset)
        assert rig.flags(*kept) == kept
    assert rig.received() == list(range(0x41, 0x51))
    rig.set(TXENA=1)
    assert rig.characters(wait=35) == [0x50, 0x51, 0x52]


@pytest.mark.rule("SCI-205")
def test_sw_reset_leaves_abd():
    rig = SciRig(brr=1, CDC=1)
    rig.send(frame(ord("A")) + "11", bit=1312)
    assert rig.get("ABD") == 1
    for reset in (0, 1):
        rig.set(SWRESET=reset)
        assert rig.get("ABD") == 1


@pytest.mark.rule("SCI-206")
def test_a_character_written_in_sw_reset_leaves_txrdy_and_is_lost():
    rig = SciRig()
    rig.set(SWRESET=0)
    rig.write("SCITXBUF", 0x4B)
    assert rig.flags("TXRDY", "TXEMPTY") == {"TXRDY": 1, "TXEMPTY": 1}
    rig.set(SWRESET=1)
    rig.wait(20)
    assert rig.edges == []


@pytest.mark.rule("SCI-207")
def test_sw_reset_1_enables_both_directions():
    rig = SciRig(SWRESET=0)
    rig.set(SWRESET=1)
    rig.align()
    rig.send(frame(0x4B) + "1")
    assert rig.flags("RXRDY", "RXDT") == {"RXRDY": 1, "RXDT": 0x4B}
    assert rig.transmit(0xA5, 10) == frame(0xA5)


@pytest.mark.rule("SCI-208", "SCI-093")
def test_after_a_break_reception_needs_an_sw_reset():
    rig = SciRig()
    rig.send_and_read("0" * 25 + "1" * 5)
    rig.send(frame(0x11) + "1")
    assert rig.get("RXRDY") == 0
    rig.restart()
    rig.send(frame(0x22) + "1")
    assert rig.flags("RXRDY", "BRKDT", "RXDT") == {"RXRDY": 1, "BRKDT": 0, "RXDT": 0x22}


def test_a_system_reset_during_transfers_stops_them_and_clears_the_fifos():
    rig = SciRig(fifo=True, TXFFIENA=0)
    rig.write("SCITXBUF", *range(5))
    rig.send(frame(0x11) + "0 10")
    rig.reset()
    edges = len(rig.edges)
    rig.send("1" * 40)
    assert (len(rig.edges), rig.show("TXD")) == (edges, 1)
    assert rig.flags("RXFFST", "TXFFST", "SWRESET", *(n for n in FIFO if n != "SCIFFENA")) == {
        "RXFFST": 0,
        "TXFFST": 0,
        "SWRESET": 0,
        "SCIRST": 1,
        "TXFIFOXRESET": 1,
        "RXFIFORESET": 1,
    }


def test_after_reset_a_frame_has_one_data_bit_no_parity_and_one_stop_bit():
    """After a reset, SCICCR is 0; transmitter and receiver use this format."""
    rig = SciRig(PARITYENA=1, PARITY=1, STOPBITS=1)
    rig.reset()
    assert rig.peek("SCICCR") == 0
    rig.set_brr(24)
    rig.write("SCICTL1", 0x23)  # SW RESET, TXENA, RXENA
    rig.wait(2)
    rig.send("0 1 1", bit=rig.bit)
    assert rig.flags("RXRDY", "RXERROR", "RXDT") == {"RXRDY": 1, "RXERROR": 0, "RXDT": 1}
    before = len(rig.edges)
    rig.put(0x00, 20)
    (fall, low), (rise, high) = rig.edges[before:]
    assert (low, high, rise - fall) == (0, 1, 2 * rig.bit)
