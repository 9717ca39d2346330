"""I2CINT1A and I2CISRC: requests of flags, their order, and reads of I2CISRC. SPRUG03B section 3, Tables 3, 9, 11.

With the default options, the line pulses when I2CISRC gets a code, two cycles after the event.
"""

from __future__ import annotations

import pytest

from ..i2c_bus import SCL
from ..i2c_registers import (
    AAS,
    AL,
    ARDY,
    FFEN,
    FFRST,
    IE_AAS,
    IE_AL,
    IE_ARDY,
    IE_NACK,
    IE_RRDY,
    IE_SCD,
    IE_XRDY,
    INT1,
    IRS,
    MST,
    NACK,
    NACKMOD,
    RRDY,
    SCD,
    STT,
    TRX,
    XRDY,
)
from ..i2c_rig import BIT, OTHER, OWN, Rig, addressed

SOON = 20  # cycles within which a request must occur


def lose(ie: int = 0) -> Rig:
    """Return a rig with AL = 1, because STT was set during the transfer of another master."""
    rig = Rig().begin(ier=ie)
    rig.address(OTHER)
    rig.write("I2CSAR", OTHER)
    rig.write("I2CCNT", 1)
    rig.write("I2CMDR", IRS | MST | TRX | STT)
    rig.wait(SOON)
    return rig


def refuse(ie: int = 0) -> Rig:
    """Return a rig with NACK = 1, because the master did not acknowledge the byte that it read."""
    rig = addressed(read=1)
    rig.write("I2CDXR", 0x5A)
    rig.write("I2CIER", ie)
    rig.read_byte(ack=False)
    return rig


def master_done(ie: int = 0) -> Rig:
    """Return a rig with ARDY = 1: the chip has sent its only byte as master and waits for the next command."""
    rig = Rig().begin(ier=ie)
    rig.write_other()
    rig.wait_for(lambda: not rig.level[SCL])
    for _ in range(2):
        for pulse in range(9):
            rig.put(sda=int(pulse < 8))
            rig.wait_for(lambda: rig.level[SCL])
            rig.wait_for(lambda: not rig.level[SCL])
        rig.put(sda=1)
    rig.wait(SOON)
    return rig


def receive(ie: int = 0) -> Rig:
    """Return a rig with RRDY = 1."""
    rig = addressed(ier=ie)
    rig.send(0x11)
    return rig


def need_data(ie: int = 0) -> Rig:
    """Return a rig with XRDY = 1 in a transfer that needs data."""
    rig = addressed(read=1)
    rig.write_each(0x11, 0x12)
    rig.write("I2CIER", ie)
    rig.read_byte(ack=True)
    return rig


def stopped(ie: int = 0) -> Rig:
    """Return a rig with SCD = 1."""
    rig = addressed(ier=ie)
    rig.stop()
    return rig


def called(ie: int = 0) -> Rig:
    """Return a rig with AAS = 1."""
    rig = Rig().begin(ier=ie)
    rig.address()
    return rig


SOURCES = [
    pytest.param(lose, AL, IE_AL, 1, id="AL"),
    pytest.param(refuse, NACK, IE_NACK, 2, id="NACK"),
    pytest.param(master_done, ARDY, IE_ARDY, 3, id="ARDY"),
    pytest.param(receive, RRDY, IE_RRDY, 4, id="RRDY"),
    pytest.param(need_data, XRDY, IE_XRDY, 5, id="XRDY"),
    pytest.param(stopped, SCD, IE_SCD, 6, id="SCD"),
    pytest.param(called, AAS, IE_AAS, 7, id="AAS"),
]


@pytest.mark.rule(
    "I2C-265", "I2C-266", "I2C-267", "I2C-268", "I2C-269", "I2C-270", "I2C-271", "I2C-276", "I2C-279", "I2C-282"
)
@pytest.mark.parametrize("make, flag, enable, code", SOURCES)
def test_a_flag_and_its_enable_make_a_request_with_its_code(make, flag, enable, code):
    rig = make(enable)
    rig.wait(SOON)
    assert rig.status(flag)
    assert rig.requested() == INT1
    if code == 5:  # XRDY is cleared by a write only; with XRDY = 0, the read below clears the code
        rig.write("I2CDXR", 0x13)
    assert rig.read("I2CISRC") == code
    rig.wait(SOON)
    if code in (1, 2, 5, 6):
        assert rig.read("I2CISRC") == 0
        assert rig.requested() == 0


@pytest.mark.rule("I2C-272", "I2C-273", "I2C-278")
@pytest.mark.parametrize("make, flag, enable, code", SOURCES)
def test_a_flag_without_its_enable_is_set_and_requests_nothing(make, flag, enable, code):
    rig = make(0)
    rig.wait(SOON)
    assert rig.status(flag)
    assert rig.requested() == 0
    assert rig.read("I2CISRC") == 0


@pytest.mark.rule("I2C-273")
@pytest.mark.parametrize("make, flag, enable, code", SOURCES)
def test_a_flag_requests_nothing_with_all_other_enables(make, flag, enable, code):
    """All requests but that of the flag are enabled: its code is not reported, whatever else is."""
    rig = make(0x7F & ~enable)
    codes = set()
    for _ in range(8):
        rig.wait(SOON)
        codes.add(rig.read("I2CISRC"))
    assert code not in codes


