"""The two 16-byte FIFOs of the I2C module in slave mode. SPRUG03B 3.2, Tables 21 and 22."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ..i2c_registers import FFEN, FFIENA, FFINT, FFINTCLR, FFRST, INT2, IRS, RRDY
from ..i2c_rig import BIT, OWN, Rig

SOON = 20


def fifos(tx: int = 0, rx: int = 0, *, begin: bool = True, **options) -> Rig:
    """Return a rig in FIFO mode. tx, rx: further bits of I2CFFTX and I2CFFRX, such as levels and enables."""
    rig = Rig(**options)
    rig.set_fifos(FFEN | FFRST | tx, FFRST | rx)
    if begin:
        rig.begin()
    return rig


def count(rig: Rig, which: str) -> int:
    return rig.peek(f"I2CFF{which}") >> 8 & 31


def flag_of(rig: Rig, which: str) -> int:
    return rig.peek(f"I2CFF{which}") >> 7 & 1


def read_out(rig: Rig, number: int) -> list[int]:
    """Read a number of bytes as the master, with a NACK for the last one and a STOP, and return them."""
    assert rig.address(OWN, 1)
    got = [rig.read_byte(ack=n + 1 < number) for n in range(number)]
    rig.stop()
    return got


@pytest.mark.rule("I2C-287", "I2C-292")
def test_the_transmit_fifo_holds_sixteen_bytes():
    rig = fifos()
    for n in range(16):
        assert count(rig, "TX") == n
        rig.write("I2CDXR", 0x40 + n)
    assert count(rig, "TX") == 16
    assert read_out(rig, 16) == [0x40 + n for n in range(16)]
    assert count(rig, "TX") == 0


@pytest.mark.rule("I2C-287", "I2C-299")
def test_the_receive_fifo_holds_sixteen_bytes():
    rig = fifos()
    rig.address()
    for n in range(16):
        assert count(rig, "RX") == n
        assert rig.send(0x40 + n)
        assert not rig.stretching
    rig.stop()
    assert count(rig, "RX") == 16
    assert [rig.read("I2CDRR") for _ in range(16)] == [0x40 + n for n in range(16)]
    assert count(rig, "RX") == 0


@pytest.mark.rule("I2C-292", "I2C-299")
@settings(max_examples=15, deadline=None)
@given(data=st.lists(st.integers(0, 255), min_size=1, max_size=16))
def test_bytes_are_sent_and_received_in_order(data):
    rig = fifos()
    rig.address()
    for byte in data:
        rig.send(byte)
    rig.restart()
    while count(rig, "RX"):
        rig.write("I2CDXR", rig.read("I2CDRR"))
    rig.send(OWN << 1 | 1)
    got = [rig.read_byte(ack=n + 1 < len(data)) for n in range(len(data))]
    rig.stop()
    assert got == data


@pytest.mark.rule("I2C-288", "I2C-289")
def test_without_fifo_mode_bytes_do_not_go_through_the_fifos():
    """With I2CFFEN = 0, reset bits and levels have no effect: no count, no flag, and a third byte has to wait."""
    rig = Rig().begin(fifos=(FFRST | FFIENA | 4, FFRST | FFIENA))
    rig.write("I2CDXR", 0x11)
    rig.write("I2CDXR", 0x22)
    assert (count(rig, "TX"), flag_of(rig, "TX"), flag_of(rig, "RX")) == (0, 0, 0)
    rig.receive(0x33, 0x44)
    assert rig.flag("RSFULL")
    assert count(rig, "RX") == 0
    assert rig.requested() & INT2 == 0


@pytest.mark.rule("I2C-290", "I2C-291")
def test_txffrst_0_empties_the_transmit_fifo_and_keeps_it_empty():
    rig = fifos()
    rig.write("I2CDXR", 1, 2, 3)
    assert count(rig, "TX") == 3
    rig.write("I2CFFTX", FFEN)
    assert count(rig, "TX") == 0
    rig.write("I2CDXR", 4)
    assert count(rig, "TX") == 0
    rig.write("I2CFFTX", FFEN | FFRST)
    assert count(rig, "TX") == 0
    rig.write("I2CDXR", 5)
    assert count(rig, "TX") == 1


@pytest.mark.rule("I2C-298")
def test_rxffrst_0_empties_the_receive_fifo_and_keeps_it_empty():
    rig = fifos()
    rig.receive(1, 2)
    assert count(rig, "RX") == 2
    rig.write("I2CFFRX", 0)
    assert count(rig, "RX") == 0
    rig.send(3)
    assert count(rig, "RX") == 0
    rig.write("I2CFFRX", FFRST)
    assert count(rig, "RX") == 0
    rig.send(4)
    assert count(rig, "RX") == 1
    assert rig.read("I2CDRR") == 4


@pytest.mark.rule("I2C-240", "I2C-241", "I2C-298")
@pytest.mark.parametrize("cleared", ["by a read of I2CDRR", "by writing 1"])
def test_rxffrst_0_leaves_rrdy_which_a_read_of_i2cdrr_clears_even_with_the_fifo_empty(cleared: str):
    rig = fifos()
    rig.receive(1, 2)
    rig.write("I2CFFRX", 0)
    rig.write("I2CFFRX", FFRST)
    assert (count(rig, "RX"), rig.flag("RRDY")) == (0, 1)
    if cleared == "by writing 1":
        rig.write("I2CSTR", RRDY)
    else:
        rig.read("I2CDRR")
    assert rig.flag("RRDY") == 0
    rig.send(3)
    assert (count(rig, "RX"), rig.flag("RRDY"), rig.read("I2CDRR"), rig.flag("RRDY")) == (1, 1, 3, 0)


# The flags


@pytest.mark.rule("I2C-293")
@pytest.mark.parametrize("level", [0, 1, 3])
def test_txffint_is_set_when_the_count_falls_to_the_level(level):
    rig = fifos(level)
    rig.write("I2CDXR", *range(4))
    rig.write("I2CFFTX", FFEN | FFRST | FFINTCLR | level)
    assert flag_of(rig, "TX") == 0
    rig.address(OWN, 1)
    for last in (False, False, False, True):
        assert flag_of(rig, "TX") == (count(rig, "TX") <= level)
        rig.read_byte(ack=not last)
    assert flag_of(rig, "TX")


@pytest.mark.rule("I2C-294")
@pytest.mark.parametrize("level", [0, 1, 8])
def test_txffint_is_set_when_the_fifo_is_enabled_and_irs_is_1(level):
    rig = fifos(level, begin=False)
    assert flag_of(rig, "TX") == 0
    rig.begin()
    rig.wait(SOON)
    assert flag_of(rig, "TX")
    rig = Rig().begin()
    rig.write("I2CFFTX", FFEN | level)
    assert flag_of(rig, "TX") == 0
    rig.write("I2CFFTX", FFEN | FFRST | level)
    rig.wait(SOON)
    assert flag_of(rig, "TX")


@pytest.mark.rule("I2C-295", "I2C-296")
def test_txffintclr_clears_with_1_and_not_with_0_and_reads_0():
    rig = fifos(0)
    rig.write("I2CDXR", 0x11)
    assert flag_of(rig, "TX")
    rig.write("I2CFFTX", FFEN | FFRST)
    assert flag_of(rig, "TX")
    rig.write("I2CFFTX", FFEN | FFRST | FFINTCLR)
    assert flag_of(rig, "TX") == 0
    assert rig.read("I2CFFTX") & FFINTCLR == 0


@pytest.mark.rule("I2C-293", "I2C-295")
def test_txffint_stays_when_the_count_rises_above_the_level_again():
    rig = fifos(2)
    rig.write("I2CDXR", *range(5))
    assert flag_of(rig, "TX")


@pytest.mark.rule("I2C-300")
@pytest.mark.parametrize("level", [1, 3, 16])
def test_rxffint_is_set_when_the_count_rises_to_the_level(level):
    rig = fifos(0, level)
    rig.address()
    for n in range(1, 17):
        rig.send(n)
        assert flag_of(rig, "RX") == (n >= level)


@pytest.mark.rule("I2C-300", "I2C-303")
def test_rxffint_stays_when_the_fifo_is_emptied():
    rig = fifos(0, 1)
    rig.receive(0x11)
    rig.read("I2CDRR")
    assert flag_of(rig, "RX")


@pytest.mark.rule("I2C-301")
def test_rxffint_with_level_0_is_set_when_the_fifo_is_enabled_and_irs_is_1():
    rig = fifos(begin=False)
    assert flag_of(rig, "RX") == 0
    rig.begin()
    rig.wait(SOON)
    assert flag_of(rig, "RX")
    rig = Rig().begin(fifos=(FFEN, FFRST))
    rig.wait(SOON)
    assert flag_of(rig, "RX")


@pytest.mark.rule("I2C-302")
@pytest.mark.parametrize("before", [False, True])
@pytest.mark.parametrize("irs_first", [False, True])
def test_a_level_written_before_or_with_the_enable_avoids_rxffint(before, irs_first):
    rig = Rig()
    if irs_first:
        rig.begin()
    rig.write("I2CFFTX", FFEN)
    if before:
        rig.write("I2CFFRX", 4)
    rig.write("I2CFFRX", FFRST | 4)
    if not irs_first:
        rig.begin()
    rig.wait(SOON)
    assert flag_of(rig, "RX") == 0


@pytest.mark.rule("I2C-303")
def test_rxffintclr_clears_with_1_and_not_with_0_and_reads_0():
    rig = fifos(0, 2)
    rig.receive(1, 2)
    rig.read("I2CDRR")
    assert flag_of(rig, "RX")
    rig.write("I2CFFRX", FFRST | 2)
    assert flag_of(rig, "RX")
    rig.write("I2CFFRX", FFRST | FFINTCLR | 2)
    assert flag_of(rig, "RX") == 0
    assert rig.read("I2CFFRX") & FFINTCLR == 0


# The requests


@pytest.mark.rule("I2C-297", "I2C-277")
@pytest.mark.parametrize("enabled", [0, FFIENA])
def test_the_transmit_fifo_requests_on_the_second_line_if_enabled(enabled):
    rig = fifos(enabled)
    rig.wait(SOON)
    assert flag_of(rig, "TX")
    assert rig.requested() == (INT2 if enabled else 0)
    assert rig.peek("I2CISRC") == 0


@pytest.mark.rule("I2C-304", "I2C-277")
@pytest.mark.parametrize("enabled", [0, FFIENA])
def test_the_receive_fifo_requests_on_the_second_line_if_enabled(enabled):
    rig = fifos(0, enabled | 1)
    rig.address()
    assert rig.requested() == 0
    rig.send(0x11)
    rig.wait(SOON)
    assert flag_of(rig, "RX")
    assert rig.requested() == (INT2 if enabled else 0)


@pytest.mark.rule("I2C-305")
def test_both_fifos_share_a_line_and_have_separate_flags():
    rig = fifos(FFIENA, FFIENA | 1)
    assert rig.requested(SOON) == INT2
    assert (flag_of(rig, "TX"), flag_of(rig, "RX")) == (1, 0)
    rig.write("I2CDXR", 0x55)
    rig.write("I2CFFTX", FFEN | FFRST | FFINTCLR | FFIENA)
    rig.receive(0x11)
    assert rig.requested(SOON) == INT2
    assert (flag_of(rig, "TX"), flag_of(rig, "RX")) == (flag_of(rig, "TX"), 1)


@pytest.mark.rule("I2C-297", "I2C-304")
def test_an_enable_set_after_its_flag_requests():
    rig = fifos()
    assert rig.requested(SOON) == 0
    rig.write("I2CFFTX", FFEN | FFRST | FFIENA)
    assert rig.requested(SOON) == INT2


def test_an_empty_receive_fifo_can_be_read():
    rig = fifos()
    rig.read("I2CDRR")
    assert count(rig, "RX") == 0


@pytest.mark.rule("I2C-292")
def test_an_empty_transmit_fifo_holds_scl_until_a_byte_is_written():
    rig = fifos()
    rig.address(OWN, 1)
    rig.wait(10 * BIT)
    assert (rig.stretching, rig.flag("XSMT")) == (True, 0)
    rig.write("I2CDXR", 0x3A)
    assert rig.flag("XSMT")
    assert rig.read_byte(ack=False) == 0x3A


@pytest.mark.rule("I2C-290")
def test_irs_is_not_needed_to_reset_the_fifos():
    rig = fifos()
    rig.write("I2CDXR", 0x01)
    rig.write("I2CMDR", 0)
    rig.write("I2CFFTX", FFEN)
    rig.write("I2CFFTX", FFEN | FFRST)
    rig.write("I2CMDR", IRS)
    assert count(rig, "TX") == 0
    assert rig.peek("I2CFFTX") & FFINT


@pytest.mark.rule("I2C-294", "I2C-335")
@pytest.mark.parametrize("mode", ["level", "edge"])
def test_txffint_is_set_again_after_a_system_reset(mode):
    rig = fifos(fifo_int_mode=mode)
    rig.wait(SOON)
    assert flag_of(rig, "TX")
    rig.reset()
    rig.begin()
    rig.write("I2CFFTX", FFEN | FFRST)
    assert flag_of(rig, "TX")


@pytest.mark.rule("I2C-292")
def test_a_17th_byte_for_the_transmit_fifo_is_lost_and_noted():
    rig = fifos()
    room = []
    for n in range(17):
        rig.write("I2CDXR", n)
        room.append(rig.flag("XRDY"))
    assert (count(rig, "TX"), room) == (16, [1] * 15 + [0, 0])
    assert [note.code for note in rig.chip.notes] == ["lost"]
    assert read_out(rig, 16) == list(range(16))
