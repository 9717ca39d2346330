"""I2C slave-transmitter: requests for I2CDXR, its copy to I2CXSR, and underflow. SPRUG03B Figure 17.

The two halves of the figure, BCM = 1 and BCM = 0, are the diagrams of the first two tests, with
columns of a quarter of a bit.
"""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ..i2c_registers import IE_XRDY, INT1, IRS, RRDY, SDIR, TRX, XRDY, XSMT
from ..i2c_rig import BIT, OTHER, OWN, Rig, addressed

SOON = 20  # cycles within which a request must occur


def reading(bcm: int = 1, **options) -> Rig:
    """Return a rig at fall 7 of the address: the master has sent seven bits of the own address. IE_XRDY is 1."""
    rig = Rig(**options)
    rig.write("I2CEMDR", bcm)
    rig.write("I2CIER", IE_XRDY)
    rig.begin()
    rig.start()
    rig.send_bits(OWN, 7)
    return rig


@pytest.mark.rule(
    "I2C-106", "I2C-112", "I2C-113", "I2C-114", "I2C-115", "I2C-116", "I2C-117", "I2C-118", "I2C-121", "I2C-195"
)
def test_bcm_1_requests_a_byte_ahead():
    """Columns: R bit, ACK slot, byte 0x05, ACK slot, a bit of 0x0A. The CPU writes I2CDXR and then reads I2CISRC."""
    rig = reading(xrdyint_when_idle="only_addressed")
    rig.check(
        """
        > SCL      0.1. 0.1. 0.1.0.1.0.1.0.1.0.1.0.1.0.1.0.1. 0.1. 0.1.
        > SDA      .1.. .... ................................ .0.. .1..
        > DXR      .... .5.. ..a............................. .... ..f.
        > ISRC     .... ..1. ...1............................ .... ...1
        < SDA      01.. 0... ....................1...0...1... .0.. ....
        < sda      1... 0... ....................1...0...1... .... 0...
        < scl      1... .... ................................ .... ....
        < SDIR     0... 1... ................................ .... ....
        < AAS      0... 1... ................................ .... ....
        < XRDY     1... .0.. 1.0............................. .... 1.0.
        < XSMT     1... .... ................................ .... ....
        < INTCODE  0... 5.0. 5..0............................ .... 5..0
    """,
        BIT // 4,
        start=rig.now,
    )


@pytest.mark.rule("I2C-122", "I2C-123", "I2C-124", "I2C-125", "I2C-126")
def test_bcm_0_requests_when_the_byte_is_needed_and_holds_scl_until_it_is_written():
    """Columns: R bit, ACK slot, wait, byte 0x09, ACK, wait, byte 0x0C, NACK."""
    rig = reading(bcm=0)
    rig.check(
        """
        > SCL      0.1. 0.1. 0.1.. ...0.1.0.1.0.1.0.1.0.1.0.1.0.1. 0.1. 0.1.. ...0.1.0.1.0.1.0.1.0.1.0.1.0.1. 0.1. 0...
        > SDA      .1.. .... ..... ............................... .0.. .1... ............................... .... ....
        > DXR      .... .... ..... 9.............................. .... ..... c.............................. .... ....
        > ISRC     .... .... ..... .1............................. .... ..... .1............................. .... ....
        < SCL      0.1. 0.1. 0.... 1..0.1.0.1.0.1.0.1.0.1.0.1.0.1. 0.1. 0.... 1..0.1.0.1.0.1.0.1.0.1.0.1.0.1. 0.1. 0...
        < scl      1... .... 0.... 1.............................. .... 0.... 1.............................. .... ....
        < SDA      01.. 0... 1.... 0..............1...0.......1... .0.. .1... 0..............1.......0....... 1... ....
    """,
        BIT // 4,
        start=rig.now,
    )


