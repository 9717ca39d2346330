"""IRS, the system reset XRS, and the bit BB around them. SPRUG03B section 4, Table 5 (IRS), text after Table 10."""

from __future__ import annotations

import pytest

from ..i2c_registers import (
    AAS,
    AD0,
    AL,
    BB,
    FDF,
    FREE,
    IE_XRDY,
    INT1,
    IRS,
    MST,
    NACK,
    RRDY,
    SCD,
    STR_RESET,
    STT,
    TRX,
    XA,
)
from ..i2c_rig import BIT, OTHER, OWN, Rig, addressed

SOON = 20  # cycles within which a request must occur

CONFIGURATION = {
    "I2COAR": 0x155,
    "I2CSAR": 0x2AA,
    "I2CCNT": 0x1234,
    "I2CCLKL": 0x0021,
    "I2CCLKH": 0x0043,
    "I2CPSC": 0x0E,
    "I2CIER": 0x6F,
}


def acknowledging() -> Rig:
    """Return a rig whose chip pulls SDA while SCL is low."""
    rig = addressed()
    rig.send_bits(0x11)
    assert rig.pulling_sda
    return rig


def sending_zeros() -> Rig:
    """Return a rig whose chip is in the middle of a byte as transmitter and pulls SDA."""
    rig = addressed(read=1)
    rig.write("I2CDXR", 0x00)
    rig.read_bits(3)
    assert rig.pulling_sda
    return rig


def starved() -> Rig:
    """Return a rig whose chip holds SCL until I2CDXR is written."""
    rig = addressed(read=1)
    assert rig.stretching
    return rig


def overrun() -> Rig:
    """Return a rig whose chip holds SCL until I2CDRR is read."""
    rig = addressed(sent=[1, 2])
    assert rig.stretching
    return rig


@pytest.mark.rule("I2C-330", "I2C-189")
@pytest.mark.parametrize("make", [acknowledging, sending_zeros, starved, overrun])
def test_irs_0_releases_the_pins_at_once(make):
    rig = make()
    rig.write("I2CMDR", 0)
    assert rig.released


@pytest.mark.rule("I2C-330")
@pytest.mark.parametrize("make", [acknowledging, sending_zeros, starved, overrun])
def test_an_interrupted_transfer_does_not_continue_with_irs_1(make):
    rig = make()
    rig.begin_again()
    rig.wait(10 * BIT)
    assert rig.released
    rig.clock(1)
    rig.clock(1)
    assert rig.released
    rig.stop()
    assert rig.address()


@pytest.mark.rule("I2C-329")
@pytest.mark.parametrize("make", [acknowledging, sending_zeros, starved, overrun])
def test_irs_0_sets_every_flag_to_its_default(make):
    rig = make()
    rig.write("I2CMDR", 0)
    assert rig.status() & ~BB == STR_RESET
    rig.write("I2CMDR", IRS)
    assert rig.status() & ~BB == STR_RESET


@pytest.mark.rule("I2C-331")
@pytest.mark.parametrize("noise_filter", [0, 1])
def test_in_reset_no_address_is_acknowledged(noise_filter):
    rig = Rig(noise_filter_cycles=noise_filter)
    rig.write("I2COAR", OWN)
    assert not rig.address()
    assert not rig.send(0x11)
    assert not rig.restart(0)
    rig.stop()
    assert rig.status() == STR_RESET
    rig.write("I2CMDR", IRS)
    assert rig.address()


@pytest.mark.rule("I2C-331")
def test_a_slave_enabled_within_a_byte_waits_for_the_next_start():
    rig = Rig()
    rig.write("I2COAR", OWN)
    rig.start()
    rig.send_bits(OWN >> 4, 3)
    rig.write("I2CMDR", IRS)
    rig.send_bits(OWN << 1 & 0x1F, 5)
    assert not rig.acked()
    rig.send(OWN << 1)
    assert rig.status(AAS | RRDY) == 0
    assert rig.restart(OWN << 1)


@pytest.mark.rule("I2C-332")
def test_in_reset_start_and_stop_are_not_detected():
    rig = Rig()
    rig.address(0)
    assert rig.status(BB | AD0) == 0
    rig.stop()
    assert rig.status(SCD | BB) == 0
    rig.write("I2CMDR", IRS)
    assert rig.status() == STR_RESET


