"""Open questions about the I2C module as slave, its receiver, FIFOs and registers, with every value of the options.

TI's documents do not answer them or contradict each other. The first value of each list is the default.
"""

from __future__ import annotations

import pytest

from ..i2c_registers import (
    AAS,
    AD0,
    BB,
    FDF,
    FFEN,
    FFINTCLR,
    FFRST,
    IE_AAS,
    IE_NACK,
    IE_RRDY,
    IE_SCD,
    IE_XRDY,
    INT1,
    IRS,
    NACKMOD,
    RRDY,
    SCD,
    SDIR,
    STP,
    TRX,
    XRDY,
    XSMT,
)
from ..i2c_rig import BIT, OTHER, OWN, Rig, addressed

SOON = 20
COPY_POINTS = ["any_ack_fall9", "ack_fall9", "ack_rise9", "eager", "eager_if_trx", "eager_reloaded_at_address"]


def idle(mode: int = 0, **options) -> Rig:
    return Rig(**options).begin(mode)


def read_bytes(count: int, **options) -> Rig:
    """Return a rig whose master has read `count` bytes 0x11, 0x12, ..., each written when needed, with a NACK."""
    rig = addressed(read=1, first=0x11, **options)
    for n in range(count):
        if n:
            rig.write("I2CDXR", 0x11 + n)
        assert rig.read_byte(ack=n + 1 < count) == 0x11 + n
    return rig


# Slave-transmitter


@pytest.mark.rule("I2C-002", "I2C-024")
@pytest.mark.parametrize("present", [True, False])
def test_open_emdr_present(present):
    rig = Rig(emdr_present=present, xrdyint_when_idle="only_addressed")
    assert rig.read("I2CEMDR") == int(present)
    rig.write("I2CEMDR", 0)
    assert rig.read("I2CEMDR") == 0
    rig.write("I2CIER", IE_XRDY)
    rig.begin()
    rig.begin_read()
    assert rig.peek("I2CISRC", wait=SOON) == (0 if present else 5), "with BCM = 0, the request is later"
    rig.reset()
    rig.write("I2CEMDR", 1)
    assert rig.read("I2CEMDR") == int(present)


@pytest.mark.rule("I2C-024")
@pytest.mark.parametrize("bcm", [1, 0])
def test_open_bcm_reset(bcm):
    rig = Rig(bcm_reset=bcm, xrdyint_when_idle="only_addressed")
    assert rig.read("I2CEMDR") == bcm
    rig.write("I2CIER", IE_XRDY)
    rig.begin()
    rig.begin_read()
    assert rig.peek("I2CISRC", wait=SOON) == 5 * bcm
    written = Rig(bcm_reset=bcm)
    written.write("I2CEMDR", 1)
    written.begin()
    assert written.address(OWN, 1)


@pytest.mark.rule("I2C-113", "I2C-195", "I2C-216")
@pytest.mark.parametrize("point", ["fall8", "rise8", "fall9"])
def test_open_aas_sdir_point(point):
    rig = idle(aas_sdir_point=point)
    rig.start()
    rig.send_bits(OWN, 7)
    shown = []
    rig.rise(1)
    shown.append(("rise8", rig.status(AAS | SDIR)))
    rig.fall()
    shown.append(("fall8", rig.status(AAS | SDIR)))
    rig.rise(1)
    shown.append(("rise9", rig.status(AAS | SDIR)))
    rig.fall()
    shown.append(("fall9", rig.status(AAS | SDIR)))
    places = [place for place, _ in shown]
    assert shown == [(p, AAS | SDIR if places.index(p) >= places.index(point) else 0) for p in places]


@pytest.mark.rule("I2C-115", "I2C-053")
@pytest.mark.parametrize("point", COPY_POINTS)
@pytest.mark.parametrize("trx", [0, TRX])
def test_open_dxr_to_xsr_copy_point_idle(point, trx):
    """0x11 and then 0x22 are written on an idle bus before the master reads."""
    rig = idle(trx, dxr_to_xsr_copy_point=point)
    rig.write("I2CDXR", 0x11)
    eager = point in ("eager", "eager_reloaded_at_address") or (point == "eager_if_trx" and trx != 0)
    assert rig.flag("XRDY") == eager
    rig.write("I2CDXR", 0x22)
    assert rig.flag("XRDY") == 0
    rig.address(OWN, 1)
    assert rig.read_byte() == (0x11 if eager and point != "eager_reloaded_at_address" else 0x22)


