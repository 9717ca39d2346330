"""I2C slave-receiver: bytes from SDA to I2CDRR, overrun, NACKMOD, short bytes. SPRUG03B 2.3, Tables 1, 2, 5, 10."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ..i2c_registers import AAS, FFEN, FFIENA, FFRST, IRS, NACKMOD, NACKSNT, RRDY, RSFULL, SDIR
from ..i2c_rig import BIT, OWN, Rig, addressed


@pytest.mark.rule("I2C-094", "I2C-097", "I2C-095", "I2C-096", "I2C-205", "I2C-207", "I2C-216", "I2C-220", "I2C-239")
def test_one_byte_written_by_the_master():
    """START, 0x48 W, 0x5A, STOP, with columns of half a bit. scl and sda are the outputs of the chip."""
    rig = Rig().begin()
    rig.check(
        """
        > SCL     1 1 01010101010101 01 01 0101010101010101 01 0 1 1
        > SDA     1 0 1.0.0.1.0.0.0. 0. 1. 0.1.0.1.1.0.1.0. 1. 0 . 1
        < SDA     1 0 1.0...1.0..... .. .. ..1.0.1...0.1.0. .. . . 1
        < sda     1 . .............. .. 0. 1............... 0. 1 . .
        < scl     1 . .............. .. .. ................ .. . . .
        < BB      0 1 .............. .. .. ................ .. . . 0
        < AAS     0 . .............. .. 1. ................ .. . . 0
        < SDIR    0 . .............. .. .. ................ .. . . .
        < RRDY    0 . .............. .. .. ................ 1. . . .
        < SCD     0 . .............. .. .. ................ .. . . 1
    """,
        BIT // 2,
    )
    assert rig.read("I2CDRR") == 0x5A


@pytest.mark.rule("I2C-074", "I2C-095", "I2C-096", "I2C-076", "I2C-098", "I2C-066")
@settings(max_examples=20, deadline=None)
@given(data=st.lists(st.integers(0, 255), min_size=1, max_size=24), bit=st.sampled_from([60, 375, 1500]))
def test_every_byte_is_received_and_acknowledged(data, bit):
    rig = Rig(bit=bit).begin()
    rig.address()
    got = []
    for byte in data:
        assert rig.send(byte)
        assert rig.flag("RRDY")
        got.append(rig.read("I2CDRR"))
    rig.stop()
    assert got == data
    assert rig.status(RRDY | RSFULL | NACKSNT) == 0


@pytest.mark.rule("I2C-104")
@pytest.mark.parametrize("count", [0, 1, 2])
def test_i2ccnt_does_not_limit_a_slave_receiver(count):
    rig = Rig()
    rig.write("I2CCNT", count)
    rig.begin()
    rig.address()
    for byte in range(5):
        assert rig.send_and_read(byte) == byte
    assert rig.read("I2CCNT") == count


@pytest.mark.rule("I2C-098")
def test_the_address_byte_does_not_reach_drr():
    rig = addressed()
    assert rig.flag("RRDY") == 0
    assert rig.read("I2CDRR") == 0


# Overrun


@pytest.mark.rule("I2C-100", "I2C-101", "I2C-102", "I2C-210", "I2C-211", "I2C-240")
def test_a_second_unread_byte_holds_scl_until_drr_is_read():
    rig = addressed()
    assert rig.send(0x11)
    assert rig.send(0x22)
    assert rig.status(RRDY | RSFULL) == RRDY | RSFULL
    assert rig.stretching
    rig.wait(50 * rig.bit)
    assert rig.stretching
    assert rig.peek("I2CDRR") == 0x11
    assert rig.read("I2CDRR") == 0x11
    rig.wait(rig.bit)
    assert not rig.stretching
    assert rig.status(RRDY | RSFULL) == RRDY
    assert rig.read("I2CDRR") == 0x22
    assert rig.status(RRDY | RSFULL) == 0
    assert rig.send_and_read(0x33) == 0x33


@pytest.mark.rule("I2C-101", "I2C-210")
def test_rsfull_is_set_by_the_second_unread_byte():
    rig = addressed(sent=[0x11])
    assert rig.status(RSFULL | RRDY) == RRDY
    rig.send_bits(0x22 >> 1, 7)
    assert rig.flag("RSFULL") == 0
    rig.clock(0)
    rig.acked()
    assert rig.flag("RSFULL")


@pytest.mark.rule("I2C-103")
def test_overwrite_the_newest_byte_stays_in_rsr_and_the_oldest_in_drr():
    rig = addressed(rx_overrun_policy="overwrite")
    for byte in (0x11, 0x22, 0x33):
        assert rig.send(byte)
        assert not rig.stretching
    assert rig.status(RSFULL | RRDY) == RSFULL | RRDY
    assert rig.read("I2CDRR") == 0x11
    assert rig.read("I2CDRR") == 0x33


@pytest.mark.rule("I2C-188", "I2C-201")
def test_nack_an_overrun_is_not_acknowledged():
    rig = addressed(rx_overrun_policy="nack")
    assert rig.send(0x11)
    assert rig.flag("NACKSNT") == 0
    assert not rig.send(0x22)
    assert rig.status(RSFULL | NACKSNT) == RSFULL | NACKSNT
    assert not rig.stretching


@pytest.mark.rule("I2C-100")
def test_i2cstr_after_an_overrun_has_the_value_seen_on_a_related_device():
    """0x1E18 = BB, RSFULL, XSMT, AAS, XRDY, RRDY was reported in TI's E2E forum for the same module of a DM355."""
    rig = addressed(sent=[1, 2])
    assert rig.read("I2CSTR") == 0x1E18


