"""I2CSTR in slave mode: what sets and clears each flag, and what leaves it. SPRUG03B Table 10.

ARDY, AL and NACK in master mode are tested in the tests of the master.
"""

from __future__ import annotations

import pytest

from ..i2c_registers import (
    AAS,
    AD0,
    AL,
    ARDY,
    BB,
    DLB,
    FDF,
    IE_NACK,
    IE_SCD,
    IRS,
    MST,
    NACK,
    NACKMOD,
    NACKSNT,
    RRDY,
    RSFULL,
    SCD,
    SDIR,
    STR_RESET,
    W1C,
    XA,
    XRDY,
    XSMT,
)
from ..i2c_rig import OTHER, OWN, Rig, addressed

TEN = 0x2C5


def read_with_nack(**options) -> Rig:
    """Return a rig whose master has read one byte and sent a NACK. SCL has just fallen; NACK and SDIR are 1."""
    rig = addressed(read=1, **options)
    rig.write_and_read_byte(0x5A, ack=False)
    return rig


def overrun() -> Rig:
    """Return a rig with an overrun: RRDY, RSFULL and AAS are 1, and the chip holds SCL."""
    return addressed(sent=[0x11, 0x22])


def received_with_nack() -> Rig:
    """Return a rig whose chip has sent a NACK as receiver before a STOP: NACKSNT, RRDY and SCD are 1."""
    rig = addressed(mode=NACKMOD, sent=[0x11])
    rig.stop()
    return rig


def ten_bit() -> Rig:
    """Return a rig whose chip was just addressed as a 10-bit slave. SCL has just fallen."""
    rig = Rig().begin(XA, TEN)
    rig.start()
    rig.send(0xF0 | TEN >> 8 << 1)
    rig.send(TEN & 0xFF)
    return rig


def general_call() -> Rig:
    rig = Rig().begin()
    rig.address(0)
    return rig


# All flags


@pytest.mark.rule("I2C-193")
@pytest.mark.parametrize("make", [read_with_nack, overrun, received_with_nack, general_call])
def test_writing_zeros_changes_nothing(make):
    rig = make()
    before = rig.status()
    rig.write("I2CSTR", 0)
    assert rig.status() == before


@pytest.mark.rule("I2C-194", "I2C-013")
@pytest.mark.parametrize("make", [read_with_nack, overrun, received_with_nack, general_call, Rig])
def test_writing_ones_clears_the_w1c_flags_and_no_other(make):
    rig = make()
    before = rig.status()
    rig.write("I2CSTR", 0xFFFF & ~XRDY)
    assert rig.status() == before & ~W1C


@pytest.mark.rule("I2C-194")
def test_the_read_only_flags_were_1_and_0_in_the_test_above():
    """The test above covers read-only flags with both values, so it can fail for each of them."""
    ones = overrun().status() | general_call().status()
    assert ones & (BB | RSFULL | XSMT | AAS | AD0) == BB | RSFULL | XSMT | AAS | AD0
    starved = addressed(read=1)
    assert starved.flag("XSMT") == 0
    starved.write("I2CSTR", XSMT | BB | RSFULL | AAS | AD0)
    assert starved.status(XSMT | RSFULL | AD0) == 0


@pytest.mark.rule("I2C-196", "I2C-202", "I2C-233", "I2C-241", "I2C-254")
@pytest.mark.parametrize(
    "make, flag",
    [
        (read_with_nack, SDIR),
        (read_with_nack, NACK),
        (received_with_nack, NACKSNT),
        (received_with_nack, SCD),
        (received_with_nack, RRDY),
    ],
)
def test_a_one_clears_its_flag_and_leaves_the_others(make, flag):
    rig = make()
    before = rig.status()
    assert before & flag
    rig.write("I2CSTR", flag)
    assert rig.status() == before & ~flag


