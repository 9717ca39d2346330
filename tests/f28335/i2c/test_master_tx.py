"""I2C master-transmitter: addresses, data bits, count, repeat mode, FIFO, ARDY and NACK. SPRUG03B sections 2.5, 5."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.f28335.i2c.options import I2cOptions

from ..i2c_bus import SCL, SLOT, Bench, Foreign, Target, mdr
from ..i2c_registers import FLAGS, MDR, OFFSET

rule = pytest.mark.rule

FIFO_ON = 1 << 14 | 1 << 13  # I2CFFEN, TXFFRST


# ---- bits on the wire --------------------------------------------------------------------------------


@rule("I2C-055", "I2C-066", "I2C-074", "I2C-075", "I2C-077", "I2C-078", "I2C-079", "I2C-129", "I2C-131")
@settings(max_examples=25, deadline=None)
@given(st.integers(1, 0x77), st.lists(st.integers(0, 255), min_size=1, max_size=4))
def test_any_bytes_are_sent_to_any_address(address: int, data: list[int]):
    b = Bench(Target(address))
    b.w("I2CSAR", address)
    said = b.write_all(data)
    assert said == " ".join([f"S {address:02x}W A", *(f"{d:02x} A" for d in data), "P"])
    assert b.target.got == data


@rule("I2C-131", "I2C-133", "I2C-136", "I2C-235", "I2C-237", "I2C-243")
def test_flags_during_a_transfer_of_two_bytes():
    b = Bench(Target())
    b.mode("MST TRX STT", count=2, data=0x5)
    start = b.edge(SCL, 0)
    b.check(
        """
        > I2CDXR  ........ . ..6..... . ........ . .
        < XRDY    0....... . 1.0..... . 1....... . .
        < ARDY    0....... . ........ . ........ . 1
        < NACK    0....... . ........ . ........ . .
        < SCD     0....... . ........ . ........ . .
        < BB      1....... . ........ . ........ . .
        < I2CCNT  2....... . ........ . ........ . .
    """,
        SLOT,
        start=start,
    )
    assert b.decoded() == "S 50W A 05 A 06 A"


@rule("I2C-067", "I2C-068", "I2C-071")
@pytest.mark.parametrize("bc", range(1, 8))
def test_bc_sets_the_bits_of_data_bytes_and_sends_the_low_ones(bc: int):
    b = Bench(Target(bits=bc))
    assert b.write_all([0xA5, 0x5A], bc=bc).startswith("S 50W A ")
    assert b.target.got == [0xA5 & (1 << bc) - 1, 0x5A & (1 << bc) - 1]
    # 1 START, 9 pulses of the address, 2 * (bc + 1) of data, 1 of the STOP
    assert len(b.times(SCL, 1)) == 9 + 2 * (bc + 1) + 1


@rule("I2C-069")
def test_a_change_of_bc_within_a_byte_applies_to_the_next_byte():
    b = Bench(Target())
    b.send([0xA5], extra="STP", count=2)
    b.edge(SCL, 0, 10 + 4)
    b.w("I2CMDR", b.peek("I2CMDR") | 5)
    b.target.later = {2: 5}
    b.feed([0xF6])
    b.stopped()
    assert b.target.got == [0xA5, 0x16]


@rule("I2C-072")
def test_bc_written_after_i2cdxr_is_noted():
    b = Bench(Target(bits=5))
    b.w("I2CCNT", 1)
    b.duties()
    b.w("I2CMDR", mdr("", 5))
    b.w("I2CDXR", 0x12)
    b.w("I2CMDR", mdr("MST TRX STT STP", 5))
    assert not b.duties()
    assert b.decoded_at_stop(bits=5) == "S 50W A 12 A P"

    b = Bench(Target(bits=5))
    b.w("I2CCNT", 1)
    b.w("I2CDXR", 0x12)
    b.duties()
    b.w("I2CMDR", mdr("MST TRX STT STP", 5))
    (note,) = b.duties()
    assert "BC" in note.text and "I2CDXR" in note.text


@rule("I2C-073")
@pytest.mark.parametrize("bc", [1, 4, 7, 0])
def test_two_modules_with_the_same_bc_exchange_bytes(bc: int):
    b = Bench(second=I2cOptions())
    b.w("I2COAR", 0x50, b.s)
    b.mode("", bc, b.s)
    b.send([0x35, 0xCA], bc=bc)
    mask = (1 << (bc or 8)) - 1
    assert [d & mask for d in b.drain(2, b.s)] == [0x35 & mask, 0xCA & mask]
    b.stopped()
    assert b.flags("NACK") == ""


# ---- addresses ----------------------------------------------------------------------------------------


@rule("I2C-083", "I2C-084", "I2C-085", "I2C-086")
@settings(max_examples=20, deadline=None)
@given(st.integers(0x80, 0x3FF))
def test_ten_bit_address_takes_two_acknowledged_bytes_and_data_follow(address: int):
    b = Bench(Target(address))
    b.w("I2CSAR", address)
    said = b.write_all([0x12], extra="STP XA")
    assert said == f"S {0x78 | address >> 8:02x}W A {address & 0xFF:02x} A 12 A P"
    assert b.target.got == [0x12]


@rule("I2C-084", "I2C-085")
def test_the_second_address_byte_must_be_acknowledged_too():
    b = Bench(Target(0x234))
    b.w("I2CSAR", 0x235)
    b.mode("MST TRX STT XA", count=1, data=0x12)
    b.after("NACK", 4)
    assert b.decoded() == "S 7aW A 35 N"


@rule("I2C-088")
def test_i2csar_written_during_a_transfer_applies_to_the_next_start():
    b = Bench(Target(0x50), Target(0x21))
    b.send([1], extra="", count=1)
    b.w("I2CSAR", 0x21)
    b.until(lambda: b.flag("ARDY"))
    assert b.decoded() == "S 50W A 01 A"
    b.send([2], extra="STP")
    assert b.decoded_at_stop() == "S 50W A 01 A S 21W A 02 A P"


@rule("I2C-088")
def test_i2csar_written_while_the_address_is_on_the_bus_does_not_change_it():
    b = Bench(Target(0x50))
    b.mode("MST TRX STT STP", count=1, data=1)
    b.edge(SCL, 0, 3)
    b.w("I2CSAR", 0x7F)
    assert b.decoded_at_stop() == "S 50W A 01 A P"


@rule("I2C-089", "I2C-252")
def test_i2csar_0_is_a_general_call_and_nack_is_1_although_it_is_acknowledged():
    b = Bench(Target(also=[0]))
    b.w("I2CSAR", 0)
    b.send([0x12], extra="")
    b.until(lambda: b.flag("NACK") and b.target.got)
    b.run(2 * SLOT)
    assert b.flags("NACK") == "NACK"
    assert b.decoded() == "S 00W A 12 A"
    assert b.target.got == [0x12]


@rule("I2C-089")
def test_an_address_other_than_0_is_not_a_general_call():
    b = Bench(Target())
    b.send([0x12], extra="", until="ARDY")
    assert b.flags("NACK") == ""


@rule("I2C-092", "I2C-131")
def test_a_byte_in_i2cdxr_waits_there_while_the_address_is_shifted_out():
    b = Bench(Target())
    b.mode("MST TRX STT STP", count=1, data=0x77)
    b.edge(SCL, 0)
    for _ in range(8):
        assert b.flags("XRDY") == ""
        b.edge(SCL, 0)
    b.until(lambda: b.flag("XRDY"), SLOT + SLOT // 2)
    assert b.decoded_at_stop() == "S 50W A 77 A P"


# ---- underflow ------------------------------------------------------------------------------------------


@rule("I2C-130", "I2C-213", "I2C-214", "I2C-243")
@pytest.mark.parametrize("sent", [0, 1, 3])
def test_without_data_scl_is_held_low_until_i2cdxr_is_written(sent: int):
    b = Bench(Target())
    b.send([9] * sent, count=sent + 1)
    b.until(lambda: not b.flag("XSMT"))
    b.run(SLOT)
    assert b.held(30 * SLOT)
    assert b.flags("XSMT XRDY ARDY BB MST") == "XRDY BB MST"
    b.w("I2CDXR", 0x44)
    b.until(lambda: b.flag("XSMT"), SLOT)
    assert b.decoded_at_stop() == "S 50W A " + "09 A " * sent + "44 A P"


# ---- count ------------------------------------------------------------------------------------------------


@rule("I2C-057", "I2C-132", "I2C-133", "I2C-135", "I2C-128")
@settings(max_examples=10, deadline=None)
@given(st.integers(1, 40))
def test_i2ccnt_bytes_are_sent_and_i2ccnt_keeps_its_value(count: int):
    b = Bench(Target())
    b.write_all(list(range(count)))
    assert len(b.target.got) == count
    assert b.r("I2CCNT") == count


@rule("I2C-132", "I2C-133")
def test_the_next_transfer_starts_again_from_the_value_in_i2ccnt():
    b = Bench(Target())
    b.write_all([1, 2])
    b.mode("MST TRX STT STP")
    b.feed([3, 4])
    b.stopped()
    assert b.decoded().endswith("P S 50W A 03 A 04 A P")


@pytest.mark.long
@rule("I2C-134")
def test_i2ccnt_0_means_65536_bytes():
    """To be fast, bytes have one bit, the test passes the pin levels directly, and SDA stays low after the START."""
    b = Bench(Target())
    chip = b.m
    b.w("I2CFFTX", FIFO_ON)
    b.mode("MST TRX STT STP FDF", 1, count=0)
    b.edge(SCL, 0)
    now = b.now
    chip.pins(now, 0b00)
    scl, falls, written = 0, 0, 0
    while chip.peek(now, OFFSET["I2CMDR"]) & MDR["STP"] and falls < 2 * 65536 + 2:
        if chip.next_wake > now + 100 * SLOT:
            for _ in range(16):
                chip.write(now, OFFSET["I2CDXR"], 0)
            written += 16
        else:
            now = chip.next_wake
            chip.wake(now)
        if chip.out & 1 != scl:
            scl = chip.out & 1
            falls += not scl
            chip.pins(now, scl)
            if scl and falls == 2 * 65536:
                break
    assert falls == 2 * 65536
    for _ in range(8):
        now = min(chip.next_wake, now + SLOT)
        chip.wake(now)
    assert chip.out == 0b11  # the last rise was that of the STOP


# ---- repeat mode -----------------------------------------------------------------------------------------


@rule("I2C-059", "I2C-137", "I2C-245", "I2C-247")
def test_repeat_mode_each_write_to_i2cdxr_sends_one_byte_and_each_byte_sets_ardy():
    b = Bench(Target())
    b.send([], extra="RM", count=1)
    text = "S 50W A"
    for byte in (0x11, 0x22, 0x33):
        b.until(lambda: not b.flag("XSMT"))
        b.clear("ARDY")
        b.w("I2CDXR", byte)
        b.edge(SCL, 0, 3)
        assert not b.flag("ARDY")
        b.until(lambda: b.flag("ARDY"))
        text += f" {byte:02x} A"
        b.run(SLOT)
        assert b.held(10 * SLOT)
        assert b.decoded() == text
    b.stop()
    assert b.decoded() == text + " P"


@rule("I2C-058")
@pytest.mark.parametrize("count", [0, 1, 2, 65535])
def test_repeat_mode_ignores_i2ccnt(count: int):
    b = Bench(Target())
    b.send([1, 2, 3, 4], extra="RM", count=count)
    b.until(lambda: b.flag("ARDY") and len(b.target.got) == 4)
    assert b.held()


@rule("I2C-060", "I2C-137")
@pytest.mark.parametrize("count", [1, 5, 16])
def test_repeat_mode_with_fifo_sends_until_the_fifo_is_empty(count: int):
    b = Bench(Target())
    b.w("I2CFFTX", FIFO_ON)
    for n in range(count):
        b.w("I2CDXR", n)
    assert b.peek("I2CFFTX") >> 8 & 31 == count
    b.mode("MST TRX STT RM")
    b.until(lambda: len(b.target.got) == count)
    b.run(SLOT)
    assert b.held(30 * SLOT)
    assert b.peek("I2CFFTX") >> 8 & 31 == 0
    assert b.flag("ARDY")
    b.stop()
    assert b.target.got == list(range(count))


@rule("I2C-057", "I2C-047")
def test_counted_transfer_takes_its_bytes_from_the_fifo_and_leaves_the_rest():
    b = Bench(Target())
    b.w("I2CFFTX", FIFO_ON)
    for n in range(5):
        b.w("I2CDXR", n)
    b.mode("MST TRX STT STP", count=3)
    b.stopped()
    assert b.target.got == [0, 1, 2]
    assert b.peek("I2CFFTX") >> 8 & 31 == 2


# ---- ARDY --------------------------------------------------------------------------------------------------


@rule("I2C-244")
def test_with_stp_the_end_of_the_count_does_not_set_ardy():
    b = Bench(Target())
    seen = []
    b.send([1, 2])
    while not b.flag("SCD"):
        seen.append(b.flag("ARDY"))
        b.run(15)
    assert not any(seen) and not b.flag("ARDY")


@rule("I2C-243", "I2C-248", "I2C-249")
@pytest.mark.parametrize("how", ["write 1", "IRS", "write 0"])
def test_ardy_is_cleared_by_writing_1_and_by_reset(how: str):
    b = Bench(Target())
    b.send([1], extra="", until="ARDY")
    if how == "IRS":
        b.w("I2CMDR", 0)
    else:
        b.w("I2CSTR", FLAGS["ARDY"] if how == "write 1" else 0)
    assert b.flag("ARDY") == (how == "write 0")


@rule("I2C-246")
def test_ardy_is_never_set_in_slave_mode():
    b = Bench(Foreign("S 50W 01 02 P +400 S 50R ?A ?N P"), own=0x50)
    b.w("I2CCNT", 1)
    b.w("I2CDXR", 0x77)
    seen, got = [], []
    while not b.foreign.done:
        b.run(15)
        seen.append(b.flag("ARDY"))
        if b.flag("RRDY"):
            got.append(b.r("I2CDRR"))
        if b.flag("XRDY"):
            b.w("I2CDXR", 0x78)
    assert got == [1, 2] and len(b.foreign.got) == 2
    assert not any(seen)


# ---- NACK --------------------------------------------------------------------------------------------------


@rule("I2C-250")
def test_i2cstr_after_an_absent_slave_has_the_value_that_users_saw_on_a_related_device():
    """I2CSTR = 0x1406 (BB, XSMT, ARDY, NACK) if I2CDXR is written before STT; the byte is not sent (XRDY = 0)."""
    b = Bench()
    b.mode("MST TRX STT", count=1, data=0x12)
    b.after("NACK")
    assert b.peek("I2CSTR") == 0x1406
    assert b.held(20 * SLOT)
    b.stop()
    assert b.decoded() == "S 50W N P"


@rule("I2C-250")
@pytest.mark.parametrize("number", [0, 1])
def test_a_refused_data_byte_sets_nack_and_no_further_byte_goes_out(number: int):
    b = Bench(Target(nack=[number]))
    b.send([1, 2, 3][: number + 1], extra="", count=3)
    assert not b.flag("NACK")
    b.after("NACK", 20)
    assert b.decoded() == ["S 50W A 01 N", "S 50W A 01 A 02 N"][number]
    b.stop()
    assert b.decoded().endswith("N P")


@rule("I2C-253")
def test_nack_is_cleared_by_the_next_acknowledge():
    b = Bench(Target())
    b.w("I2CSAR", 0x33)
    b.send([], extra="", count=1)
    b.after("NACK")
    b.w("I2CSAR", 0x50)
    b.mode("MST TRX STT STP")
    b.until(lambda: not b.flag("NACK"))
    b.feed([1])
    assert b.decoded_at_stop() == "S 33W N S 50W A 01 A P"


@rule("I2C-187")
def test_nackmod_has_no_effect_on_a_transmitter():
    b = Bench(Target())
    b.write_all([1, 2], extra="STP NACKMOD")
    assert b.decoded() == "S 50W A 01 A 02 A P"
    assert b.flags("NACKSNT NACK") == ""
