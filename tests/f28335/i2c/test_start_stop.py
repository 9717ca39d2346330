"""I2C master: START, STOP, repeated START, and the commands that make them. SPRUG03B section 2.4, Tables 5, 6."""

from __future__ import annotations

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from periph_sim.f28335.i2c.options import I2cOptions

from ..i2c_bus import HIGH, LOW, SCL, SDA, SLOT, Bench, Foreign, Target, decode, mdr, with_
from ..i2c_registers import MDR
from ..i2c_rig import Rig

rule = pytest.mark.rule


# ---- start of a transfer ---------------------------------------------------------------------------


@rule("I2C-033", "I2C-034")
@pytest.mark.parametrize("name", ["STT", "STP"])
def test_a_write_with_irs_0_cannot_set_the_bit(name: str):
    b = Bench(Target(), enable=False)
    b.w("I2CMDR", MDR[name] | MDR["MST"] | MDR["TRX"])
    assert b.flags("STT STP MST TRX") == "MST TRX"
    b.set("IRS")
    assert b.quiet()


@rule("I2C-035", "I2C-036")
@pytest.mark.parametrize("names", ["STT", "STP", "STT STP TRX"])
def test_without_mst_stt_and_stp_have_no_effect_on_the_bus(names: str):
    b = Bench(Target())
    b.mode(names, count=1, data=0x12)
    assert b.quiet()
    assert not b.flag("BB")


@rule("I2C-036")
def test_stp_of_an_addressed_slave_has_no_effect_on_the_bus():
    b = Bench(Foreign("S 50W 12 34 P"), own=0x50)
    b.until(lambda: b.flag("AAS"))
    b.set("STP")
    assert b.drain(2) == [0x12, 0x34]
    b.run(4 * SLOT)
    assert (b.foreign.acknowledges, b.decoded()) == ("AAA", "S 50W A 12 A 34 A P")


@rule("I2C-037", "I2C-038", "I2C-043", "I2C-145", "I2C-148", "I2C-206")
def test_mst_and_stt_make_a_start_and_stt_clears_itself():
    b = Bench(Target())
    b.w("I2CCNT", 1)
    assert b.level == [1, 1]
    assert b.flags("BB STT") == ""
    b.mode("MST TRX STT")
    assert b.flags("STT MST") == "STT MST"
    fall = b.edge(SDA, 0)
    assert b.level[SCL] == 1
    assert b.edge(SCL, 0) > fall
    assert b.flags("BB STT MST") == "BB MST"


@rule("I2C-038", "I2C-147", "I2C-206", "I2C-075", "I2C-133")
def test_the_waveform_of_one_byte_with_stop():
    b = Bench(Target(0x50))
    b.mode("MST TRX STT STP", count=1, data=0x3A)
    start = b.edge(SCL, 0)
    b.check(
        """
    < SCL  0..1. 0..1. 0..1. 0..1. 0..1. 0..1. 0..1. 0..1. 0..1. 0..1. 0..1. 0..1. 0..1. 0..1. 0..1. 0..1. 0..1. 0..1.
    < SDA  1.... 0.... 1.... 0.... ..... ..... ..... ..... ..... ..... ..... 1.... ..... ..... 0.... 1.... 0.... .....
    < BB   1.... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... .....
    < STT  0.... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... .....
    < STP  1.... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... .....
    < MST  1.... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... ..... .....
    """,
        SLOT // 5,
        start=start,
    )
    assert b.decoded_at_stop() == "S 50W A 3a A P"


@rule("I2C-147")
@settings(max_examples=20, deadline=None)
@given(st.lists(st.integers(0, 255), min_size=1, max_size=3))
def test_sda_changes_only_while_scl_is_low_except_for_start_and_stop(data: list[int]):
    b = Bench(Target())
    b.write_all(data)
    scl, moved = 1, 0
    for edge in b.edges:
        scl = edge.level if edge.line == SCL else scl
        moved += edge.line == SDA and scl
    assert moved == 2


# ---- end of a transfer ------------------------------------------------------------------------------