@pytest.mark.rule("I2C-333")
def test_irs_0_keeps_the_configuration():
    rig = Rig()
    for name, value in CONFIGURATION.items():
        rig.write(name, value)
    mode = IRS | FREE | TRX | XA | FDF | 5
    rig.write("I2CMDR", mode)
    rig.write("I2CMDR", mode & ~IRS)
    assert {name: rig.read(name) for name in CONFIGURATION} == CONFIGURATION
    assert rig.read("I2CMDR") == mode & ~IRS


@pytest.mark.rule("I2C-334")
def test_irs_1_enables_a_module_with_both_lines_released():
    rig = starved()
    rig.begin_again()
    assert rig.released
    rig.stop()
    assert rig.address()
    assert rig.send_and_read(0x77) == 0x77


@pytest.mark.rule("I2C-335", "I2C-336")
@pytest.mark.parametrize("make", [acknowledging, sending_zeros, starved, overrun])
def test_xrs_releases_the_bus_and_leaves_the_module_in_reset(make):
    rig = make()
    rig.reset()
    assert rig.released
    assert rig.status() == STR_RESET
    assert rig.read("I2CMDR") == 0
    rig.stop()
    assert not rig.address(0)
    rig.stop()
    rig.write("I2COAR", OWN)
    rig.write("I2CMDR", IRS)
    assert rig.address()


@pytest.mark.rule("I2C-324", "I2C-335")
def test_a_system_reset_ends_the_hold_of_scl_by_a_breakpoint():
    """The next breakpoint does not affect a slave that holds SCL until I2CDXR is written."""
    rig = Rig().begin()
    rig.chip.suspend(rig.now, True)
    rig.start()
    assert rig.stretching
    rig.reset()
    rig.stop()
    rig.begin()
    rig.address(OWN, 1)
    for on in (True, False):
        rig.chip.suspend(rig.now, on)
        rig.settle()
        assert rig.stretching


@pytest.mark.rule("I2C-337")
@pytest.mark.parametrize("name, value", [("I2CCLKL", 11), ("I2CCLKH", 6), ("I2CPSC", 13)])
def test_configuration_with_irs_1_is_noted(name, value):
    rig = Rig()
    rig.write(name, value)
    rig.begin()
    assert rig.duties() == []
    rig.write(name, value + 1)
    assert len(rig.duties()) == 1


# BB


@pytest.mark.rule("I2C-338", "I2C-339")
@pytest.mark.parametrize("address", [OWN, OTHER])
def test_bb_stays_1_during_a_reset_until_the_stop(address):
    rig = Rig().begin()
    rig.address(address)
    rig.write("I2CMDR", 0)
    assert rig.flag("BB")
    rig.wait(BIT)
    assert rig.flag("BB")
    rig.write("I2CMDR", IRS)
    assert rig.flag("BB")
    rig.send(0x11)
    assert rig.flag("BB")
    rig.stop()
    assert rig.flag("BB") == 0


@pytest.mark.rule("I2C-332", "I2C-338", "I2C-339")
def test_bb_stays_1_after_a_stop_during_a_reset_until_the_next_stop():
    rig = addressed()
    rig.write("I2CMDR", 0)
    rig.stop()
    rig.write("I2CMDR", IRS)
    assert rig.flag("BB")
    rig.address(OTHER)
    assert rig.flag("BB")
    rig.stop()
    assert rig.flag("BB") == 0


@pytest.mark.rule("I2C-338", "I2C-339")
def test_bb_stays_0_after_a_start_during_a_reset():
    rig = Rig()
    rig.address(OTHER)
    rig.write("I2CMDR", IRS)
    rig.send(0x11)
    assert rig.flag("BB") == 0
    rig.restart()
    assert rig.flag("BB")


@pytest.mark.rule("I2C-340")
def test_a_repeated_start_leaves_bb_1():
    rig = addressed()
    rig.rise(1)
    rig.wait(10)
    assert rig.flag("BB")
    rig.put(sda=0)
    assert rig.flag("BB")
    rig.wait(10)
    assert rig.flag("BB")


WRONG_BB = {
    0: "STT was set with BB = 0, left from before IRS rose, while a transfer is in progress; wait after IRS = 1 as "
    "long as the longest transfer lasts",
    1: "STT was set with BB = 1, left from before IRS rose, while the bus is free; wait after IRS = 1 as long as the "
    "longest transfer lasts",
}