@pytest.mark.rule(
    "I2C-200",
    "I2C-203",
    "I2C-212",
    "I2C-215",
    "I2C-225",
    "I2C-229",
    "I2C-234",
    "I2C-236",
    "I2C-242",
    "I2C-256",
    "I2C-329",
)
@pytest.mark.parametrize(
    "make, ones",
    [
        (read_with_nack, SDIR | NACK),
        (overrun, AAS | RRDY | RSFULL),
        (received_with_nack, NACKSNT | SCD | RRDY),
        (general_call, AAS | AD0),
        (ten_bit, AAS),
    ],
)
def test_irs_0_and_a_system_reset_set_the_default_values(make, ones):
    rig = make()
    assert rig.status() & ones == ones
    rig.write("I2CMDR", 0)
    assert rig.status() & ~BB == STR_RESET
    rig = make()
    rig.reset()
    assert rig.status() == STR_RESET


@pytest.mark.rule("I2C-215", "I2C-236", "I2C-329")
def test_reset_sets_xsmt_and_xrdy():
    rig = addressed(read=1)
    assert rig.flag("XSMT") == 0
    rig.write("I2CMDR", 0)
    assert rig.status(XSMT) == XSMT
    rig = Rig().begin()
    rig.write("I2CDXR", 1)
    assert rig.flag("XRDY") == 0
    rig.write("I2CMDR", 0)
    assert rig.flag("XRDY")


@pytest.mark.rule("I2C-246")
def test_a_slave_never_sets_ardy():
    for make in (read_with_nack, overrun, received_with_nack, general_call, ten_bit):
        rig = make()
        assert rig.flag("ARDY") == 0
        rig.write("I2CMDR", 0)
    rig = addressed()
    rig.write("I2CCNT", 1)
    rig.send(0x11)
    rig.read("I2CDRR")
    rig.restart(OWN << 1 | 1)
    rig.write_and_read_byte(0x22, ack=False)
    rig.stop()
    assert rig.status(ARDY | AL) == 0


# SDIR


@pytest.mark.rule("I2C-195")
def test_sdir_is_the_direction():
    assert addressed(read=1).flag("SDIR")
    assert not addressed(read=0).flag("SDIR")


rule = pytest.mark.rule

# make; mask of flags; their values before and after START or STOP; level of SDA before it (1: START, 0: STOP)
ENDS = [
    pytest.param(read_with_nack, SDIR, SDIR, 0, 1, marks=rule("I2C-198", "I2C-340"), id="SDIR START"),
    pytest.param(read_with_nack, SDIR | AAS, SDIR, 0, 0, marks=rule("I2C-199", "I2C-220"), id="SDIR STOP"),
    pytest.param(addressed, AAS, AAS, 0, 1, marks=rule("I2C-221"), id="AAS START"),
    pytest.param(addressed, AAS | SCD, AAS, SCD, 0, marks=rule("I2C-220", "I2C-231"), id="AAS STOP"),
    pytest.param(general_call, AD0, AD0, 0, 1, marks=rule("I2C-227"), id="AD0 START"),
    pytest.param(general_call, AD0, AD0, 0, 0, marks=rule("I2C-228"), id="AD0 STOP"),
]