@rule("I2C-039", "I2C-040", "I2C-044", "I2C-146", "I2C-149", "I2C-208", "I2C-230", "I2C-048")
@pytest.mark.parametrize("count", [1, 2, 5])
def test_with_stp_a_stop_follows_the_last_counted_byte(count: int):
    b = Bench(Target())
    data = list(range(1, count + 1))
    b.send(data)
    b.run(SLOT)
    assert b.flags("STP MST BB SCD") == "STP MST BB"
    rise = b.stopped()
    assert b.decoded() == " ".join(["S 50W A", *(f"{d:02x} A" for d in data), "P"])
    assert b.edges[-1][1:] == (SDA, 1)
    assert rise - b.edges[-1].time < SLOT
    assert b.flags("STP MST BB SCD TRX") == "SCD TRX"
    assert b.quiet()


@rule("I2C-047", "I2C-136", "I2C-149", "I2C-243")
def test_without_stp_the_bus_is_kept_after_the_last_byte_and_ardy_is_set():
    b = Bench(Target())
    b.send([1, 2], extra="")
    assert not b.flag("ARDY")
    b.until(lambda: b.flag("ARDY"))
    assert b.held()
    assert b.decoded() == "S 50W A 01 A 02 A"
    assert b.flags("BB MST STP SCD NACK") == "BB MST"


@rule("I2C-046", "I2C-040", "I2C-044", "I2C-247")
def test_stp_alone_ends_a_kept_transfer_with_a_stop():
    b = Bench(Target())
    b.send([1], extra="")
    b.after("ARDY")
    b.mode("MST TRX STP")
    assert b.decoded_at_stop() == "S 50W A 01 A P"
    assert b.flags("STP MST BB ARDY") == ""


@rule("I2C-050")
def test_stp_alone_ends_a_kept_repeat_mode_transfer_with_a_stop():
    b = Bench(Target())
    b.send([1], extra="RM")
    b.after("ARDY")
    b.mode("MST TRX RM STP")
    assert b.decoded_at_stop() == "S 50W A 01 A P"


@rule("I2C-045", "I2C-049", "I2C-052")
@pytest.mark.parametrize("names", ["MST TRX", "MST", "MST TRX RM", "MST RM", "MST TRX RM STT STP"])
def test_combinations_without_bus_activity(names: str):
    b = Bench(Target())
    b.mode(names, count=1, data=0x12)
    assert b.quiet()
    assert not b.flag("BB")


@rule("I2C-045", "I2C-049")
@pytest.mark.parametrize("rm", ["", "RM"])
def test_a_kept_bus_stays_kept_without_a_command(rm: str):
    b = Bench(Target())
    b.send([1], extra=rm)
    b.after("ARDY")
    b.mode("MST TRX " + rm)
    assert b.held(20 * SLOT)


@rule("I2C-041")
@pytest.mark.parametrize("count", [1, 3])
def test_stp_set_during_the_address_takes_effect_after_the_bytes(count: int):
    """With RM = 0, the STOP follows the last byte of the count."""
    b = Bench(Target())
    b.mode("MST TRX STT", count=count)
    b.edge(SCL, 0, 4)
    b.set("STP")
    assert b.decoded_after(20 * SLOT) == "S 50W A"
    b.feed([7] * count)
    assert b.decoded_at_stop() == "S 50W A " + "07 A " * count + "P"


@rule("I2C-051", "I2C-058", "I2C-061", "I2C-076")
def test_repeat_mode_sends_without_limit_until_stp():
    b = Bench(Target())
    data = [n * 7 & 0xFF for n in range(300)]
    b.send(data, extra="RM", count=1)
    b.until(lambda: b.flag("ARDY") and len(b.target.got) == 300)
    assert b.held()
    assert b.target.got == data
    b.stop()
    assert b.decoded().endswith(f"{data[-1]:02x} A P")
    assert b.decoded().count("P") == b.decoded().count("S") == 1


# ---- repeated START ----------------------------------------------------------------------------------


@rule("I2C-150", "I2C-151", "I2C-152", "I2C-153", "I2C-247")
def test_stt_on_a_kept_bus_makes_a_repeated_start_for_another_slave_and_direction():
    b = Bench(Target(0x50), Target(0x21, [0xC5]))
    b.send([0x10], extra="")
    b.after("ARDY")
    b.w("I2CSAR", 0x21)
    b.mode("MST STT STP", count=1)
    b.edge(SDA, 0)
    b.edge(SCL, 0)
    assert b.flags("BB STT ARDY AL") == "BB"
    assert b.drain(1) == [0xC5]
    assert b.decoded_at_stop() == "S 50W A 10 A S 21R A c5 N P"


