"""The SCI while the CPU is suspended by a debugger, with each value of SOFT and FREE."""

from __future__ import annotations

import pytest

from tests.f28335.sci_rig import SciRig, frame


@pytest.mark.rule("SCI-209")
def test_soft_0_free_0_stops_the_transmitter_at_once():
    SciRig(SOFT=0, FREE=0).check("""
        > SCITXBUF  .  0  ....  ..........
        > SUSPEND   .  .  ...1  ..........
        < TXD       1  0  ....  ..........
        < TXEMPTY   1  0  ....  ..........
    """)


@pytest.mark.rule("SCI-209")
def test_soft_0_free_0_stops_the_receiver_at_once():
    rig = SciRig(fifo=True)
    begin = rig.send("0 1101")
    rig.chip.suspend(rig.now, True)
    rig.send("0010 1 1" + frame(0x22) + "1", at=begin + 5 * rig.bit)
    assert rig.get("RXFFST") == 0


@pytest.mark.rule("SCI-210")
def test_soft_1_finishes_the_character_that_is_sent():
    SciRig(SOFT=1, FREE=0).check("""
        > SCITXBUF  .  5  3.......  .  .  ........
        > SUSPEND   .  .  ...1....  .  .  ........
        < TXD       1  0  1010....  1  .  ........
    """)


@pytest.mark.rule("SCI-210")
def test_soft_1_finishes_the_character_that_is_received():
    SciRig(fifo=True, SOFT=1, FREE=0).check("""
        > RXD      1  0  11010010  1  1  0  10101010  1  1
        > SUSPEND  .  .  ..1.....  .  .  .  ........  .  .
        < RXFFST   0  .  ........  1  .  .  ........  .  .
    """)


@pytest.mark.rule("SCI-210")
def test_soft_1_stops_the_receiver_when_a_break_drops_the_frame_in_progress():
    """The line is 1 for one SCICLK in the address bit of a frame without stop bit. The next frame begins there."""
    rig = SciRig({"rx_after_break": "next_high"}, fifo=True, ADDRIDLE_MODE=1, SOFT=1, FREE=0)
    rig.send_samples("0" * 78 + "1" + "0" * 20)
    assert rig.flags("RXFFST", "BRKDT") == {"RXFFST": 1, "BRKDT": 0}
    rig.chip.suspend(rig.now, True)
    rig.send("0" * 12 + "1" * 3)
    assert rig.flags("RXFFST", "BRKDT") == {"RXFFST": 1, "BRKDT": 1}
    rig.send(frame(0x4B, address=0) + "1")
    assert rig.get("RXFFST") == 1


@pytest.mark.rule("SCI-211")
@pytest.mark.parametrize("soft", [0, 1])
def test_free_1_continues_to_send_and_receive(soft):
    rig = SciRig(fifo=True, SOFT=soft, FREE=1)
    rig.write("SCITXBUF", 0x11, 0x22, 0x33)
    rig.wait(3)
    rig.chip.suspend(rig.now, True)
    rig.send(frame(0x4B) + frame(0xA5) + "1" * 15)
    assert rig.received() == [0x4B, 0xA5]
    assert rig.characters() == [0x11, 0x22, 0x33]


@pytest.mark.rule("SCI-209", "SCI-210")
@pytest.mark.parametrize("soft", [0, 1])
def test_after_the_suspension_all_waiting_words_are_sent(soft):
    rig = SciRig(fifo=True, SOFT=soft, FREE=0)
    rig.write("SCITXBUF", 0xFF)
    rig.put(0x22, 3)
    rig.chip.suspend(rig.now, True)
    rig.wait(30)
    assert len(rig.falls()) == 1
    rig.chip.suspend(rig.now, False)
    rig.wait(30)
    assert len(rig.falls()) > 1
    assert rig.flags("TXFFST", "TXEMPTY") == {"TXFFST": 0, "TXEMPTY": 1}


@pytest.mark.rule("SCI-212")
def test_a_debugger_reads_scirxemu_without_clearing_rxrdy():
    rig = SciRig().with_rxd(frame(0x4B) + "1")
    rig.chip.suspend(rig.now, True)
    assert [rig.read("SCIRXEMU") for _ in range(3)] == [0x4B] * 3
    assert rig.get("RXRDY") == 1
