"""Open questions about the I2C module as master, its clock, loopback and debugger, with every value of the options."""

from __future__ import annotations

import dataclasses
import itertools

import pytest

from periph_sim.f28335.i2c.options import I2cOptions

from ..i2c_bus import HIGH, LOW, SCL, SDA, SLOT, Bench, Foreign, Target, decode, mdr, with_

rule = pytest.mark.rule

TMOD = 15
FILTER = TMOD + 1  # delay of the filter in cycles, plus one


def test_the_tested_values_are_all_values_of_these_options():
    """If one of these options gets another value, this test fails until the table and the tests are extended."""
    tested = {
        "hold_scl_after_nack": 2,
        "ardy_on_nack": 2,
        "cnt_copy_point": 2,
        "stt_with_irs_write": 2,
        "stt_while_busy": 3,
        "foreign_start_stop": 2,
        "al_clears_stt": 2,
        "mr_nack_at_count0": 2,
        "rrdy_point": 3,
        "rm_receiver": 2,
        "stop_without_data": 2,
        "ten_bit_read": 2,
        "own_general_call": 2,
        "dlb_delay": 2,
        "free_slave_unit": 2,
        "psc_write_irs1": 2,
        "bc_less_than_8_upper_bits": 2,
        "start_byte_ad0": 2,
    }
    known = {f.name: len(f.metadata["values"]) for f in dataclasses.fields(I2cOptions) if f.name in tested}
    assert known == tested


# ---- NACK ------------------------------------------------------------------------------------------


@rule("I2C-250")
@pytest.mark.parametrize("hold", [True, False])
def test_open_hold_scl_after_nack(hold: bool):
    b = Bench(options=with_(hold_scl_after_nack=hold))
    b.send([], extra="", count=1)
    b.after("NACK", 2)
    assert b.level == [int(not hold), 1]
    assert b.quiet(50 * SLOT)
    b.set("STP")
    assert b.decoded_after(4 * SLOT) == "S 50W N P"
    assert b.flags("BB MST STP") == ""


@rule("I2C-246")
@pytest.mark.parametrize("ardy", [True, False])
def test_open_ardy_on_nack(ardy: bool):
    b = Bench(options=with_(ardy_on_nack=ardy))
    b.send([], extra="", count=1)
    b.after("NACK", 2)
    assert b.flag("ARDY") == ardy


@rule("I2C-041")
@pytest.mark.parametrize("how, said", [("address_counts", "S 50W N P"), ("waits_for_data", "S 50W N")])
def test_open_stop_without_data(how: str, said: str):
    b = Bench(options=with_(stop_without_data=how))
    b.send([], extra="", count=1)
    b.after("NACK")
    b.set("STP")
    assert b.decoded_after(20 * SLOT) == said
    assert b.flag("STP") == (how == "waits_for_data")


@rule("I2C-041")
@pytest.mark.parametrize("how, said", [("address_counts", "S 33W N P"), ("waits_for_data", "S 33W N")])
def test_open_stop_without_data_counts_the_bytes_since_the_last_start(how: str, said: str):
    b = Bench(Target(), options=with_(stop_without_data=how))
    b.send([1], extra="", until="ARDY")
    b.w("I2CSAR", 0x33)
    b.send([], extra="", count=1)
    b.after("NACK")
    b.set("STP")
    assert b.decoded_after(20 * SLOT) == "S 50W A 01 A " + said


# ---- count, receiver ----------------------------------------------------------------------------------


@rule("I2C-132", "I2C-133")
@pytest.mark.parametrize("point, sent", [("start", 2), ("write", 4)])
def test_open_cnt_copy_point(point: str, sent: int):
    """I2CCNT is 2, and 3 is written to it while the second byte is sent."""
    b = Bench(Target(), options=with_(cnt_copy_point=point))
    b.mode("MST TRX STT", count=2)
    b.feed([1, 2])
    b.until(lambda: len(b.target.got) == 1)
    b.edge(SCL, 0, 3)
    b.w("I2CCNT", 3)
    b.feed(range(3, sent + 1))
    b.until(lambda: b.flag("ARDY"))
    assert len(b.target.got) == sent