@rule("I2C-061", "I2C-150", "I2C-152")
def test_stt_ends_a_repeat_mode_transfer_with_a_repeated_start():
    b = Bench(Target(0x50), Target(0x21))
    b.send([1, 2], extra="RM")
    b.until(lambda: b.flag("ARDY") and b.flag("XRDY") and not b.flag("XSMT"))
    b.run(SLOT)
    b.w("I2CSAR", 0x21)
    b.mode("MST TRX STT STP", count=1)
    b.feed([3])
    assert b.decoded_at_stop() == "S 50W A 01 A 02 A S 21W A 03 A P"


@rule("I2C-152", "I2C-340")
def test_bb_stays_1_during_a_repeated_start():
    b = Bench(Target())
    b.send([1], extra="", until="ARDY")
    b.send([2], extra="STP")
    while not b.flag("SCD"):
        assert b.flag("BB")
        b.run(25)
    assert b.decoded() == "S 50W A 01 A S 50W A 02 A P"


@rule("I2C-153", "I2C-086", "I2C-152")
@pytest.mark.parametrize("how", ["header_r_only", "full_address_first"])
def test_repeated_start_with_ten_bit_addresses_changes_the_direction(how: str):
    """After the complete address, its first byte alone selects the slave; `ten_bit_read` concerns reads from idle."""
    b = Bench(Target(0x234, [0x99]), options=with_(ten_bit_read=how))
    b.w("I2CSAR", 0x234)
    b.send([0x11], extra="XA", until="ARDY")
    b.mode("MST STT STP XA", count=1)
    assert b.drain(1) == [0x99]
    assert b.decoded_at_stop() == "S 7aW A 34 A 11 A S 7aR A 99 N P"


@rule("I2C-153")
def test_repeated_start_in_the_free_data_format():
    b = Bench(Target(free="r"))
    b.send([0x11], extra="FDF", until="ARDY")
    b.send([0x22], extra="FDF STP")
    assert b.decoded_at_stop(free=True) == "S 11 A S 22 A P"


@rule("I2C-037", "I2C-040", "I2C-148", "I2C-208")
def test_a_new_transfer_can_follow_when_stp_reads_0():
    b = Bench(Target())
    b.write_all([1])
    b.write_all([2, 3])
    assert b.decoded() == "S 50W A 01 A P S 50W A 02 A 03 A P"
    stop, start = (s.start for s in decode(b.edges)[5:7])
    assert start - stop >= HIGH
    assert not [e for e in b.edges if stop < e.time < start]


# ---- the START byte -----------------------------------------------------------------------------------


@rule("I2C-063")
def test_stb_sends_a_start_byte_before_the_address():
    b = Bench(Target())
    b.send([0x12], extra="STP STB")
    assert b.decoded_at_stop() == "S 00R N S 50W A 12 A P"
    assert b.flags("NACK BB STT") == ""


@rule("I2C-064")
def test_without_stb_the_address_follows_the_start():
    b = Bench(Target())
    assert b.write_all([0x12]) == "S 50W A 12 A P"


@rule("I2C-063", "I2C-091")
def test_a_second_module_ignores_the_start_byte_and_answers_the_address():
    b = Bench(second=I2cOptions())
    b.w("I2COAR", 0x50, b.s)
    b.send([0x12], extra="STP STB")
    assert b.drain(1, b.s) == [0x12]
    assert b.decoded_at_stop() == "S 00R N S 50W A 12 A P"


def test_i2cmdr_values_of_the_manual():
    assert mdr("FREE STT STP MST TRX") == 0x6E20
    assert mdr("STT MST TRX") == 0x2620
    assert mdr("STT STP MST") == 0x2C20


# ---- commands during a transfer --------------------------------------------------------------------------


@rule("I2C-052")
@pytest.mark.parametrize("rm", ["", "RM"])
def test_the_reserved_combination_has_no_effect_on_a_kept_bus(rm: str):
    b = Bench(Target())
    b.send([1], extra=rm)
    b.after("ARDY")
    b.mode("MST TRX RM STT STP")
    assert b.held(20 * SLOT)
    b.mode("MST TRX STP " + rm)
    assert b.decoded_at_stop() == "S 50W A 01 A P"


