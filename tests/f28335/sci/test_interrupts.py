"""RXINT and TXINT in standard mode. The rows RXINT and TXINT of diagrams are the number of requests so far."""

from __future__ import annotations

import pytest

from tests.f28335.sci_rig import SciRig, frame


@pytest.mark.rule("SCI-138")
def test_rxrdy_requests_rxint():
    SciRig(RXBKINTENA=1).check("""
        > RXD    1  0  11010010  1  1  0  10100101  1  1
        > READ   .  .  ........  .  1  .  ........  .  1
        < RXRDY  0  .  ........  1  0  .  ........  1  0
        < RXINT  0  .  ........  1  .  .  ........  2  .
    """)


@pytest.mark.rule("SCI-139")
def test_without_rx_bk_int_ena_rxrdy_rises_and_requests_nothing():
    rig = SciRig(RXBKINTENA=0).with_rxd(frame(0x4B) + "1")
    assert (rig.get("RXRDY"), rig.count("RXINT")) == (1, 0)


@pytest.mark.rule("SCI-140", "SCI-141", "SCI-142")
@pytest.mark.parametrize(("rx_bk", "rx_err", "after_good", "after_bad"), [(0, 0, 0, 0), (0, 1, 0, 1), (1, 0, 1, 2)])
def test_the_two_receive_interrupt_enables_are_independent(rx_bk, rx_err, after_good, after_bad):
    rig = SciRig(RXBKINTENA=rx_bk, RXERRINTENA=rx_err)
    rig.send_and_read(frame(0x11) + "1")
    assert rig.count("RXINT") == after_good
    rig.send(frame(0x22, bad="stop") + "1")
    assert (rig.get("RXERROR"), rig.count("RXINT")) == (1, after_bad)


@pytest.mark.rule("SCI-140")
@pytest.mark.parametrize(
    "text", [frame(0x11, bad="stop") + "1", frame(0x11) + frame(0x22) + "1", "0" * 10 + "1"], ids=["FE", "OE", "FE, 0"]
)
def test_rxerror_rising_requests_rxint_once(text):
    rig = SciRig(RXERRINTENA=1).with_rxd(text)
    assert (rig.get("RXERROR"), rig.count("RXINT")) == (1, 1)


@pytest.mark.rule("SCI-140")
def test_a_parity_error_requests_rxint():
    rig = SciRig(RXERRINTENA=1, PARITYENA=1)
    rig.send_and_read(frame(0x11, parity="odd") + "1")
    assert rig.count("RXINT") == 0
    rig.send(frame(0x11, parity="even") + "1")
    assert rig.count("RXINT") == 1


@pytest.mark.rule("SCI-141")
def test_without_rx_err_int_ena_no_error_requests_an_interrupt():
    rig = SciRig(RXERRINTENA=0, PARITYENA=1).with_rxd(
        frame(0x11, parity="even", bad="stop") + "1" + frame(0x22, parity="odd") + "1"
    )
    assert (rig.flags("FE", "OE", "PE"), rig.count("RXINT")) == ({"FE": 1, "OE": 1, "PE": 1}, 0)


@pytest.mark.rule("SCI-143", "SCI-144", "SCI-065")
def test_every_transfer_to_txshf_requests_txint():
    SciRig().check("""
        > TXINTENA  .  1  .  .  ........  .  .  ........  .  .
        > SCITXBUF  .  .  .  3  .5......  .  .  ........  .  .
        < TXD       1  .  .  0  1.0.....  1  0  1010....  1  .
        < TXRDY     1  .  .  .  .0......  .  1  ........  .  .
        < TXINT     0  1  .  2  ........  .  3  ........  .  .
    """)


@pytest.mark.rule("SCI-143", "SCI-145")
def test_without_tx_int_ena_txrdy_changes_and_requests_nothing():
    rig = SciRig(TXINTENA=0)
    seen = []
    rig.write("SCITXBUF", 0x11)
    seen.append(rig.get("TXRDY"))
    rig.wait(1)
    seen.append(rig.get("TXRDY"))
    rig.write("SCITXBUF", 0x22)
    seen.append(rig.get("TXRDY"))
    rig.wait(30)
    seen.append(rig.get("TXRDY"))
    assert (seen, rig.count("TXINT")) == ([0, 1, 0, 1], 0)


@pytest.mark.rule("SCI-144")
def test_tx_int_ena_set_while_txrdy_is_1_requests_in_the_same_cycle():
    rig = SciRig()
    rig.set(TXINTENA=1)
    assert rig.requested["TXINT"] == [rig.now]
    rig.wait(20)
    assert rig.count("TXINT") == 1


@pytest.mark.rule("SCI-144")
def test_tx_int_ena_set_while_txrdy_is_0_waits_for_the_transfer():
    rig = SciRig(TXENA=0)
    rig.write("SCITXBUF", 0x11)
    rig.set(TXINTENA=1)
    rig.wait(3)
    assert rig.count("TXINT") == 0
    rig.set(TXENA=1)
    rig.wait(1)
    assert rig.requested["TXINT"] == [rig.falls()[0]]


@pytest.mark.rule("SCI-147")
def test_the_receive_interrupt_comes_three_cycles_after_rxrdy():
    rig = SciRig(RXBKINTENA=1).with_rxd("0 11010010")
    rig.drive(rig.now, "RXD", 1)
    ready = next(time for time, level in rig.changes("RXRDY", rig.bit) if level)
    rig.wait(1)
    assert rig.requested["RXINT"] == [ready + 3]


@pytest.mark.rule("SCI-078", "SCI-138", "SCI-143")
def test_receive_and_transmit_requests_are_independent():
    rig = SciRig(RXBKINTENA=1, TXINTENA=0)
    rig.write("SCITXBUF", 0x11)
    rig.send(frame(0x22) + "1")
    assert (rig.count("RXINT"), rig.count("TXINT")) == (1, 0)
    rig = SciRig(RXBKINTENA=0, TXINTENA=1)
    rig.write("SCITXBUF", 0x11)
    rig.send(frame(0x22) + "1")
    assert (rig.count("RXINT"), rig.count("TXINT")) == (0, 2)