@rule("I2C-143")
@pytest.mark.parametrize("how, answers", [("always", [0, 1]), ("only_with_stp", [0, 0])])
def test_open_mr_nack_at_count0(how: str, answers: list[int]):
    b = Bench(Target(gives=[1, 2, 3]), options=with_(mr_nack_at_count0=how))
    b.mode("MST STT", count=2)
    assert b.drain(2) == [1, 2]
    b.after("ARDY")
    assert b.target.answers == answers
    assert b.held()


@rule("I2C-143", "I2C-191")
@pytest.mark.parametrize("how", ["always", "only_with_stp"])
def test_open_mr_nack_at_count0_with_stp_the_last_byte_is_refused(how: str):
    b = Bench(Target(gives=[1, 2, 3]), options=with_(mr_nack_at_count0=how))
    assert b.read_all(2) == [1, 2]
    assert b.target.answers == [0, 1]


@rule("I2C-062", "I2C-144", "I2C-190", "I2C-051", "I2C-058")
@pytest.mark.parametrize("how", ["allowed", "ignored"])
def test_open_rm_receiver(how: str):
    """With I2CCNT = 2, a receiver in repeat mode reads until STP is set; if RM is ignored, it reads two bytes."""
    b = Bench(Target(gives=range(1, 9)), options=with_(rm_receiver=how))
    b.mode("MST STT RM", count=2)
    assert b.drain(2) == [1, 2]
    if how == "allowed":
        assert b.drain(2) == [3, 4]
        b.edge(SCL, 0, 3)
        b.set("STP")
        assert b.drain(1) == [5]
        assert b.decoded_at_stop() == "S 50R A 01 A 02 A 03 A 04 A 05 N P"
    else:
        b.after("ARDY")
        assert b.held(30 * SLOT)
        assert not b.flag("RRDY")


@rule("I2C-061", "I2C-144")
def test_open_rm_receiver_allowed_ends_with_a_repeated_start():
    b = Bench(Target(gives=range(1, 9)))
    b.mode("MST STT RM")
    assert b.drain(2) == [1, 2]
    b.mode("MST STT STP", count=1)
    while not b.flag("SCD"):
        b.run(25)
        if b.flag("RRDY"):
            b.r("I2CDRR")
    words = b.decoded().split()
    assert words[:3] == ["S", "50R", "A"] and words.count("S") == 2 and words[-1] == "P"


@rule("I2C-070")
@pytest.mark.parametrize("how, got", [("last_bits", [0x15, 0x5C]), ("zeros", [0x05, 0x0C])])
def test_open_bc_less_than_8_upper_bits(how: str, got: list[int]):
    """The address byte 0xA1 is followed by the four bits 5 and the four bits C."""
    b = Bench(Target(gives=[0x5, 0xC], bits=4), options=with_(bc_less_than_8_upper_bits=how))
    assert b.read_all(2, bc=4) == got


# ---- START ----------------------------------------------------------------------------------------------


@rule("I2C-033", "I2C-034")
@pytest.mark.parametrize("how", ["accepted", "dropped"])
def test_open_stt_with_irs_write(how: str):
    b = Bench(Target(), options=with_(stt_with_irs_write=how), enable=False)
    b.w("I2CCNT", 1)
    b.w("I2CDXR", 0x12)
    b.w("I2CMDR", 0x2E20)  # STT, STP, MST, TRX and IRS at once
    assert b.flags("STT STP MST") == ("STT STP MST" if how == "accepted" else "MST")
    assert b.decoded_after(40 * SLOT) == ("S 50W A 12 A P" if how == "accepted" else "")