@pytest.mark.rule("I2C-115")
@pytest.mark.parametrize("point", COPY_POINTS)
def test_open_dxr_to_xsr_copy_point_inside_the_ack_slot(point):
    """0x11 is written in the first half of the address-ACK slot, 0x22 in the second half."""
    rig = idle(dxr_to_xsr_copy_point=point)
    rig.begin_read()
    rig.write("I2CDXR", 0x11)
    rig.rise()
    rig.wait(BIT // 4)
    rig.write("I2CDXR", 0x22)
    rig.fall()
    first = 0x11 if point in ("ack_rise9", "eager", "eager_reloaded_at_address") else 0x22
    assert rig.read_byte(ack=first == 0x11) == first
    if first == 0x11:
        assert rig.read_byte(ack=False) == 0x22


@pytest.mark.rule("I2C-115")
@pytest.mark.parametrize("point", COPY_POINTS)
def test_open_dxr_to_xsr_copy_point_while_receiving(point):
    """0x11 is in I2CDXR while a pointer byte is received; only `any_ack_fall9` copies it then."""
    rig = addressed(dxr_to_xsr_copy_point=point)
    rig.write("I2CDXR", 0x11)
    before = rig.flag("XRDY")
    rig.send(0x00)
    assert before == (point in ("eager", "eager_reloaded_at_address"))
    assert rig.flag("XRDY") == (before or point == "any_ack_fall9")


@pytest.mark.rule("I2C-118")
@pytest.mark.parametrize("point", COPY_POINTS)
def test_open_dxr_to_xsr_copy_point_between_data_bytes(point):
    """0x22 is in I2CDXR while 0x11 is sent; XRDY rises at the edge at which 0x22 is copied."""
    rig = addressed(read=1, first=0x11, dxr_to_xsr_copy_point=point, xrdy_rise_point="at_copy", mode=TRX)
    if not rig.flag("XRDY"):
        rig.wait(100)
    rig.write("I2CDXR", 0x22)
    rig.read_bits(7)
    assert rig.flag("XRDY") == 0
    rig.clock(1)
    edges = {"fall8": rig.flag("XRDY")}
    rig.rise(0)
    edges["rise9"] = rig.flag("XRDY")
    rig.fall()
    edges["fall9"] = rig.flag("XRDY")
    moved = "fall8" if point.startswith("eager") else "rise9" if point == "ack_rise9" else "fall9"
    assert next(edge for edge, xrdy in edges.items() if xrdy) == moved
    assert rig.read_byte(ack=False) == 0x22


@pytest.mark.rule("I2C-116", "I2C-118")
@pytest.mark.parametrize("point", ["fall9", "at_copy"])
def test_open_xrdy_rise_point(point):
    rig = idle(xrdy_rise_point=point, dxr_to_xsr_copy_point="ack_rise9")
    rig.begin_read()
    rig.write("I2CDXR", 0x11)
    rig.rise()
    assert rig.flag("XRDY") == (point == "at_copy")
    rig.fall()
    assert rig.flag("XRDY")
    rig.write("I2CDXR", 0x22)
    assert rig.read_bits(8) == 0x11
    rig.rise(0)
    assert rig.flag("XRDY") == (point == "at_copy")
    rig.fall()
    assert rig.flag("XRDY")


@pytest.mark.rule("I2C-112", "I2C-269")
@pytest.mark.parametrize("when", ["level", "only_addressed"])
def test_open_xrdyint_when_idle(when):
    rig = idle(xrdyint_when_idle=when)
    rig.write("I2CIER", IE_XRDY)
    assert rig.requested(SOON) == (INT1 if when == "level" else 0)
    assert rig.peek("I2CISRC") == (5 if when == "level" else 0)
    rig.begin_read()
    assert rig.peek("I2CISRC", wait=SOON) == 5


@pytest.mark.rule("I2C-108", "I2C-110")
@pytest.mark.parametrize("policy", ["stretch", "resend_previous", "send_ones"])
def test_open_tx_underflow_policy(policy):
    rig = addressed(read=1, first=0x5A, tx_underflow_policy=policy)
    assert rig.read_byte() == 0x5A
    rig.wait(BIT)
    assert rig.stretching == (policy == "stretch")
    assert rig.flag("XSMT") == 0
    if policy != "stretch":
        assert rig.read_byte(ack=False) == (0x5A if policy == "resend_previous" else 0xFF)


@pytest.mark.rule("I2C-108")
@pytest.mark.parametrize("stretches", [True, False])
def test_open_stretch_after_address_ack(stretches):
    rig = read_bytes(1, stretch_after_address_ack=stretches)
    rig.stop()
    rig.address(OWN, 1)
    rig.wait(BIT)
    assert rig.stretching == stretches
    if not stretches:
        assert rig.read_byte(ack=False) == 0x11, "the byte that was left in I2CXSR"


@pytest.mark.parametrize("stretches", [True, False])
def test_open_stretch_after_address_ack_in_the_free_data_format(stretches):
    """In this format, the first byte follows the START."""
    rig = idle(FDF | TRX, stretch_after_address_ack=stretches)
    rig.start()
    assert rig.stretching == stretches


@pytest.mark.rule("I2C-124", "I2C-213", "I2C-214")
@pytest.mark.parametrize("rule", ["text", "figure"])
def test_open_xsmt_rule(rule):
    """BCM = 0, at the end of the address ACK slot. Only the figure has a time between write and copy."""
    rig = Rig(xsmt_rule=rule).begin(bcm=0)
    rig.address(OWN, 1)
    assert rig.stretching
    assert rig.status(XRDY | XSMT) == (XRDY if rule == "text" else XRDY | XSMT)
    rig.write("I2CDXR", 0x5A)
    assert rig.flag("XSMT") == (rule == "text")
    rig.wait(BIT)
    assert not rig.stretching
    assert rig.status(XRDY | XSMT) == XRDY | XSMT
    assert rig.read_byte(ack=False) == 0x5A


@pytest.mark.rule("I2C-119")
@pytest.mark.parametrize("fate", ["sent_first", "discarded"])
def test_open_stale_byte_next_read(fate):
    rig = addressed(read=1, stale_byte_next_read=fate)
    rig.write_each(0x11, 0x22)
    assert rig.read_byte(ack=False) == 0x11
    rig.stop()
    rig.address(OWN, 1)
    rig.wait(BIT)
    assert rig.stretching == (fate == "discarded")
    assert rig.flag("XRDY")
    rig.write("I2CDXR", 0x33)
    assert rig.read_byte(ack=False) == (0x22 if fate == "sent_first" else 0x33)


@pytest.mark.rule("I2C-237")
@pytest.mark.parametrize(
    "policy, sent", [("overwrite", [0x22]), ("ignored", [0x11]), ("queued_behind_xsr", [0x11, 0x22])]
)
def test_open_dxr_write_while_full(policy, sent):
    rig = idle(dxr_write_while_full=policy)
    rig.write("I2CDXR", 0x11)
    rig.write("I2CDXR", 0x22)
    assert rig.flag("XRDY") == 0
    rig.address(OWN, 1)
    assert [rig.read_byte() for _ in sent] == sent
    assert rig.stretching


@pytest.mark.rule("I2C-236", "I2C-333")
@pytest.mark.parametrize("fate", ["data_kept_xrdy_1", "kept_and_still_sent"])
def test_open_dxr_survives_irs(fate):
    rig = idle(dxr_survives_irs=fate)
    rig.write("I2CDXR", 0x5A)
    rig.begin_again()
    assert rig.flag("XRDY")
    assert rig.read("I2CDXR") == 0x5A
    rig.address(OWN, 1)
    rig.wait(BIT)
    assert rig.stretching == (fate == "data_kept_xrdy_1")
    if rig.stretching:
        rig.write("I2CDXR", 0x66)
    assert rig.read_byte(ack=False) == (0x66 if fate == "data_kept_xrdy_1" else 0x5A)


@pytest.mark.rule("I2C-119", "I2C-120")
@pytest.mark.parametrize("clears", [False, True])
def test_open_nack_clears_dxr(clears):
    rig = addressed(read=1, nack_clears_dxr=clears)
    rig.write_each(0x11, 0x22)
    rig.read_byte(ack=False)
    assert rig.flag("XRDY") == clears
    rig.stop()
    rig.address(OWN, 1)
    rig.wait(BIT)
    assert rig.stretching == clears


@pytest.mark.rule("I2C-120", "I2C-213")
@pytest.mark.parametrize("what", ["stays_1", "0_without_stretch"])
def test_open_xsmt_on_final_nack(what):
    rig = read_bytes(1, xsmt_on_final_nack=what)
    assert rig.flag("XSMT") == (what == "stays_1")
    assert not rig.stretching


@pytest.mark.rule("I2C-251", "I2C-266")
@pytest.mark.parametrize("asks", [True, False])
def test_open_nackint_in_slave_tx(asks):
    rig = addressed(read=1, nackint_in_slave_tx=asks, ier=IE_NACK)
    rig.write_and_read_byte(0x5A, ack=False)
    rig.wait(SOON)
    assert rig.flag("NACK")
    assert rig.peek("I2CISRC") == (2 if asks else 0)
    assert rig.requested() == (INT1 if asks else 0)


@pytest.mark.rule("I2C-198", "I2C-199")
@pytest.mark.parametrize("clear", ["any_start_or_stop", "until_next_address"])
@pytest.mark.parametrize("address", [OWN, OTHER])
def test_open_sdir_clear(clear, address):
    rig = read_bytes(1, sdir_clear=clear)
    rig.stop()
    assert rig.flag("SDIR") == (clear == "until_next_address")
    rig.start()
    assert rig.flag("SDIR") == (clear == "until_next_address")
    rig.send(address << 1)
    assert rig.flag("SDIR") == 0


@pytest.mark.rule("I2C-128")
@pytest.mark.parametrize("effect", ["no_effect", "counts_bytes"])
def test_open_cnt_in_slave_tx(effect):
    """I2CCNT is 2, and the master reads 3 bytes, twice."""
    rig = Rig(cnt_in_slave_tx=effect)
    rig.write("I2CCNT", 2)
    rig.begin()
    for _ in range(2):
        rig.begin_read()
        got = []
        for byte in (0x11, 0x22, 0x33):
            if rig.flag("XRDY"):
                rig.write("I2CDXR", byte)
            if byte == 0x11:
                rig.acked()
            got.append(rig.read_byte(ack=byte != 0x33))
        rig.stop()
        assert got[:2] == [0x11, 0x22]
        assert got[2] == (0x33 if effect == "no_effect" else 0xFF)
        rig.begin_again()
    assert rig.read("I2CCNT") == 2


@pytest.mark.rule("I2C-334")
@pytest.mark.parametrize("releases", [False, True])
def test_open_irs_write1_releases_bus(releases):
    rig = addressed(read=1, irs_write1_releases_bus=releases)
    assert rig.stretching
    rig.write("I2CMDR", IRS)
    rig.wait(BIT)
    assert rig.stretching != releases


# Receiver


@pytest.mark.rule("I2C-096", "I2C-239")
@pytest.mark.parametrize("point", ["fall8", "rise9", "fall9"])
def test_open_rrdy_point(point):
    rig = addressed(rrdy_point=point)
    rig.send_bits(0x5A >> 1, 7)
    places = ["rise8", "fall8", "rise9", "fall9"]
    shown = []
    rig.rise(0)
    shown.append(rig.flag("RRDY"))
    rig.fall()
    shown.append(rig.flag("RRDY"))
    rig.rise(1)
    shown.append(rig.flag("RRDY"))
    rig.fall()
    shown.append(rig.flag("RRDY"))
    assert shown == [int(places.index(p) >= places.index(point)) for p in places]
    assert rig.read("I2CDRR") == 0x5A


@pytest.mark.rule("I2C-098", "I2C-100", "I2C-103", "I2C-188")
@pytest.mark.parametrize("policy", ["stretch_after_second_byte", "nack", "overwrite"])
def test_open_rx_overrun_policy(policy):
    rig = addressed(rx_overrun_policy=policy, sent=[0x11])
    assert rig.send(0x22) == (policy != "nack")
    assert rig.flag("RSFULL")
    assert rig.stretching == (policy == "stretch_after_second_byte")
    if policy == "overwrite":
        assert rig.send(0x33)
    assert rig.read("I2CDRR") == 0x11
    assert rig.read("I2CDRR") == (0x33 if policy == "overwrite" else 0x22)


@pytest.mark.rule("I2C-100")
@pytest.mark.parametrize("point", ["after_fall9", "before_ack"])
def test_open_rsfull_stretch_point(point):
    rig = addressed(rsfull_stretch_point=point, sent=[0x11])
    rig.send_bits(0x22)
    rig.wait(BIT)
    assert rig.stretching == (point == "before_ack")
    if point == "before_ack":
        rig.read("I2CDRR")
        rig.wait(BIT)
        assert not rig.stretching
    assert rig.acked()
    rig.wait(BIT)
    assert rig.stretching == (point == "after_fall9")


@pytest.mark.rule("I2C-070")
@pytest.mark.parametrize("upper", ["last_bits", "zeros"])
def test_open_bc_less_than_8_upper_bits(upper):
    """1111 and 0101 are received with BC = 4: the upper four bits are the previous ones, or zeros."""
    rig = addressed(mode=4, bc_less_than_8_upper_bits=upper)
    rig.send(0xF, 4)
    rig.read("I2CDRR")
    rig.send(0x5, 4)
    assert rig.read("I2CDRR") == (0xF5 if upper == "last_bits" else 0x05)


@pytest.mark.rule("I2C-182")
@pytest.mark.parametrize("scope", ["data_only", "address_too"])
def test_open_nackmod_on_address(scope):
    rig = idle(NACKMOD, nackmod_on_address=scope)
    assert rig.address() == (scope == "data_only")
    assert not rig.send(0x11)
    assert rig.flag("RRDY") == (scope == "data_only")
    assert rig.flag("NACKSNT")


# Bus state, addresses


@pytest.mark.rule("I2C-209", "I2C-329", "I2C-338", "I2C-339")
@pytest.mark.parametrize("what", ["keep", "clear"])
def test_open_bb_on_irs_reset(what):
    rig = addressed(bb_on_irs_reset=what)
    rig.write("I2CMDR", 0)
    assert rig.flag("BB") == (what == "keep")
    rig.write("I2CMDR", IRS)
    assert rig.flag("BB") == (what == "keep")
    rig.restart()
    assert rig.flag("BB")
    rig.stop()
    assert rig.flag("BB") == 0


@pytest.mark.rule("I2C-337")
@pytest.mark.parametrize("latch", ["live", "at_irs", "at_start"])
def test_open_oar_latch(latch):
    rig = idle(oar_latch=latch)
    rig.start()
    rig.send_bits(OTHER >> 4, 3)
    rig.write("I2COAR", OTHER)
    rig.send_bits(OTHER << 1 & 0x1F, 5)
    assert rig.acked() == (latch == "live")
    rig.stop()
    assert rig.address(OTHER) == (latch != "at_irs")
    rig.stop()
    assert rig.address(OWN) == (latch == "at_irs")
    rig.stop()
    rig.begin_again()
    assert rig.address(OTHER)


@pytest.mark.rule("I2C-090", "I2C-217")
@pytest.mark.parametrize("answer", ["acknowledged", "ignored"])
def test_open_general_call(answer):
    rig = idle(general_call=answer)
    assert rig.address(0) == (answer == "acknowledged")
    assert rig.flag("AAS") == (answer == "acknowledged")


@pytest.mark.rule("I2C-231")
@pytest.mark.parametrize("which", ["every_stop", "own_transfers"])
def test_open_scd_foreign(which):
    rig = idle(scd_foreign=which)
    rig.address(OTHER)
    rig.stop()
    assert rig.flag("SCD") == (which == "every_stop")
    rig.write("I2CSTR", SCD)
    rig.address(OWN)
    rig.stop()
    assert rig.flag("SCD")


@pytest.mark.rule("I2C-091")
@pytest.mark.parametrize("what", ["stays_0", "set"])
def test_open_start_byte_ad0(what):
    rig = idle(start_byte_ad0=what)
    rig.start()
    assert not rig.send(0x01)
    assert rig.status(AD0 | AAS) == (AD0 if what == "set" else 0)


@pytest.mark.rule("I2C-090")
@pytest.mark.parametrize("what", ["general_call_only", "own_address_too"])
def test_open_oar_zero(what):
    rig = Rig(oar_zero=what).begin(oar=0)
    rig.start()
    assert rig.send(0x01) == (what == "own_address_too")
    assert rig.status(AAS | SDIR) == (AAS | SDIR if what == "own_address_too" else 0)
    if what == "own_address_too":
        assert rig.write_and_read_byte(0x5A, ack=False) == 0x5A
    rig.stop()
    assert rig.address(0)


@pytest.mark.rule("I2C-218")
@pytest.mark.parametrize("point", ["end_of_byte", "ack"])
def test_open_aas_fdf_point(point):
    rig = idle(FDF, aas_fdf_point=point)
    rig.start()
    rig.send_bits(0x33)
    assert rig.flag("AAS") == (point == "end_of_byte")
    rig.acked()
    assert rig.flag("AAS")


@pytest.mark.rule("I2C-174")
@pytest.mark.parametrize("clocks", [1, 0, 4])
def test_open_noise_filter_cycles(clocks):
    """With 15 cycles per module clock, a shorter pulse has no effect, and an edge is delayed by the width."""
    width = clocks * 15
    rig = idle(noise_filter_cycles=clocks)
    rig.wait(BIT)
    if width:
        rig.put(sda=0)
        rig.wait(width - 1)
        rig.put(sda=1)
        rig.wait(BIT)
        assert rig.status(BB | SCD) == 0
    rig.put(sda=0)
    assert rig.wait_for(lambda: rig.flag("BB")) == width
    rig.fall()
    assert rig.send(OWN << 1)


# Interrupts


@pytest.mark.rule("I2C-285")
@pytest.mark.parametrize("clears", [False, True])
def test_open_isrc_read_clears_aas(clears):
    rig = idle(isrc_read_clears_aas=clears)
    rig.write("I2CIER", IE_AAS)
    rig.address()
    assert rig.read("I2CISRC", wait=SOON) == 7
    assert rig.flag("AAS") != clears
    assert rig.send(0x11), "the transfer must continue"


@pytest.mark.rule("I2C-285")
def test_open_isrc_read_clears_aas_in_the_free_data_format():
    """Only the first byte sets AAS, so the second byte does not set it again."""
    rig = idle(FDF, isrc_read_clears_aas=True)
    rig.write("I2CIER", IE_AAS)
    rig.start()
    rig.send(0x33)
    assert rig.read("I2CISRC", wait=SOON) == 7
    assert rig.read("I2CDRR") == 0x33
    rig.send(0x44)
    assert (rig.flag("RRDY"), rig.flag("AAS")) == (1, 0)


@pytest.mark.rule("I2C-238")
@pytest.mark.parametrize("value", ["no", "yes"])
def test_open_xrdy_w1c(value):
    rig = idle(xrdy_w1c=value)
    rig.write("I2CSTR", 0)
    assert rig.flag("XRDY")
    rig.write("I2CSTR", XRDY)
    assert rig.flag("XRDY") == (value == "no")


@pytest.mark.rule("I2C-281", "I2C-127")
@pytest.mark.parametrize("line", ["pulse", "level"])
def test_open_int_line(line):
    rig = addressed(int_line=line, ier=IE_SCD)
    assert rig.chip.held == 0
    rig.stop()
    rig.wait(SOON)
    assert rig.chip.held == (INT1 if line == "level" else 0)
    assert rig.requested() == INT1
    assert "int_line" in rig.chip.touched, "the option matters before the code is read"
    rig.read("I2CISRC")
    rig.wait(SOON)
    assert rig.chip.held == 0


@pytest.mark.rule("I2C-270")
@pytest.mark.parametrize("delay", [2, 0, 9])
def test_open_event_to_isrc_delay(delay):
    rig = addressed(event_to_isrc_delay=delay, ier=IE_SCD)
    rig.stop()
    assert rig.flag("SCD"), "the flag itself is not delayed"
    assert rig.wait_for(lambda: rig.peek("I2CISRC")) == delay
    assert rig.interrupts == [(rig.now, INT1)]


@pytest.mark.rule("I2C-280")
@pytest.mark.parametrize("order, codes", [("ascending", [4, 6]), ("descending", [6, 4])])
def test_open_int_priority(order, codes):
    rig = addressed(int_priority=order, sent=[0x11])
    rig.stop()
    rig.write("I2CIER", IE_RRDY | IE_SCD)
    rig.wait(SOON)
    first = rig.read("I2CISRC")
    if first == 4:
        rig.read("I2CDRR")
    rig.wait(SOON)
    assert [first, rig.peek("I2CISRC")] == codes


@pytest.mark.rule("I2C-280", "I2C-281")
@pytest.mark.parametrize("rule, shown", [("highest", 2), ("first_come", 4)])
def test_open_isrc_preempt(rule, shown):
    """Code 4 has not been read when a NACK, code 2, occurs."""
    rig = addressed(isrc_preempt=rule, ier=IE_RRDY | IE_NACK)
    rig.send(0x11)
    assert rig.peek("I2CISRC", wait=SOON) == 4
    rig.restart(OWN << 1 | 1)
    rig.write_and_read_byte(0x22, ack=False)
    assert rig.read("I2CISRC", wait=SOON) == shown
    assert rig.peek("I2CISRC", wait=SOON) == 6 - shown


@pytest.mark.rule("I2C-279")
@pytest.mark.parametrize("rule", ["stays", "vanishes"])
def test_open_isrc_follows_flag(rule):
    rig = addressed(isrc_follows_flag=rule, ier=IE_RRDY)
    rig.send(0x11)
    assert rig.peek("I2CISRC", wait=SOON) == 4
    rig.read("I2CDRR")
    assert rig.read("I2CISRC", wait=SOON) == (4 if rule == "stays" else 0)


@pytest.mark.rule("I2C-333")
@pytest.mark.parametrize("clears", [True, False])
def test_open_irs_clears_isrc(clears):
    rig = addressed(irs_clears_isrc=clears, ier=IE_SCD)
    rig.stop()
    rig.wait(SOON)
    rig.write("I2CMDR", 0)
    assert rig.read("I2CISRC", wait=SOON) == (0 if clears else 6)


# Clock, debugger, FIFO


@pytest.mark.rule("I2C-157", "I2C-158")
@pytest.mark.parametrize("what", ["stored", "dropped"])
def test_open_psc_write_irs1(what):
    """The noise filter, one module clock wide, shows the module clock: 15 cycles with IPSC = 14, 5 with IPSC = 4."""

    def filter_width() -> int:
        rig.wait(BIT)
        rig.put(sda=0)
        width = rig.wait_for(lambda: rig.flag("BB"))
        rig.wait(BIT)
        rig.put(sda=1)
        rig.wait(BIT)
        return width

    rig = idle(psc_write_irs1=what, noise_filter_cycles=1)
    assert filter_width() == 15
    rig.write("I2CPSC", 4)
    assert rig.read("I2CPSC") == (4 if what == "stored" else 14)
    assert filter_width() == 15
    rig.begin_again()
    assert filter_width() == (5 if what == "stored" else 15)


@pytest.mark.rule("I2C-145")
@pytest.mark.parametrize(("answer", "start"), [("in_order", 1), ("one_sample", 0)])
def test_open_unequal_arrival(answer, start):
    """SDA falls 7 cycles before SCL, less than a module clock of 15: this is a START, or a simultaneous fall."""
    rig = idle(unequal_arrival=answer, noise_filter_cycles=1)
    rig.wait(BIT)
    rig.put(sda=0)
    rig.wait(7)
    rig.put(scl=0)
    rig.wait(SOON)
    assert rig.flag("BB") == start


@pytest.mark.rule("I2C-008")
@pytest.mark.parametrize("what", ["reads_0", "accessible"])
def test_open_clock_gate_access(what):
    rig = Rig(clock_gate_access=what)
    rig.write("I2COAR", OWN)
    rig.chip.gate(rig.now, False)
    assert rig.read("I2COAR") == (OWN if what == "accessible" else 0)
    rig.write("I2COAR", OTHER)
    rig.chip.gate(rig.now, True)
    assert rig.read("I2COAR") == (OTHER if what == "accessible" else OWN)


@pytest.mark.rule("I2C-324")
@pytest.mark.parametrize("unit", ["byte", "whole_transfer"])
def test_open_free_slave_unit(unit):
    """A breakpoint is hit in the first of two data bytes before a STOP. The halted slave holds SCL, then continues."""
    rig = addressed(free_slave_unit=unit, rx_overrun_policy="overwrite")
    rig.send_bits(0x1, 4)
    rig.chip.suspend(rig.now, True)
    rig.send_bits(0x1, 4)
    assert rig.acked()
    assert rig.peek("I2CDRR") == 0x11
    rig.wait(BIT)
    assert rig.stretching == (unit == "byte")
    if unit == "byte":
        rig.chip.suspend(rig.now, False)
    assert rig.send(0x22)
    rig.stop()
    assert rig.flag("BB") == 0
    rig.start()
    assert rig.stretching == (unit == "whole_transfer")
    rig.chip.suspend(rig.now, False)
    assert rig.send(OWN << 1)


@pytest.mark.rule("I2C-293", "I2C-295", "I2C-300", "I2C-303")
@pytest.mark.parametrize("mode", ["level", "edge"])
def test_open_fifo_int_mode(mode):
    """Both flags are cleared while TXFFST = 0 and RXFFST = 1 are still at their levels; then the module is reset."""
    rig = Rig(fifo_int_mode=mode).begin(fifos=(FFEN | FFRST, FFRST | 1))
    rig.receive(0x11)

    def flags() -> list[int]:
        rig.wait(SOON)
        return [rig.peek(name) >> 7 & 1 for name in ("I2CFFTX", "I2CFFRX")]

    def clear() -> None:
        rig.set_fifos(FFEN | FFRST | FFINTCLR, FFRST | FFINTCLR | 1)

    assert flags() == [1, 1]
    clear()
    assert flags() == ([1, 1] if mode == "level" else [0, 0])
    rig.send(0x22)
    assert flags() == ([1, 1] if mode == "level" else [0, 0])
    rig.write("I2CMDR", 0)
    clear()
    assert flags() == [0, 0]
    rig.write("I2CMDR", IRS)
    assert flags() == [1, 1]


@pytest.mark.rule("I2C-287")
@pytest.mark.parametrize("policy", ["stretch", "nack", "overwrite"])
def test_open_fifo_17th_byte(policy):
    rig = Rig(fifo_17th_byte=policy).begin(fifos=(FFEN, FFRST | 16))
    rig.address()
    for n in range(16):
        assert rig.send(n)
    assert rig.send(16) == (policy != "nack")
    assert rig.stretching == (policy == "stretch")
    assert rig.flag("RSFULL")
    assert rig.peek("I2CFFRX") >> 8 & 31 == 16
    if policy == "overwrite":
        rig.send(17)
    assert [rig.read("I2CDRR") for _ in range(16)] == list(range(16))
    assert rig.read("I2CDRR") == (17 if policy == "overwrite" else 16)


@pytest.mark.rule("I2C-290")
@pytest.mark.parametrize("flushes", [False, True])
def test_open_txfifo_reset_flushes_xsr(flushes):
    """The ACK of the pointer byte copies 0x11 to I2CXSR; then the FIFO is reset, and the master reads."""
    rig = Rig(txfifo_reset_flushes_xsr=flushes).begin(fifos=(FFEN | FFRST, FFRST))
    rig.address()
    rig.write("I2CDXR", 0x11)
    rig.send(0x00)
    assert rig.peek("I2CFFTX") >> 8 & 31 == 0
    rig.write("I2CFFTX", FFEN)
    rig.write("I2CFFTX", FFEN | FFRST)
    rig.restart(OWN << 1 | 1)
    rig.wait(BIT)
    assert rig.stretching == flushes
    if flushes:
        rig.write("I2CDXR", 0x22)
    assert rig.read_byte(ack=False) == (0x22 if flushes else 0x11)


@pytest.mark.rule("I2C-287", "I2C-292", "I2C-299")
@pytest.mark.parametrize("stage", ["no", "dxr_drr_behind"])
def test_open_fifo_extra_stage(stage):
    """The stage adds one byte to the capacity in each direction."""
    extra = int(stage == "dxr_drr_behind")
    rig = Rig(fifo_extra_stage=stage).begin(fifos=(FFEN | FFRST, FFRST))
    for n in range(16 + extra):
        rig.write("I2CDXR", n)
        assert rig.peek("I2CFFTX") >> 8 & 31 == n + 1 - extra
    rig.address()
    for n in range(16 + extra):
        assert rig.send(n)
        assert not rig.stretching
    rig.send(0xEE)
    assert rig.stretching
    assert [rig.read("I2CDRR") for _ in range(16 + extra)] == list(range(16 + extra))


@pytest.mark.rule("I2C-292")
@pytest.mark.parametrize("stage", ["no", "dxr_drr_behind"])
def test_open_fifo_extra_stage_keeps_the_order(stage):
    extra = int(stage == "dxr_drr_behind")
    rig = Rig(fifo_extra_stage=stage)
    rig.write("I2CFFTX", FFEN | FFRST)
    rig.begin()
    rig.write("I2CDXR", *(0x20 + n for n in range(16 + extra)))
    rig.address(OWN, 1)
    assert [rig.read_byte(ack=n < 15 + extra) for n in range(16 + extra)] == [0x20 + n for n in range(16 + extra)]


@pytest.mark.rule("I2C-333", "I2C-329")
@pytest.mark.parametrize("clears", [False, True])
def test_open_irs_clears_fifo(clears):
    rig = Rig(irs_clears_fifo=clears).begin(fifos=(FFEN | FFRST, FFRST))
    rig.write("I2CDXR", 0x11, 0x12, 0x13)
    rig.receive(0x22)
    rig.write("I2CMDR", 0)
    left = [rig.peek(name) >> 8 & 31 for name in ("I2CFFTX", "I2CFFRX")]
    assert left == ([0, 0] if clears else [1, 1])


@pytest.mark.rule("I2C-101", "I2C-210", "I2C-241")
@pytest.mark.parametrize("read", [True, False])
def test_open_rrdy_clear_reads_drr(read):
    """RRDY is cleared by writing 1 without reading I2CDRR, which is then free or still full for the next byte."""
    rig = addressed(rrdy_clear_reads_drr=read)
    rig.send(0x11)
    rig.write("I2CSTR", RRDY)
    assert rig.flag("RRDY") == 0
    rig.send_bits(0x22)
    assert (rig.flag("RSFULL"), rig.flag("RRDY")) == ((0, 1) if read else (1, 0))
    assert rig.peek("I2CDRR") == (0x22 if read else 0x11)


@pytest.mark.rule("I2C-033", "I2C-034")
@pytest.mark.parametrize("cleared", [True, False])
def test_open_irs_clears_commands(cleared):
    rig = addressed(irs_clears_commands=cleared)
    rig.write("I2CMDR", IRS | NACKMOD | STP)
    rig.write("I2CMDR", NACKMOD | STP)  # IRS = 0
    assert rig.peek("I2CMDR") & (NACKMOD | STP) == (0 if cleared else NACKMOD | STP)


@pytest.mark.parametrize("point", ["eager", "eager_reloaded_at_address", "eager_if_trx"])
def test_after_irs_0_within_a_byte_an_eager_module_copies_at_once_again(point):
    """IRS = 0 discards the byte being sent, so I2CXSR is free: the next write is copied at once, and XRDY stays 1."""
    rig = addressed(read=1, first=0x11, dxr_to_xsr_copy_point=point, mode=TRX)
    for _ in range(3):
        rig.clock()
    rig.write("I2CMDR", 0)
    assert rig.chip.out == 0b11
    rig.write("I2CMDR", IRS | TRX)
    rig.write("I2CDXR", 0x22)
    assert rig.flag("XRDY"), "0x22 must have been copied to I2CXSR"
    rig.write("I2CDXR", 0x33)
    assert not rig.flag("XRDY"), "I2CXSR must be full"
    rig.stop()
    rig.start()
    assert rig.send(OWN << 1 | 1)
    assert rig.read_byte(ack=False) == {"eager_reloaded_at_address": 0x33}.get(point, 0x22)


@pytest.mark.rule("I2C-290")
@pytest.mark.parametrize("held", [True, False])
def test_a_byte_written_to_a_transmit_fifo_in_reset_is_lost_and_noted_each_time(held):
    rig = idle()
    rig.write("I2CFFTX", FFEN | (0 if held else FFRST))
    rig.write("I2CDXR", 0x55, 0x66)
    text = "a byte was written to I2CDXR while TXFFRST = 0 holds the TX FIFO empty"
    assert [(note.code, note.text) for note in rig.chip.notes] == [("lost", text)] * (2 if held else 0)
    assert rig.peek("I2CFFTX") >> 8 & 31 == (0 if held else 2)