@pytest.mark.rule("I2C-341")
@pytest.mark.parametrize("waited", [False, True])
def test_a_start_too_soon_after_irs_is_noted_while_another_transfer_is_on_the_bus(waited):
    rig = Rig()
    rig.address(OTHER)
    rig.begin()
    if waited:
        rig.send(0x11)
        rig.stop()
        rig.wait(BIT)
    assert rig.flag("BB") == 0
    rig.write("I2CMDR", IRS | MST | TRX | STT)
    assert [text for text in rig.duties() if "STT" in text] == ([] if waited else [WRONG_BB[0]])


@pytest.mark.rule("I2C-342")
@pytest.mark.parametrize("waited", [False, True])
def test_a_start_too_soon_after_a_later_irs_is_noted_if_bb_stayed_1(waited):
    """BB is wrong because the STOP was sent while IRS was 0; START and STOP of another transfer correct it."""
    rig = Rig().begin()
    rig.address(OTHER)
    rig.write("I2CMDR", 0)
    rig.stop()
    rig.write("I2CMDR", IRS)
    if waited:
        rig.address(OTHER)
        rig.stop()
        rig.wait(BIT)
    assert rig.flag("BB") == (not waited)
    rig.write("I2CMDR", IRS | MST | TRX | STT)
    assert [text for text in rig.duties() if "STT" in text] == ([] if waited else [WRONG_BB[1]])


@pytest.mark.rule("I2C-341", "I2C-342")
@pytest.mark.parametrize("after_later_reset", [False, True])
def test_bb_is_correct_after_a_wait_as_long_as_the_longest_transfer(after_later_reset):
    """IRS rises during a transfer: BB is wrong, 0 or 1, until the end of that transfer."""
    rig = Rig()
    if after_later_reset:
        rig.begin()
        rig.address(OTHER)
        rig.write("I2CMDR", 0)
    else:
        rig.address(OTHER)
    rig.write("I2CMDR", IRS)
    rig.send(0x11)
    rig.send(0x22)
    rig.stop()
    assert rig.flag("BB") == 0
    assert rig.released


@pytest.mark.rule("I2C-329", "I2C-334")
def test_a_module_that_is_reset_between_transfers_answers_each_address():
    """Firmware that emulates several sensors changes the only own address in this way."""
    rig = Rig()
    for address in (0x68, 0x53, 0x1E, 0x68):
        rig.write("I2CMDR", 0)
        rig.write("I2COAR", address)
        rig.write("I2CMDR", IRS)
        assert rig.address(address)
        assert rig.send_and_read(0x32) == 0x32
        assert rig.restart(address << 1 | 1)
        assert rig.flag("SDIR")
        for n in range(6):
            assert rig.write_and_read_byte(address + n, ack=n < 5) == address + n
        rig.stop()


@pytest.mark.rule("I2C-329", "I2C-273")
def test_each_rise_of_irs_requests_again_for_xrdy():
    """XRDY is the only flag that is 1 after a reset: it has its code and request two cycles after each rise of IRS."""
    rig = Rig().begin(ier=IE_XRDY)
    for _ in range(3):
        begun = rig.now
        rig.wait(SOON)
        assert rig.interrupts == [(begun + 2, INT1)]
        assert rig.peek("I2CISRC") == 5
        rig.requested()
        rig.write("I2CMDR", 0)
        rig.wait(SOON)
        assert (rig.peek("I2CISRC"), rig.requested()) == (0, 0)
        rig.write("I2CMDR", IRS)


@pytest.mark.rule("I2C-329")
@pytest.mark.parametrize("point", ["any_ack_fall9", "eager"])
def test_after_irs_0_in_a_transfer_as_master_the_module_works_as_a_slave(point):
    rig = Rig(dxr_to_xsr_copy_point=point).begin()
    rig.write_other(2)
    rig.wait_for(lambda: rig.stretching)
    rig.wait(3 * BIT)
    rig.write("I2CMDR", 0)
    assert not rig.stretching and not rig.pulling_sda
    rig.wait(BIT)
    rig.write("I2CDXR", 0x66)
    rig.write("I2CMDR", IRS)
    assert rig.flag("XRDY") == (point == "eager"), "the byte was copied to I2CXSR"
    assert rig.address(OWN) and rig.send(0x35)
    assert rig.read("I2CDRR") == 0x35
    rig.stop()
    assert rig.status(AL | NACK) == 0
