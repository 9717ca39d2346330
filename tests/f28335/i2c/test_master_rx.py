"""I2C master-receiver: count, acknowledge and NACK, overrun, repeat mode. SPRUG03B Tables 1, 2, 5, section 5.10."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ..i2c_bus import SCL, SLOT, Bench, Target

rule = pytest.mark.rule


@rule("I2C-055", "I2C-078", "I2C-129", "I2C-138", "I2C-139", "I2C-140", "I2C-142", "I2C-143", "I2C-191", "I2C-057")
@settings(max_examples=25, deadline=None)
@given(st.integers(1, 0x77), st.lists(st.integers(0, 255), min_size=1, max_size=5))
def test_any_bytes_are_received_from_any_address(address: int, data: list[int]):
    """The address is sent first, every byte except the last one is acknowledged, and a STOP follows."""
    b = Bench(Target(address, data))
    b.w("I2CSAR", address)
    assert b.read_all(len(data)) == data
    body = " ".join(f"{d:02x} A" for d in data)[:-1] + "N"
    assert b.decoded() == f"S {address:02x}R A {body} P"
    assert b.target.answers == [0] * (len(data) - 1) + [1]
    assert b.flags("STP MST BB STT NACK ARDY") == ""
    assert b.flags("NACKSNT SCD") == "NACKSNT SCD"


@rule("I2C-138", "I2C-139")
def test_nothing_is_received_if_the_read_address_is_not_acknowledged():
    b = Bench()
    b.mode("MST STT", count=2)
    b.after("NACK", 20)
    assert b.decoded() == "S 50R N"
    assert b.flags("RRDY RSFULL") == ""


@rule("I2C-140", "I2C-239", "I2C-240")
def test_rrdy_is_set_by_each_byte_and_cleared_by_its_read():
    b = Bench(Target(gives=[0x81, 0x42]))
    b.mode("MST STT STP", count=2)
    b.edge(SCL, 0, 10 + 7)
    assert b.flags("RRDY") == ""
    b.until(lambda: b.flag("RRDY"), 3 * SLOT)
    assert b.r("I2CDRR") == 0x81
    assert b.flags("RRDY") == ""
    assert b.drain(1) == [0x42]


@rule("I2C-141", "I2C-210", "I2C-211")
def test_two_unread_bytes_hold_scl_until_i2cdrr_is_read():
    data = [0x11, 0x22, 0x33, 0x44]
    b = Bench(Target(gives=data))
    b.mode("MST STT STP", count=4)
    b.after("RSFULL", 2)
    assert b.held(40 * SLOT)
    assert len(b.times(SCL, 0)) in (1 + 9 + 9 + 8, 1 + 9 + 9 + 9)
    assert b.r("I2CDRR") == 0x11
    assert b.flags("RSFULL") == ""
    assert b.drain(3) == data[1:]
    assert b.decoded_at_stop() == "S 50R A 11 A 22 A 33 A 44 N P"


@rule("I2C-142", "I2C-132", "I2C-133")
@pytest.mark.parametrize("count", [1, 2, 7, 20])
def test_i2ccnt_bytes_are_received_and_i2ccnt_keeps_its_value(count: int):
    b = Bench(Target(gives=range(count)))
    assert b.read_all(count) == list(range(count))
    assert b.r("I2CCNT") == count


@rule("I2C-142", "I2C-243")
def test_without_stp_the_end_of_the_count_sets_ardy_and_keeps_the_bus():
    b = Bench(Target(gives=[1, 2, 3]))
    b.mode("MST STT", count=2)
    assert b.drain(2) == [1, 2]
    b.after("ARDY")
    assert b.held(20 * SLOT)
    assert b.flags("BB MST SCD") == "BB MST"
    b.stop()
    assert b.decoded().endswith(" P")


@rule("I2C-067", "I2C-070", "I2C-073", "I2C-140")
@pytest.mark.parametrize("bc", range(1, 8))
def test_bc_bits_are_received_right_justified(bc: int):
    mask = (1 << bc) - 1
    b = Bench(Target(gives=[0x55 & mask, 0xAA & mask], bits=bc))
    got = b.read_all(2, bc=bc)
    assert [g & mask for g in got] == [0x55 & mask, 0xAA & mask]
    assert len(b.times(SCL, 1)) == 9 + 2 * (bc + 1) + 1


@rule("I2C-069")
def test_a_change_of_bc_within_a_received_byte_applies_to_the_next():
    b = Bench(Target(gives=[0xA5, 0x16]))
    b.mode("MST STT STP", count=2)
    b.edge(SCL, 0, 10 + 4)
    b.w("I2CMDR", b.peek("I2CMDR") | 5)
    b.target.later = {2: 5}
    first, second = b.drain(2)
    b.stopped()
    assert (first, second & 31) == (0xA5, 0x16)


# ---- NACK by software ----------------------------------------------------------------------------------


@rule("I2C-183", "I2C-184", "I2C-185", "I2C-201")
@pytest.mark.parametrize("byte", [0, 1, 2])
def test_nackmod_sends_a_nack_for_the_byte_in_which_it_is_set(byte: int):
    b = Bench(Target(gives=range(5)))
    b.mode("MST STT", count=5)
    b.drain(byte)
    b.edge(SCL, 0, 3)
    assert len(b.target.answers) == byte
    b.set("NACKMOD")
    b.until(lambda: len(b.target.answers) > byte)
    b.run(SLOT)
    assert b.target.answers == [0] * byte + [1]
    assert not b.flag("NACKMOD")
    assert b.flag("NACKSNT")


@rule("I2C-185", "I2C-186")
@pytest.mark.parametrize("late, answers", [(False, [1]), (True, [0, 1])])
def test_nackmod_must_be_set_before_the_last_data_bit_rises(late: bool, answers: list[int]):
    b = Bench(Target(gives=range(5)))
    b.mode("MST STT", count=5)
    b.edge(SCL, 1, 9 + 8 - (not late))
    b.run(40 if late else 0)
    b.set("NACKMOD")
    b.until(lambda: b.flag("RRDY"))
    b.r("I2CDRR")
    b.until(lambda: len(b.target.answers) == len(answers))
    assert b.target.answers == answers


@rule("I2C-187")
def test_nackmod_left_from_transmitting_does_not_refuse_an_address():
    """A transmitter leaves the acknowledge bits to other devices; NACKMOD has a meaning only for a receiver."""
    b = Bench(Target())
    b.send([1, 2], extra="NACKMOD", until="ARDY")
    assert b.decoded() == "S 50W A 01 A 02 A"
    assert b.flags("NACKSNT") == ""


@rule("I2C-189")
def test_irs_0_within_a_byte_releases_both_lines():
    b = Bench(Target(gives=[0xFF, 0xFF]))
    b.mode("MST STT", count=2)
    b.edge(SCL, 0, 10 + 6)
    b.w("I2CMDR", 0)
    b.run(SLOT)
    assert b.level == [1, 1]
    assert b.m.out == 0b11


@rule("I2C-192")
@pytest.mark.parametrize("count", [2, 3, 9])
def test_stp_set_during_a_transfer_ends_it_before_the_count(count: int):
    b = Bench(Target(gives=[1, 2, 3]))
    b.mode("MST STT", count=count)
    assert b.drain(1) == [1]
    b.edge(SCL, 0, 4)
    b.set("STP")
    assert b.drain(1) == [2]
    assert b.decoded_at_stop() == "S 50R A 01 A 02 N P"
    assert b.flags("STP MST BB") == ""


@rule("I2C-191")
def test_the_end_of_the_count_sends_the_nack_and_the_stop():
    b = Bench(Target(gives=range(9)))
    b.read_all(4)
    assert b.target.answers == [0, 0, 0, 1]
    assert b.decoded().endswith("03 N P")


@rule("I2C-152", "I2C-139")
def test_write_then_read_of_a_register_with_a_repeated_start():
    b = Bench(Target(gives=[0xE5, 0x00]))
    b.send([0x32], extra="", until="ARDY")
    assert b.read_all(2) == [0xE5, 0x00]
    assert b.decoded() == "S 50W A 32 A S 50R A e5 A 00 N P"


@rule("I2C-299")
def test_received_bytes_are_stored_in_the_fifo():
    b = Bench(Target(gives=range(1, 11)))
    b.w("I2CFFTX", 1 << 14)
    b.w("I2CFFRX", 1 << 13)
    b.mode("MST STT STP", count=10)
    b.stopped()
    assert b.peek("I2CFFRX") >> 8 & 31 == 10
    assert [b.r("I2CDRR") for _ in range(10)] == list(range(1, 11))