@rule("I2C-039", "I2C-041")
@pytest.mark.parametrize("sent", [0, 1])
def test_stp_set_while_the_module_waits_for_data_does_not_end_the_wait(sent: int):
    """With RM = 0, the count has not reached 0."""
    b = Bench(Target())
    b.send([1] * sent, extra="", count=sent + 1)
    b.until(lambda: not b.flag("XSMT"))
    b.run(SLOT)
    b.set("STP")
    assert b.held(20 * SLOT)
    b.w("I2CDXR", 2)
    assert b.decoded_at_stop() == "S 50W A " + "01 A " * sent + "02 A P"


@rule("I2C-061", "I2C-137")
def test_stp_set_while_a_repeat_mode_transfer_waits_for_data_ends_it_at_once():
    b = Bench(Target())
    b.send([], extra="RM")
    b.until(lambda: not b.flag("XSMT"))
    b.run(SLOT)
    b.stop()
    assert b.decoded() == "S 50W A P"


@rule("I2C-330", "I2C-331", "I2C-333")
@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from(["transmit", "receive", "keep", "refused", "loopback", "start byte", "ten bits"]),
    st.integers(0, 40 * SLOT),
)
@example("start byte", 3540)  # in the high phase of a repeated START
def test_irs_0_at_any_time_releases_the_bus_and_the_next_transfer_is_correct(what: str, after: int):
    b = Bench(Target(gives=[0x12, 0x34, 0x56, 0x78]), own=0x2A)
    b.w("I2CCNT", 2)
    b.w("I2CDXR", 0x77)
    if what == "refused":
        b.w("I2CSAR", 0x33)
    names = {"receive": "MST STT", "keep": "MST TRX STT", "loopback": "MST TRX STT STP DLB"}.get(
        what, "MST TRX STT STP"
    )
    names += {"start byte": " STB", "ten bits": " XA"}.get(what, "")
    b.mode(names)
    b.run(after)
    b.w("I2CMDR", 0)
    assert b.m.out == 0b11
    assert b.peek("I2CSTR") & ~0x1000 == 0x0410  # BB may be 0 or 1
    free = 0
    while free < 2:  # the target may be within a byte, so firmware sends clock pulses and STOPs until SDA is free
        b.pull(SCL)
        b.run(LOW // 2)
        b.pull(SDA)
        b.run(LOW // 2)
        b.release(SCL)
        b.run(HIGH)
        b.release(SDA)
        b.run(HIGH)
        free += b.level[SDA]
    assert b.quiet(4 * SLOT)
    b.target.gives = [0x9A]
    b.w("I2CSAR", 0x50)
    b.mode("")
    b.pulse(SDA, LOW)  # an empty transfer of another master sets BB to 0
    b.run(4 * SLOT)
    since = b.now
    b.write_all([0x5A, 0xC3])
    assert b.read_all(1) == [0x9A]
    assert b.decoded(since) == "S 50W A 5a A c3 A P S 50R A 9a N P"


# ---- both lines in one cycle -------------------------------------------------------------------------


@rule("I2C-145", "I2C-146")
def test_both_lines_changing_in_one_cycle_are_neither_start_nor_stop():
    """Columns are half bits. The first change of SDA alone while SCL is high is a START, the last one a STOP."""
    rig = Rig(noise_filter_cycles=1).begin()
    rig.check(
        """
        > LINES  3 0 3 0 3 1 0 3 1 0 3 2 0 1 3
        < BB     0 . . . . 1 . . . . . . . . 0
    """,
        rig.bit // 2,
    )


@rule("I2C-145")
@pytest.mark.parametrize("sda", [0, 1])
def test_a_bit_is_the_new_level_of_sda_if_it_changes_with_the_rise_of_scl(sda: int):
    """The last bit of the address byte is the direction: 0x91 is a read, 0x90 a write."""
    rig = Rig(noise_filter_cycles=1).begin()
    rig.start()
    rig.send_bits(0x90 >> 1, 7)
    rig.put(sda=1 - sda)
    rig.wait(rig.bit // 2)
    rig.put(scl=1, sda=sda)
    rig.fall()
    rig.wait(rig.bit // 4)
    assert (rig.flag("SDIR"), rig.pulling_sda) == (sda, True)