@pytest.mark.parametrize(("make", "flags", "before", "after", "sda"), ENDS)
def test_flags_that_a_repeated_start_or_a_stop_clears(make, flags, before, after, sda):
    rig = make()
    rig.rise(sda)
    rig.wait(rig.bit // 4)
    assert rig.status(flags) == before
    rig.put(sda=1 - sda)
    assert (rig.status(flags), rig.flag("BB")) == (after, sda)


@pytest.mark.rule("I2C-197")
def test_sdir_falls_when_loopback_is_enabled():
    rig = read_with_nack()
    rig.write("I2CMDR", IRS)
    assert rig.flag("SDIR")
    rig.write("I2CMDR", IRS | MST | DLB)
    assert rig.flag("SDIR") == 0


# NACKSNT


@pytest.mark.rule("I2C-201")
def test_nacksnt_is_set_by_a_sent_nack_and_not_by_a_foreign_transfer():
    rig = addressed(mode=NACKMOD)
    assert rig.flag("NACKSNT") == 0
    rig.send(0x11)
    assert rig.flag("NACKSNT")
    rig = Rig().begin()
    rig.receive(0x11, address=OTHER)
    assert rig.flag("NACKSNT") == 0


@pytest.mark.rule("I2C-204")
def test_nacksnt_survives_start_stop_and_a_read_of_isrc():
    rig = addressed(mode=NACKMOD, sent=[0x11])
    rig.restart()
    assert rig.flag("NACKSNT")
    rig.send(OTHER << 1)
    rig.stop()
    assert rig.flag("NACKSNT")
    rig.write("I2CIER", 0x7F)
    rig.wait(20)
    for _ in range(4):
        rig.read("I2CISRC")
        rig.wait(20)
    assert rig.flag("NACKSNT")
    rig.address()
    assert rig.flag("NACKSNT")


# BB


@pytest.mark.rule("I2C-205", "I2C-207", "I2C-340")
@pytest.mark.parametrize("address", [OWN, OTHER])
def test_bb_is_1_from_start_to_stop_for_any_address(address):
    rig = Rig().begin()
    rig.wait(100)
    rig.put(sda=0)
    assert rig.flag("BB")
    rig.fall()
    rig.send(address << 1)
    rig.rise(1)
    rig.wait(10)
    rig.put(sda=0)
    assert rig.flag("BB")
    rig.fall()
    rig.send(address << 1)
    rig.rise(0)
    assert rig.flag("BB")
    rig.wait(10)
    rig.put(sda=1)
    assert rig.flag("BB") == 0


@pytest.mark.rule("I2C-205")
def test_a_clock_edge_without_a_start_leaves_bb():
    rig = Rig().begin()
    rig.put(scl=0)
    rig.put(sda=0)
    rig.wait(100)
    rig.put(scl=1)
    assert rig.flag("BB") == 0


# RSFULL, RRDY


@pytest.mark.rule("I2C-210", "I2C-211", "I2C-239", "I2C-240")
def test_reading_drr_clears_rrdy_and_rsfull_and_loads_the_next_byte():
    rig = overrun()
    assert rig.status(RRDY | RSFULL) == RRDY | RSFULL
    rig.read("I2CDRR")
    assert rig.status(RRDY | RSFULL) == RRDY
    rig.read("I2CDRR")
    assert rig.status(RRDY | RSFULL) == 0


@pytest.mark.rule("I2C-326", "I2C-327", "I2C-328")
def test_debugger_reads_change_nothing():
    rig = overrun()
    for _ in range(2):
        assert rig.peek("I2CDRR") == 0x11
        assert rig.status(RRDY | RSFULL) == RRDY | RSFULL
        assert rig.stretching
    rig = read_with_nack()
    rig.write("I2CIER", IE_NACK)
    rig.wait(20)
    for _ in range(2):
        assert rig.peek("I2CISRC") == 2
        assert rig.flag("NACK")


@pytest.mark.rule("I2C-239")
def test_rrdy_is_set_by_a_data_byte_and_not_by_an_address():
    rig = Rig().begin()
    rig.receive(0x11, address=OTHER)
    rig.stop()
    rig.address(OWN)
    assert rig.flag("RRDY") == 0
    rig.send(0x22)
    assert rig.flag("RRDY")
    assert rig.read("I2CDRR") == 0x22


# XSMT, XRDY


@pytest.mark.rule("I2C-213", "I2C-214", "I2C-235", "I2C-237")
def test_xrdy_and_xsmt_follow_dxr():
    rig = addressed(read=1)
    assert rig.status(XRDY | XSMT) == XRDY
    rig.write("I2CDXR", 0x11)
    rig.wait(100)
    assert rig.status(XRDY | XSMT) == XRDY | XSMT
    rig.write("I2CDXR", 0x22)
    assert rig.status(XRDY | XSMT) == XSMT
    assert rig.read_byte() == 0x11
    assert rig.status(XRDY | XSMT) == XRDY | XSMT
    assert rig.read_byte() == 0x22
    assert rig.status(XRDY | XSMT) == XRDY


@pytest.mark.rule("I2C-238")
def test_xrdy_is_not_cleared_by_writing_1():
    rig = Rig().begin()
    rig.write("I2CSTR", XRDY)
    assert rig.flag("XRDY")


# AAS


@pytest.mark.rule("I2C-216", "I2C-093")
def test_aas_is_set_by_the_own_address():
    rig = Rig().begin()
    rig.address(OTHER)
    assert rig.flag("AAS") == 0
    rig.restart(OWN << 1)
    assert rig.flag("AAS")


@pytest.mark.rule("I2C-217", "I2C-226")
def test_aas_and_ad0_are_set_by_a_general_call():
    rig = Rig().begin()
    rig.start()
    rig.send_bits(0, 7)
    assert rig.status(AAS | AD0) == 0
    rig.clock(0)
    rig.acked()
    assert rig.status(AAS | AD0) == AAS | AD0


@pytest.mark.rule("I2C-218")
def test_aas_in_free_data_format_is_set_by_the_first_byte():
    rig = Rig().begin(FDF)
    rig.start()
    rig.send_bits(0x33, 7)
    assert rig.flag("AAS") == 0
    rig.clock(1)
    rig.acked()
    assert rig.flag("AAS")


@pytest.mark.rule("I2C-219", "I2C-251")
def test_7_bit_aas_falls_with_the_masters_nack():
    rig = addressed(read=1)
    rig.write("I2CDXR", 0x5A)
    rig.read_bits(8)
    assert rig.status(AAS | NACK) == AAS
    rig.clock(1)
    assert rig.status(AAS | NACK) == NACK


@pytest.mark.rule("I2C-222")
def test_10_bit_aas_falls_with_the_masters_nack():
    rig = ten_bit()
    rig.restart(0xF1 | TEN >> 8 << 1)
    rig.write("I2CDXR", 0x5A)
    rig.read_bits(8)
    assert rig.flag("AAS")
    rig.clock(1)
    assert rig.flag("AAS") == 0


@pytest.mark.rule("I2C-223")
def test_10_bit_aas_falls_with_stop():
    rig = ten_bit()
    assert rig.flag("AAS")
    rig.stop()
    assert rig.flag("AAS") == 0


@pytest.mark.rule("I2C-224")
def test_10_bit_aas_survives_a_repeated_start_and_falls_with_another_address():
    rig = ten_bit()
    rig.restart()
    assert rig.flag("AAS")
    rig.send(0xF0 | TEN >> 8 << 1)
    rig.send(TEN & 0xFF ^ 1)
    assert rig.flag("AAS") == 0


@pytest.mark.rule("I2C-224")
def test_10_bit_aas_falls_with_a_foreign_first_byte():
    rig = ten_bit()
    rig.restart()
    rig.send(0xF0 | (TEN >> 8 ^ 1) << 1)
    assert rig.flag("AAS") == 0


# SCD


@pytest.mark.rule("I2C-231", "I2C-232")
def test_scd_is_set_by_a_stop_and_cleared_by_reading_code_6():
    rig = addressed(ier=IE_SCD)
    rig.restart(OWN << 1)
    assert rig.flag("SCD") == 0
    rig.stop()
    assert rig.flag("SCD")
    assert rig.read("I2CISRC", wait=20) == 6
    assert rig.flag("SCD") == 0


@pytest.mark.rule("I2C-232", "I2C-255")
def test_a_read_of_isrc_with_nothing_pending_clears_no_flag():
    rig = read_with_nack()
    rig.stop()
    assert rig.read("I2CISRC", wait=20) == 0
    assert rig.status(SCD | NACK) == SCD | NACK


@pytest.mark.rule("I2C-204", "I2C-231")
def test_a_new_start_leaves_scd():
    rig = addressed()
    rig.stop()
    rig.address()
    assert rig.flag("SCD")


# NACK


@pytest.mark.rule("I2C-251", "I2C-255")
def test_nack_is_set_by_a_nack_of_the_master_and_cleared_by_reading_code_2():
    rig = addressed(read=1, ier=IE_NACK)
    rig.write_each(0x5A, 0x5B)
    rig.read_byte(ack=True)
    assert rig.flag("NACK") == 0
    rig.read_byte(ack=False)
    assert rig.flag("NACK")
    assert rig.read("I2CISRC", wait=20) == 2
    assert rig.flag("NACK") == 0


@pytest.mark.rule("I2C-253")
def test_nack_falls_when_a_later_byte_is_acknowledged():
    rig = read_with_nack()
    rig.restart()
    assert rig.flag("NACK")
    rig.send(OWN << 1 | 1)
    rig.write_and_read_byte(0x11, ack=True)
    assert rig.flag("NACK") == 0


@pytest.mark.rule("I2C-251")
def test_a_nack_sent_as_receiver_does_not_set_nack():
    rig = addressed(mode=NACKMOD, sent=[0x11])
    assert rig.status(NACK | NACKSNT) == NACKSNT