@rule("I2C-150", "I2C-258")
@pytest.mark.parametrize("how", ["foreign_al", "foreign_waits", "always_repeated_start"])
def test_open_stt_while_busy(how: str):
    """STT is set in the second byte of a foreign transfer."""
    b = Bench(Target(0x48), Target(0x50), Foreign("S 48W 77 P"), options=with_(stt_while_busy=how))
    b.edge(SCL, 0, 12)
    b.mode("MST TRX STT STP", count=1, data=0x12)
    b.run(60 * SLOT)
    if how == "foreign_al":
        assert b.decoded() == "S 48W A 77 A P"
        assert b.flags("AL MST STP") == "AL"
    elif how == "foreign_waits":
        assert b.decoded() == "S 48W A 77 A P S 50W A 12 A P"
        assert b.flags("AL MST STP") == ""
        _, stop, start, _ = (said.start for said in decode(b.edges) if said.text in "SP")
        assert start - stop == TMOD + LOW  # the filter delays the STOP by TMOD
    else:
        assert b.decoded() == "S 48W A ~01110 S 50W A 12 A P"


FOREIGN = ["unnoticed", "loses_arbitration"]


@rule("I2C-181")
@pytest.mark.parametrize("how", FOREIGN)
def test_open_foreign_start_stop_a_start_against_a_one(how: str):
    """SDA falls in the high phase of the third data bit, after it was sampled 1."""
    b = Bench(Target(), options=with_(foreign_start_stop=how))
    b.mode("MST TRX STT STP", count=2, data=0xFF)
    b.edge(SCL, 1, 9 + 3)
    b.run(HIGH // 2)
    b.pull(SDA)
    b.run(FILTER)
    assert b.flags("AL MST BB") == ("MST BB" if how == "unnoticed" else "AL BB")
    clocked = len(b.times(SCL, 0))
    b.edge(SCL, 0) if how == "unnoticed" else b.run(HIGH)
    b.release(SDA)
    b.run(4 * SLOT)
    assert len(b.times(SCL, 0)) - clocked == (5 if how == "unnoticed" else 0)


@rule("I2C-181")
@pytest.mark.parametrize("how", FOREIGN)
def test_open_foreign_start_stop_a_stop_against_a_zero(how: str):
    """The target releases SDA in the high phase of the third bit that it sends."""
    b = Bench(Target(gives=[0x00, 0x12]), options=with_(foreign_start_stop=how))
    b.mode("MST STT STP", count=2)
    b.edge(SCL, 1, 10 + 3)
    b.run(HIGH // 2)
    b.target.out |= 1 << SDA
    b.settle()
    b.run(FILTER)
    assert b.flags("AL MST BB SCD") == ("MST SCD" if how == "unnoticed" else "AL SCD")
    clocked = len(b.times(SCL, 0))
    b.run(4 * SLOT)
    assert len(b.times(SCL, 0)) - clocked == (4 if how == "unnoticed" else 0)
    assert b.m.out == 0b11 or how == "unnoticed"


@rule("I2C-181")
@pytest.mark.parametrize("how", FOREIGN)
def test_open_foreign_start_stop_has_no_effect_on_own_conditions(how: str):
    b = Bench(Target(gives=[0x77]), options=with_(foreign_start_stop=how))
    b.send([0x00], extra="", until="ARDY")
    assert b.read_all(1) == [0x77]
    b.send([0xFF])
    assert b.decoded_at_stop() == "S 50W A 00 A S 50R A 77 N P S 50W A ff A P"
    assert b.flags("AL") == "" and "foreign_start_stop" not in b.m.touched


def test_a_foreign_stop_after_the_own_one_clears_no_command():
    b = Bench(Target(), Target(0x48))
    b.write_all([0x12])
    b.join(Foreign("S 48W 77 P", at=b.now + SLOT))
    b.mode("MST TRX STP")
    b.run(40 * SLOT)
    assert b.decoded().endswith("S 48W A 77 A P") and b.flags("MST STP AL") == "MST STP"


@rule("I2C-037", "I2C-150")
def test_a_start_waits_until_scl_is_released():
    """SCL is low without a START: BB is 0, so the bus is free according to the manual."""
    b = Bench(Target())
    b.pull(SCL)
    b.run(2 * SLOT)
    b.send([0x12])
    assert b.decoded_after(20 * SLOT) == "" and b.flags("BB STT MST AL") == "STT MST"
    b.release(SCL)
    released = b.now
    assert b.decoded_at_stop() == "S 50W A 12 A P"
    assert min(b.times(SDA, 0)) - released < LOW + HIGH
    assert not b.duties()


@rule("I2C-150")
@pytest.mark.parametrize("how", ["foreign_al", "foreign_waits", "always_repeated_start"])
def test_open_stt_while_busy_has_no_effect_on_the_own_bus(how: str):
    b = Bench(Target(), options=with_(stt_while_busy=how))
    b.send([1], extra="", until="ARDY")
    b.send([2])
    assert b.decoded_at_stop() == "S 50W A 01 A S 50W A 02 A P"
    assert not b.flag("AL")


@rule("I2C-260")
@pytest.mark.parametrize("clears", [True, False])
def test_open_al_clears_stt(clears: bool):
    b = Bench(Target(0x48), Foreign("S 48W 77 P"), options=with_(al_clears_stt=clears))
    b.edge(SCL, 0, 4)
    b.mode("MST TRX STT STP")
    b.until(lambda: b.flag("AL"))
    assert b.flags("STT STP MST") == ("" if clears else "STT")
    assert b.decoded_after(60 * SLOT) == "S 48W A 77 A P"


@rule("I2C-083", "I2C-086")
@pytest.mark.parametrize(
    "how, said", [("header_r_only", "S 7aR N"), ("full_address_first", "S 7aW A 34 A S 7aR A 99 N P")]
)
def test_open_ten_bit_read_from_idle(how: str, said: str):
    """A device acknowledges the first byte with R only after the complete address."""
    b = Bench(Target(0x234, [0x99]), options=with_(ten_bit_read=how))
    b.w("I2CSAR", 0x234)
    b.mode("MST STT STP XA", count=1)
    b.run(50 * SLOT)
    assert b.decoded().removesuffix(" P") == said.removesuffix(" P")
    assert b.flag("RRDY") == (how == "full_address_first")


@rule("I2C-089", "I2C-090", "I2C-252")
@pytest.mark.parametrize("how, said", [("not_answered", "S 00W N"), ("answered", "S 00W A")])
def test_open_own_general_call(how: str, said: str):
    b = Bench(options=with_(own_general_call=how))
    b.w("I2CSAR", 0)
    b.send([], extra="", count=1)
    assert b.decoded_after(15 * SLOT) == said
    assert b.flags("AAS AD0") == ("AAS AD0" if how == "answered" else "")
    assert b.flag("NACK")  # in both cases, as in Table 10


@rule("I2C-063", "I2C-091")
@pytest.mark.parametrize("how", ["stays_0", "set"])
def test_open_start_byte_ad0(how: str):
    b = Bench(Target(), second=with_(start_byte_ad0=how))
    b.w("I2COAR", 0x21, b.s)
    b.send([0x12], extra="STP STB")
    seen = 0
    while not b.flag("SCD"):
        seen |= b.flag("AD0", b.s)
        assert not b.flag("AAS", b.s)
        b.run(25)
    assert b.decoded() == "S 00R N S 50W A 12 A P"
    assert seen == (how == "set")


# ---- clock and filter -------------------------------------------------------------------------------------


@rule("I2C-165", "I2C-171")
@pytest.mark.parametrize("extra", [0, 2, 3, 16])
def test_open_scl_sync_cycles(extra: int):
    held = 900
    b = Bench(Target(stretch={(0, 4): held}), options=with_(scl_sync_cycles=extra))
    b.write_all([0x12])
    highs = [y.time - x.time for x, y in _scl_pairs(b) if x.level]
    assert highs[4] == HIGH + extra * TMOD
    assert {h for n, h in enumerate(highs) if n != 4} == {HIGH}


def _scl_pairs(b: Bench) -> list[tuple]:
    edges = [e for e in b.edges if e.line == SCL][1:]
    return list(itertools.pairwise(edges))


@rule("I2C-159", "I2C-160", "I2C-174")
@pytest.mark.parametrize("width", [0, 1, 3])
def test_open_noise_filter_cycles_is_in_the_programmed_times(width: int):
    """The low and high times depend on the divisors but not on the filter."""
    b = Bench(Target(), options=with_(noise_filter_cycles=width))
    b.write_all([0x12])
    assert {y.time - x.time for x, y in _scl_pairs(b)} == {LOW, HIGH}


@rule("I2C-157", "I2C-158")
@pytest.mark.parametrize("how, tmod", [("stored", 13), ("dropped", 15)])
def test_open_psc_write_irs1(how: str, tmod: int):
    b = Bench(Target(), options=with_(psc_write_irs1=how))
    b.w("I2CPSC", 12)
    assert b.r("I2CPSC") == tmod - 1
    b.write_all([0x12])
    assert {y.time - x.time for x, y in _scl_pairs(b)} == {LOW, HIGH}
    b.w("I2CMDR", 0)
    b.w("I2CMDR", mdr(""))
    b.edges.clear()
    b.write_all([0x12])
    assert {y.time - x.time for x, y in _scl_pairs(b)} == {15 * tmod, 10 * tmod}


@pytest.mark.parametrize("setup", [0, 1, 2, 8])
@pytest.mark.parametrize("role", ["master", "slave"])
def test_open_sda_setup_before_scl_release(role: str, setup: int):
    """A transmitter that has held SCL outputs its bit before it releases SCL."""
    partner = Target() if role == "master" else Foreign("S 50R ?N P")
    b = Bench(partner, options=with_(sda_setup_before_scl_release=setup), own=0x50)
    if role == "master":
        b.send([], count=1)
    b.until(lambda: not b.flag("XSMT"))
    b.run(5 * SLOT)
    assert b.held()
    write = b.now
    b.w("I2CDXR", 0x12)
    b.run((setup + 1) * TMOD)
    assert b.times(SCL, 1, write)[0] - write == max(1, setup * TMOD)  # never in the same cycle, which could be a START
    assert b.level[SDA] == 0
    assert b.times(SDA, 0)[-1] <= write + 1


def test_open_sda_setup_before_scl_release_leaves_bits_that_were_not_held():
    b = Bench(Target(), options=with_(sda_setup_before_scl_release=255))
    b.mode("MST TRX STT STP", count=1, data=0x12)
    b.stopped()
    assert {y.time - x.time for x, y in _scl_pairs(b)} == {LOW, HIGH}


# ---- loopback ------------------------------------------------------------------------------------------------


@rule("I2C-308")
@pytest.mark.parametrize("psc", [14, 12])
@pytest.mark.parametrize("how", ["after_last_bit", "after_dxr_write"])
def test_open_dlb_delay(how: str, psc: int):
    """n = 8 (IPSC + 1) cycles from the rise of the last data bit, or from the write that ended an underflow."""
    b = Bench(options=with_(dlb_delay=how), psc=psc, own=0x2A)
    b.mode("FREE MST TRX STT STP DLB", count=1)
    b.until(lambda: not b.flag("XSMT"))
    b.run(3 * SLOT)
    write = b.now
    b.w("I2CDXR", 0x5C)
    came = b.until(lambda: b.flag("RRDY"))
    assert b.r("I2CDRR") == 0x5C
    n = 8 * (psc + 1)
    if how == "after_dxr_write":
        assert came - write == n
    else:
        last = b.times(SCL, 1, write)[7]
        assert came - last in range(n, n + SLOT)


# ---- debugger ---------------------------------------------------------------------------------------------------


@rule("I2C-324")
@pytest.mark.parametrize("how", ["byte", "whole_transfer"])
def test_open_free_slave_unit(how: str):
    """A breakpoint is hit in the first of two data bytes, with FREE = 0."""
    b = Bench(Foreign("S 50W 12 34 P"), options=with_(free_slave_unit=how), own=0x50)
    b.edge(SCL, 0, 10 + 4)
    b.suspend(True)
    b.until(lambda: b.flag("RRDY"))
    assert b.r("I2CDRR") == 0x12
    b.run(30 * SLOT)
    assert b.flag("RRDY") == (how == "whole_transfer")
    assert (b.foreign.acknowledges, b.foreign.done) == (("AA", False) if how == "byte" else ("AAA", True))
    b.suspend(False)
    assert b.drain(1) == [0x34]
    b.run(10 * SLOT)
    assert (b.decoded(), b.foreign.acknowledges) == ("S 50W A 12 A 34 A P", "AAA")


# ---- interrupt --------------------------------------------------------------------------------------------------


@rule("I2C-269")
@pytest.mark.parametrize("how", ["level", "only_addressed"])
def test_open_xrdyint_when_idle_as_master(how: str):
    """XRDY = 1 requests at once, or only from the START to the end of the transfer."""
    b = Bench(Target(), options=with_(xrdyint_when_idle=how))
    b.w("I2CIER", 1 << 4)
    b.run(100)
    assert b.peek("I2CISRC") == (5 if how == "level" else 0)
    b.r("I2CISRC")
    b.mode("MST TRX STT STP", count=1)
    b.until(lambda: not b.flag("XSMT"))
    b.run(100)
    assert b.peek("I2CISRC") == (0 if how == "level" else 5)  # one request for each rise of the condition
    b.r("I2CISRC")
    b.w("I2CDXR", 1)
    b.stopped()
    b.run(100)
    assert b.peek("I2CISRC") == 5  # because the byte was copied from I2CDXR during the transfer


def test_open_xrdyint_when_idle_as_master_receiver():
    b = Bench(Target(gives=[0x77]), options=with_(xrdyint_when_idle="only_addressed"))
    b.w("I2CIER", 1 << 4)
    b.mode("MST STT STP", count=1)
    b.until(lambda: b.flag("RRDY"))
    assert (b.flag("XRDY"), b.peek("I2CISRC")) == (1, 0)


def test_open_xrdyint_when_idle_after_lost_arbitration():
    """After the loss of arbitration, no transfer needs data."""
    b = Bench(Target(0x48), Foreign("S 48W 77 P", at=None), options=with_(xrdyint_when_idle="only_addressed"))
    b.mode("MST TRX STT STP")
    b.until(lambda: b.flag("AL"))
    b.w("I2CIER", 1 << 4)
    b.run(100)
    assert (b.flags("XRDY BB"), b.peek("I2CISRC")) == ("XRDY BB", 0)


# ---- receiving ----------------------------------------------------------------------------------------------------


@rule("I2C-096", "I2C-239")
@pytest.mark.parametrize("point, level, edge, seen", [("fall8", 0, 18, 0), ("rise9", 1, 18, TMOD), ("fall9", 0, 19, 0)])
def test_open_rrdy_point_as_master(point: str, level: int, edge: int, seen: int):
    """edge: number of the SCL edge since the START; seen: cycles after it, because the filter delays a rise."""
    b = Bench(Target(gives=[0x77]), options=with_(rrdy_point=point))
    b.mode("MST STT STP", count=1)
    came = b.until(lambda: b.flag("RRDY"))
    assert came == b.times(SCL, level)[edge - 1] + seen
    assert b.drain(1) == [0x77]