@pytest.mark.rule("I2C-274")
@pytest.mark.parametrize("make, flag, enable, code", SOURCES)
def test_an_enable_set_after_its_flag_requests(make, flag, enable, code):
    rig = make(0)
    rig.wait(SOON)
    rig.requested()
    rig.write("I2CIER", enable)
    assert rig.requested(SOON) == INT1
    assert rig.peek("I2CISRC") == code


@pytest.mark.rule("I2C-275")
def test_the_other_flags_request_nothing():
    """BB, RSFULL, XSMT = 0, AD0, SDIR and NACKSNT occur while three enables are 1, and there is no request."""
    codes = []

    def drain(rig: Rig) -> None:
        for _ in range(8):
            rig.wait(SOON)
            codes.append(rig.read("I2CISRC"))

    rig = Rig().begin(ier=0x7F & ~IE_XRDY & ~IE_AAS & ~IE_RRDY & ~IE_SCD)
    rig.address(0)  # BB, AD0
    drain(rig)
    rig.send(1)
    rig.send(2)  # RSFULL
    drain(rig)
    rig.read("I2CDRR")
    rig.read("I2CDRR")
    rig.write("I2CMDR", IRS | NACKMOD)
    rig.send(3)  # NACKSNT
    drain(rig)
    rig.restart()
    rig.send(OWN << 1 | 1)  # SDIR, XSMT = 0
    drain(rig)
    assert set(codes) == {0}
    assert rig.requested() == 0


@pytest.mark.rule("I2C-276", "I2C-277")
def test_the_seven_requests_never_use_the_fifo_line():
    for make in (lose, refuse, receive, need_data, stopped, called):
        rig = make(0x7F)
        assert rig.requested(SOON) == INT1


@pytest.mark.rule("I2C-279", "I2C-280", "I2C-281", "I2C-282")
def test_reading_a_code_loads_the_next_one_with_a_new_pulse():
    """RRDY and SCD are pending: reading code 4 loads code 6 with a new pulse, and reading code 6 leaves none."""
    rig = addressed(sent=[0x11])
    rig.stop()
    rig.wait(SOON)
    assert rig.status(RRDY | SCD | AAS) == RRDY | SCD
    rig.write("I2CIER", IE_RRDY | IE_SCD)
    assert rig.requested(SOON) == INT1
    rig.read("I2CDRR")
    assert rig.read("I2CISRC") == 4
    assert rig.requested(SOON) == INT1
    assert rig.read("I2CISRC") == 6
    assert rig.requested(SOON) == 0
    assert rig.read("I2CISRC") == 0


@pytest.mark.rule("I2C-281")
def test_a_code_that_is_not_read_causes_no_second_pulse():
    rig = addressed(ier=IE_RRDY | IE_SCD)
    rig.send(0x11)
    rig.stop()
    rig.wait(BIT)
    assert len(rig.interrupts) == 1


@pytest.mark.rule("I2C-232", "I2C-255", "I2C-263", "I2C-283")
@pytest.mark.parametrize("make, enable, flag", [(lose, IE_AL, AL), (refuse, IE_NACK, NACK), (stopped, IE_SCD, SCD)])
def test_reading_codes_1_2_and_6_clears_the_flag(make, enable, flag):
    rig = make(enable)
    rig.wait(SOON)
    others = rig.status() & ~flag
    rig.read("I2CISRC")
    assert rig.status() == others


@pytest.mark.rule("I2C-284", "I2C-285")
@pytest.mark.parametrize(
    "make, enable, flag",
    [(master_done, IE_ARDY, ARDY), (receive, IE_RRDY, RRDY), (need_data, IE_XRDY, XRDY), (called, IE_AAS, AAS)],
)
def test_reading_codes_3_4_5_and_7_leaves_the_flag(make, enable, flag):
    rig = make(enable)
    rig.wait(SOON)
    before = rig.status()
    rig.read("I2CISRC")
    rig.wait(SOON)
    assert rig.status(flag)
    assert rig.status() == before


@pytest.mark.rule("I2C-283")
def test_reading_one_code_clears_no_other_flag():
    """Code 2 is read while SCD is pending: SCD is not cleared, and its code is the next."""
    rig = refuse()
    rig.stop()
    rig.write("I2CIER", IE_NACK | IE_SCD)
    assert rig.read("I2CISRC", wait=SOON) == 2
    rig.wait(SOON)
    assert rig.status(NACK | SCD) == SCD
    assert rig.read("I2CISRC") == 6


@pytest.mark.rule("I2C-286")
@pytest.mark.parametrize("enable, broken", [(IE_XRDY, 1), (IE_RRDY, 1), (0x7F & ~IE_XRDY & ~IE_RRDY, 0)])
@pytest.mark.parametrize("enable_first", [False, True])
def test_in_fifo_mode_a_byte_enable_of_1_is_noted(enable, broken, enable_first):
    rig = Rig()
    if enable_first:
        rig.write("I2CIER", enable)
    rig.write("I2CFFTX", FFEN | FFRST)
    if not enable_first:
        rig.write("I2CIER", enable)
    assert len(rig.duties()) == broken


@pytest.mark.rule("I2C-286")
def test_in_fifo_mode_the_other_requests_work():
    rig = Rig().begin(fifos=(FFEN | FFRST, FFRST | 1))
    for enable, code in ((IE_AAS, 7), (IE_SCD, 6)):
        rig.write("I2CIER", enable)
        rig.address()
        rig.stop()
        assert rig.requested(SOON) == INT1
        assert rig.read("I2CISRC") == code
        rig.write("I2CIER", 0)
        rig.read("I2CISRC")
        rig.requested()