# NACK


@pytest.mark.rule("I2C-182", "I2C-184", "I2C-201")
def test_nackmod_sends_a_nack_for_the_next_byte_and_is_then_cleared():
    rig = addressed()
    assert rig.send(0x11)
    rig.read("I2CDRR")
    rig.write("I2CMDR", IRS | NACKMOD)
    rig.send_bits(0x22)
    assert rig.read("I2CMDR") == IRS | NACKMOD
    assert rig.flag("NACKSNT") == 0
    assert not rig.acked()
    assert rig.read("I2CMDR") == IRS
    assert rig.flag("NACKSNT")
    assert rig.read("I2CDRR") == 0x22


@pytest.mark.rule("I2C-182", "I2C-098", "I2C-189")
def test_without_nackmod_every_byte_is_acknowledged():
    rig = addressed()
    for byte in range(3):
        assert rig.send(byte)
        rig.read("I2CDRR")
    assert rig.flag("NACKSNT") == 0


@pytest.mark.rule("I2C-185", "I2C-186")
@pytest.mark.parametrize("bc", [0, 1, 3, 7])
@pytest.mark.parametrize("late", [-1, 0, 1])
def test_nackmod_must_be_set_before_the_last_data_bit_rises(bc, late):
    """late: cycles from that rise to the write. In the same cycle (0), the rise takes effect before the write."""
    rig = addressed(mode=bc)
    bits = bc or 8
    rig.send_bits(0, bits - 1)
    rise = rig.now + rig.bit // 2
    rig.wait(rig.bit // 4)
    rig.put(sda=1)
    if late < 0:
        rig.run_until(rise + late)
        rig.write("I2CMDR", IRS | NACKMOD | bc)
    rig.run_until(rise)
    rig.put(scl=1)
    if late >= 0:
        rig.run_until(rise + late)
        rig.write("I2CMDR", IRS | NACKMOD | bc)
    rig.fall()
    assert rig.acked() == (late >= 0)
    if late >= 0:
        assert rig.read("I2CMDR") == IRS | NACKMOD | bc
        rig.read("I2CDRR")
        assert not rig.send(0, bits)
    assert rig.read("I2CMDR") == IRS | bc


@pytest.mark.rule("I2C-187")
def test_nackmod_has_no_effect_on_a_transmitter():
    plain, nackmod = addressed(read=1), addressed(read=1)
    nackmod.write("I2CMDR", IRS | NACKMOD)
    for rig in (plain, nackmod):
        assert rig.write_and_read_byte(0x81) == 0x81
        assert rig.write_and_read_byte(0x18, ack=False) == 0x18
    assert plain.status() == nackmod.status()
    assert nackmod.flag("NACKSNT") == 0


@pytest.mark.rule("I2C-189")
def test_irs_0_ends_the_acknowledge():
    rig = addressed()
    rig.send_bits(0x11)
    assert rig.pulling_sda
    rig.write("I2CMDR", 0)
    assert not rig.pulling_sda
    assert not rig.acked()


@pytest.mark.rule("I2C-189")
def test_a_byte_is_not_acknowledged_after_irs_0_within_it():
    rig = addressed()
    rig.send_bits(0x1, 4)
    rig.write("I2CMDR", 0)
    rig.send_bits(0x1, 4)
    assert not rig.acked()


# Short bytes


@pytest.mark.rule("I2C-067", "I2C-068", "I2C-070")
@pytest.mark.parametrize("bc", range(1, 8))
def test_short_data_bytes_are_right_justified(bc):
    """The address still has eight bits; the acknowledge follows the last bit of a byte."""
    rig = addressed(mode=bc)
    mask = (1 << bc) - 1
    for value in (0x00 & mask, 0x7F & mask, 0x55 & mask):
        assert rig.send(value, bc)
        assert rig.flag("RRDY")
        assert rig.read("I2CDRR") & mask == value


@pytest.mark.rule("I2C-068")
@pytest.mark.parametrize("bc", [1, 4, 7])
@pytest.mark.parametrize("repeated", [False, True])
def test_an_address_after_short_data_bytes_has_eight_bits_again(bc, repeated):
    rig = addressed(mode=bc)
    assert rig.send(0, bc)
    rig.read("I2CDRR")
    if repeated:
        rig.restart()
    else:
        rig.stop()
        rig.start()
    assert rig.send(OWN << 1)
    assert rig.send(1, bc)
    assert rig.read("I2CDRR") & (1 << bc) - 1 == 1


@pytest.mark.rule("I2C-066")
def test_bc_0_means_eight_bits():
    rig = addressed(mode=0)
    rig.send_bits(0xFF, 7)
    assert rig.flag("RRDY") == 0
    rig.clock(1)
    assert rig.pulling_sda
    rig.acked()
    assert rig.read("I2CDRR") == 0xFF


@pytest.mark.rule("I2C-069")
def test_bc_written_within_a_byte_applies_to_the_next_byte():
    rig = addressed(mode=0)
    rig.send_bits(0xA, 4)
    rig.write("I2CMDR", IRS | 4)
    rig.send_bits(0x5, 4)
    assert rig.acked()
    assert rig.read("I2CDRR") == 0xA5
    assert rig.send(0x9, 4)
    assert rig.read("I2CDRR") & 0xF == 0x9


@pytest.mark.rule("I2C-073")
def test_different_lengths_of_bytes_break_the_transfer():
    """The chip uses the fifth bit of the master as acknowledge bit; the firmware must set equal lengths."""
    rig = addressed(mode=4)
    rig.send_bits(0xA, 4)
    assert rig.pulling_sda
    same = addressed(mode=4)
    assert same.send(0xA, 4)
    assert same.read("I2CDRR") & 0xF == 0xA


# Wake-ups


class Stepped(Rig):
    """Waits cycle by cycle and checks that outputs and registers change only at inputs and due wake-ups."""

    def seen(self) -> tuple[int, ...]:
        registers = ("I2CSTR", "I2CISRC", "I2CDRR", "I2CMDR", "I2CDXR", "I2CFFTX", "I2CFFRX")
        return (self.chip.out, self.chip.held, self.chip.requests, *(self.peek(name) for name in registers))

    def wait(self, cycles: int) -> None:
        for time in range(self.now + 1, self.now + cycles + 1):
            before, due = self.seen(), self.chip.next_wake
            self.run_until(time)
            assert due <= time or self.seen() == before, f"change at {time} without an input or a due wake-up"


@pytest.mark.parametrize("noise", [0, 1])
@pytest.mark.parametrize("fifo", [False, True])
def test_nothing_changes_between_inputs_and_due_wake_ups(noise, fifo):
    rig = Stepped(bit=128, noise_filter_cycles=noise)
    rig.write("I2CIER", 0x7F)
    if fifo:
        rig.set_fifos(FFEN | FFRST | FFIENA, FFRST | FFIENA | 2)
    rig.begin()
    rig.start()
    assert rig.send(OWN << 1)
    assert rig.send_and_read(0x5A) == 0x5A
    assert rig.restart(OWN << 1 | 1)
    assert rig.status(AAS | SDIR) == AAS | SDIR
    rig.wait(100)
    assert rig.write_and_read_byte(0x96, ack=False) == 0x96
    rig.stop()
    rig.wait(128)
    assert not rig.stretching