@pytest.mark.rule("I2C-122", "I2C-123", "I2C-125", "I2C-126")
def test_bcm_0_has_as_many_requests_as_sent_bytes():
    rig = reading(bcm=0, xrdyint_when_idle="only_addressed")
    requests = 0
    rig.clock(1)
    rig.acked()
    for byte in (0x11, 0x22, 0x33):
        assert rig.peek("I2CISRC", wait=20) == 5
        assert rig.stretching
        requests += 1
        rig.write("I2CDXR", byte)
        rig.read("I2CISRC")
        assert rig.read_byte(ack=byte != 0x33) == byte
    rig.stop()
    assert rig.peek("I2CISRC", wait=BIT) == 0
    assert rig.status(XRDY | XSMT) == XRDY | XSMT
    assert requests == 3


@pytest.mark.rule("I2C-124", "I2C-125")
def test_bcm_0_a_byte_written_ahead_is_sent_after_the_current_one():
    rig = reading(bcm=0)
    rig.clock(1)
    rig.acked()
    rig.write_each(0x11)
    rig.read_bits(3)
    rig.write("I2CDXR", 0x22)
    rig.wait(100)
    assert rig.flag("XRDY") == 0
    assert rig.read_bits(5) == 0x11
    rig.clock(0)
    assert rig.read_byte(ack=False) == 0x22


@pytest.mark.rule("I2C-112")
@pytest.mark.parametrize("repeated", [False, True])
def test_after_an_aborted_transfer_no_data_are_requested(repeated):
    """A START or STOP occurs within a byte, in a bit in which the chip releases SDA."""
    rig = reading(xrdyint_when_idle="only_addressed")
    rig.clock(1)
    rig.write("I2CDXR", 0xFF)
    rig.acked()
    rig.read_bits(2)
    if repeated:
        rig.restart(OTHER << 1)
    rig.stop()
    rig.write("I2CIER", 0)
    rig.wait(SOON)
    rig.read("I2CISRC")
    rig.write("I2CIER", IE_XRDY)
    rig.wait(SOON)
    assert rig.flag("XRDY")
    assert rig.peek("I2CISRC") == 0


@pytest.mark.rule("I2C-119", "I2C-120", "I2C-121")
def test_bcm_1_has_one_more_request_than_sent_bytes_and_the_last_byte_stays():
    rig = reading(xrdyint_when_idle="only_addressed")
    rig.clock(1)
    surplus = iter((0x11, 0x22, 0x33, 0x44, 0x55))
    requests = 0

    def serve() -> None:
        nonlocal requests
        rig.wait(20)
        assert rig.flag("XSMT")
        if rig.peek("I2CISRC") == 5:
            requests += 1
            rig.write("I2CDXR", next(surplus))
            rig.read("I2CISRC")

    serve()
    rig.acked()
    for byte in (0x11, 0x22, 0x33):
        serve()
        assert rig.read_byte(ack=byte != 0x33) == byte
    serve()
    rig.stop()
    serve()
    rig.wait(BIT)
    assert requests == 4
    assert rig.status(XRDY) == 0
    assert rig.peek("I2CDXR") == 0x44


@pytest.mark.rule("I2C-120")
def test_bcm_1_the_final_nack_copies_no_byte():
    rig = addressed(read=1)
    rig.write_each(0x11, 0x22)
    rig.read_bits(8)
    assert rig.flag("XRDY") == 0
    rig.clock(1)
    assert rig.flag("XRDY") == 0
    assert not rig.stretching
    rig.stop()
    assert rig.flag("XRDY") == 0


@pytest.mark.rule("I2C-105", "I2C-106")
@pytest.mark.parametrize("address, read, becomes", [(OWN, 1, 1), (OWN, 0, 0), (OTHER, 1, 0), (0, 0, 0)])
def test_only_the_own_address_with_r_makes_a_slave_transmitter(address, read, becomes):
    rig = Rig().begin()
    rig.start()
    rig.send_bits(address, 7)
    assert rig.flag("SDIR") == 0
    rig.clock(read)
    rig.acked()
    assert rig.flag("SDIR") == becomes


@pytest.mark.rule("I2C-105")
def test_from_receiver_to_transmitter_and_back():
    rig = addressed()
    assert rig.send_and_read(0x01) == 0x01
    assert rig.flag("SDIR") == 0
    rig.restart(OWN << 1 | 1)
    assert rig.flag("SDIR")
    assert rig.write_and_read_byte(0xEE, ack=False) == 0xEE
    assert rig.flag("RRDY") == 0
    rig.restart()
    assert rig.flag("SDIR") == 0
    assert rig.send(OWN << 1)
    assert rig.send_and_read(0x02) == 0x02


@pytest.mark.rule("I2C-107", "I2C-078", "I2C-075")
@settings(max_examples=20, deadline=None)
@given(data=st.lists(st.integers(0, 255), min_size=1, max_size=20), bit=st.sampled_from([120, 375, 1500]))
@pytest.mark.parametrize("bcm", [0, 1])
def test_every_byte_is_sent(bcm, data, bit):
    rig = Rig(bit=bit).begin(bcm=bcm)
    assert rig.address(OWN, 1)
    got = []
    for n, byte in enumerate(data):
        rig.write("I2CDXR", byte)
        got.append(rig.read_byte(ack=n + 1 < len(data)))
    rig.stop()
    assert got == data


@pytest.mark.rule("I2C-107")
def test_sda_changes_only_while_scl_is_low():
    rig = addressed(read=1)
    rig.write("I2CDXR", 0xA5)
    for _ in range(8):
        rig.rise()
        at_rise = rig.chip.out
        rig.wait(BIT // 2 - 1)
        assert rig.chip.out == at_rise
        rig.wait(1)
        rig.put(scl=0)


@pytest.mark.rule("I2C-071")
@pytest.mark.parametrize("bc", range(1, 8))
def test_short_bytes_are_the_low_bits_of_dxr(bc):
    rig = addressed(read=1, mode=bc)
    rig.write("I2CDXR", 0b1011_0101)
    assert rig.read_byte(bits=bc) == 0b1011_0101 & (1 << bc) - 1
    rig.write("I2CDXR", 0b0100_1010)
    assert rig.read_byte(ack=False, bits=bc) == 0b0100_1010 & (1 << bc) - 1


@pytest.mark.rule("I2C-072")
def test_bc_written_after_dxr_is_noted():
    rig = addressed()
    rig.write("I2CMDR", IRS | 4)
    rig.write("I2CDXR", 0x05)
    assert rig.duties() == []
    rig = addressed()
    rig.write("I2CDXR", 0x05)
    rig.write("I2CMDR", IRS | 4)
    assert len(rig.duties()) == 1


# Underflow


@pytest.mark.rule("I2C-108", "I2C-109", "I2C-213", "I2C-214")
def test_an_empty_dxr_holds_scl_after_the_byte_until_it_is_written():
    rig = addressed(read=1)
    rig.write("I2CDXR", 0x11)
    rig.wait(BIT)
    assert not rig.stretching
    assert rig.flag("XSMT")
    assert rig.read_byte() == 0x11
    assert rig.stretching
    assert rig.status(XRDY | XSMT) == XRDY
    rig.wait(100 * BIT)
    assert rig.stretching
    assert rig.status(XRDY | XSMT) == XRDY
    rig.write("I2CDXR", 0x22)
    rig.wait(BIT)
    assert not rig.stretching
    assert rig.status(XRDY | XSMT) == XRDY | XSMT
    assert rig.read_byte(ack=False) == 0x22


@pytest.mark.rule("I2C-110")
@pytest.mark.parametrize("previous", [0x11, 0xF0])
def test_resend_previous_sends_the_last_byte_again(previous):
    rig = addressed(read=1, first=previous, tx_underflow_policy="resend_previous")
    assert rig.read_byte() == previous
    assert not rig.stretching
    assert rig.flag("XSMT") == 0
    assert rig.read_byte() == previous
    rig.write("I2CDXR", 0x22)
    assert rig.flag("XSMT")
    rig.read_byte()
    assert rig.read_byte(ack=False) == 0x22


# BCM


@pytest.mark.rule("I2C-111")
def test_bcm_changes_nothing_for_a_receiver():
    seen = []
    for bcm in (0, 1):
        rig = Rig()
        rig.write("I2CEMDR", bcm)
        rig.write("I2CIER", 0x6F)
        rig.begin()
        trace = [rig.address(), rig.status(), rig.send(0x12), rig.status(), rig.read("I2CDRR")]
        rig.stop()
        seen.append([*trace, rig.status(), rig.interrupts, rig.chip.out])
    assert seen[0] == seen[1]


@pytest.mark.rule("I2C-111")
def test_bcm_changes_no_flag_but_xrdy_and_xsmt_and_no_byte():
    seen = []
    for bcm in (0, 1):
        rig = Rig().begin(bcm=bcm)
        trace = [rig.address(OWN, 1)]
        for byte in (0x12, 0x34):
            rig.write("I2CDXR", byte)
            trace += [rig.read_byte(ack=byte == 0x12), rig.status() & ~(XRDY | XSMT)]
        rig.stop()
        seen.append([*trace, rig.status() & ~(XRDY | XSMT)])
    assert seen[0] == seen[1]


@pytest.mark.rule("I2C-127")
@pytest.mark.parametrize("bcm", [0, 1])
def test_the_request_ends_when_xrdy_falls(bcm):
    rig = reading(bcm, xrdyint_when_idle="only_addressed", int_line="level", isrc_follows_flag="vanishes")
    rig.clock(1)
    if bcm:
        rig.wait(100)
    else:
        assert rig.chip.held == 0
        rig.acked()
        rig.wait(20)
    assert rig.chip.held == INT1
    rig.write("I2CDXR", 0x00)
    if bcm:
        rig.wait(20)
        assert rig.status(XRDY) == 0
        assert rig.chip.held == 0


# Two observations on silicon (open-questions.md, section 0)


def pointer_then_read(wait_for_sdir: bool, *, stop_between: bool, **options) -> list[int]:
    """Return the bytes that a controller reads after writing a pointer, from firmware that sends 1, 2, 3 ...

    The firmware polls and writes I2CDXR whenever XRDY is 1, from RRDY of the pointer byte on, or only from SDIR on.
    """
    rig = Rig(**options).begin(TRX)
    answers = iter(range(1, 20))
    serving = False

    def poll() -> None:
        nonlocal serving
        for _ in range(20):
            rig.wait(25)
            serving = serving or bool(rig.status(SDIR if wait_for_sdir else RRDY))
            if serving and rig.flag("XRDY"):
                rig.write("I2CDXR", next(answers))

    rig.address()
    rig.send_bits(0x00)
    poll()
    rig.acked()
    poll()
    if stop_between:
        rig.stop()
        rig.start()
    else:
        rig.restart()
    rig.send_bits(OWN << 1 | 1)
    poll()
    rig.acked()
    got = []
    for last in (False, False, True):
        poll()
        got.append(rig.read_byte(ack=not last))
    rig.stop()
    return got


@pytest.mark.parametrize("stop_between", [False, True])
def test_bytes_are_correct_with_the_wait_for_sdir_and_shifted_without_it(stop_between):
    assert pointer_then_read(True, stop_between=stop_between) == [1, 2, 3]
    assert pointer_then_read(False, stop_between=stop_between) == [2, 3, 4]
    assert pointer_then_read(False, stop_between=stop_between, dxr_to_xsr_copy_point="ack_fall9") == [1, 2, 3]
