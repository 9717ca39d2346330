"""I2C slave: addresses that it acknowledges in 7-bit, 10-bit and free data format. SPRUG03B 2.5, Tables 5, 7 and 10."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ..i2c_registers import AAS, AD0, ARDY, BB, FDF, IRS, NACKSNT, RRDY, SDIR, STB, STP, STR_RESET, STT, TRX, XA
from ..i2c_rig import OTHER, OWN, Rig, addressed

TEN = 0x2C5  # 10-bit address 10 1100 0101
FIRST_BYTE = 0xF0 | TEN >> 8 << 1  # 11110 10 0


def ten_bit(address: int = TEN, **options) -> Rig:
    return Rig(**options).begin(XA, oar=address)


# 7-bit


@pytest.mark.rule("I2C-074", "I2C-077", "I2C-080", "I2C-093", "I2C-090")
@settings(max_examples=60, deadline=None)
@given(own=st.integers(1, 0x7F), sent=st.integers(1, 0x7F), read=st.integers(0, 1))
def test_a_7_bit_slave_acknowledges_its_own_address_and_no_other(own, sent, read):
    rig = Rig(bit=120).begin(oar=own)
    assert rig.address(sent, read) == (own == sent)
    assert rig.flag("AAS") == (own == sent)
    assert rig.flag("SDIR") == (own == sent and read)
    assert rig.pulling_sda is False


@pytest.mark.rule("I2C-074", "I2C-077")
def test_the_address_is_seven_bits_with_the_most_significant_bit_first():
    """0x43 = 100 0011 is not acknowledged in reversed bit order, as 110 0001."""
    rig = Rig().begin(oar=0x43)
    assert not rig.address(0x61)
    rig.stop()
    assert rig.address(0x43)


@pytest.mark.rule("I2C-082")
def test_in_7_bit_mode_ones_above_bit_6_of_oar_are_noted():
    """The comparison uses bits 6 to 0 in any case."""
    rig = Rig().begin(oar=OWN)
    assert rig.duties() == []
    rig = Rig().begin(oar=0x380 | OWN)
    assert rig.duties() == ["I2COAR = 0x3c8 has bits 9 to 7 set with XA = 0; expected 0 there"]
    assert rig.address(OWN)
    assert rig.duties() == []


@pytest.mark.rule("I2C-082")
@pytest.mark.parametrize("xa_first", [False, True])
def test_a_10_bit_address_may_be_written_before_xa(xa_first):
    """I2COAR is checked when IRS rises; before that, the order of the writes does not matter."""
    rig = Rig()
    if xa_first:
        rig.write("I2CMDR", XA)
    rig.write("I2COAR", 0x2C8)
    rig.write("I2CMDR", XA | IRS)
    assert rig.duties() == []


@pytest.mark.rule("I2C-082")
def test_an_own_address_written_with_irs_1_is_checked_at_once():
    rig = Rig().begin(oar=OWN)
    rig.write("I2COAR", 0x2C8)
    assert rig.duties() == [
        "I2COAR was written with IRS = 1; write configuration while IRS = 0",
        "I2COAR = 0x2c8 has bits 9 to 7 set with XA = 0; expected 0 there",
    ]


@pytest.mark.rule("I2C-093")
def test_after_a_foreign_address_data_are_not_acknowledged():
    rig = Rig().begin()
    assert not rig.address(OTHER)
    assert not rig.send(0x12)
    assert not rig.send(OWN << 1)
    assert rig.status(RRDY | AAS | NACKSNT) == 0


@pytest.mark.rule("I2C-075", "I2C-085", "I2C-093")
def test_sda_is_pulled_only_for_the_ninth_pulse():
    rig = Rig().begin()
    rig.start()
    for n in reversed(range(1, 8)):
        rig.clock((OWN << 1) >> n & 1)
        assert not rig.pulling_sda
    rig.rise(0)
    assert not rig.pulling_sda
    rig.fall()
    assert rig.pulling_sda
    rig.rise(1)
    assert rig.pulling_sda
    rig.fall()
    assert not rig.pulling_sda


# Directions, and bits that have no effect in a slave


@pytest.mark.rule("I2C-042", "I2C-099")
def test_an_idle_slave_pulls_no_line_and_scl_is_not_held_for_a_slow_master():
    rig = Rig().begin()
    rig.wait(100_000)
    assert rig.chip.out == 3
    rig.address()
    rig.write("I2CDXR", 1)
    rig.wait(100_000)
    assert not rig.stretching


@pytest.mark.rule("I2C-035", "I2C-036")
@pytest.mark.parametrize("bits", [STT, STP, STT | STP])
def test_start_and_stop_bits_have_no_effect_in_a_slave(bits):
    rig = Rig().begin()
    rig.write("I2CMDR", IRS | bits)
    rig.wait(100_000)
    assert rig.chip.out == 3
    assert rig.status() == STR_RESET
    assert rig.address()
    assert rig.send(0x5A)
    rig.write("I2CMDR", IRS | bits)
    rig.wait(100_000)
    assert rig.chip.out == 3
    assert rig.read("I2CDRR") == 0x5A


@pytest.mark.rule("I2C-053")
@pytest.mark.parametrize("trx", [0, TRX])
def test_the_direction_of_a_slave_is_that_of_the_master_for_any_trx(trx):
    rig = addressed(mode=trx)
    assert rig.send_and_read(0x5A) == 0x5A
    assert rig.restart(OWN << 1 | 1)
    assert rig.write_and_read_byte(0xA6, ack=False) == 0xA6


@pytest.mark.rule("I2C-065", "I2C-091")
@pytest.mark.parametrize("stb", [0, STB])
@pytest.mark.parametrize("oar", [0, 1, OWN])
def test_a_slave_ignores_a_start_byte(stb, oar):
    rig = Rig().begin(stb, oar)
    rig.start()
    assert not rig.send(0x01)
    assert rig.status(AAS | SDIR | RRDY) == 0
    assert rig.restart(oar << 1)
    rig.stop()
    assert rig.status(AAS | BB) == 0


@pytest.mark.rule("I2C-065")
def test_stb_changes_nothing_in_a_slave():
    plain, with_stb = addressed(mode=0), addressed(mode=STB)
    for rig in (plain, with_stb):
        rig.send(0x99)
    assert plain.status() == with_stb.status()
    assert plain.read("I2CDRR") == with_stb.read("I2CDRR") == 0x99


# General call


@pytest.mark.rule("I2C-090", "I2C-217", "I2C-226")
@pytest.mark.parametrize("mode, oar", [(0, OWN), (0, 0x7F), (XA, TEN)])
def test_the_general_call_is_answered(mode, oar):
    rig = Rig().begin(mode, oar)
    assert rig.address(0)
    assert rig.status(AAS | AD0 | SDIR) == AAS | AD0
    assert rig.send_and_read(0x06) == 0x06


@pytest.mark.rule("I2C-226")
def test_the_own_address_does_not_set_ad0():
    rig = addressed()
    assert rig.flag("AD0") == 0


# 10-bit


@pytest.mark.rule("I2C-083", "I2C-084", "I2C-085", "I2C-086", "I2C-216")
def test_a_10_bit_slave_acknowledges_both_address_bytes():
    rig = ten_bit()
    rig.start()
    assert rig.send(FIRST_BYTE)
    assert rig.flag("AAS") == 0
    assert rig.send(TEN & 0xFF)
    assert rig.status(AAS | SDIR | RRDY) == AAS
    assert rig.send_and_read(0x42) == 0x42


@pytest.mark.rule("I2C-083", "I2C-084")
@settings(max_examples=60, deadline=None)
@given(own=st.integers(1, 0x3FF), flips=st.sampled_from([0, *(1 << n for n in range(10))]))
def test_a_10_bit_slave_compares_all_ten_bits(own, flips):
    rig = Rig(bit=120).begin(XA, own)
    rig.start()
    sent = own ^ flips
    first = rig.send(0xF0 | sent >> 8 << 1)
    assert first == (own >> 8 == sent >> 8)
    second = rig.send(sent & 0xFF)
    assert second == (flips == 0)
    assert rig.flag("AAS") == (flips == 0)


@pytest.mark.rule("I2C-086", "I2C-224")
def test_10_bit_direction_changes_with_a_repeated_start_and_only_the_first_byte():
    rig = ten_bit()
    rig.start()
    rig.send(FIRST_BYTE)
    rig.send(TEN & 0xFF)
    rig.restart()
    assert rig.flag("AAS")
    assert rig.send(FIRST_BYTE | 1)
    assert rig.flag("SDIR")
    assert rig.write_and_read_byte(0xC3, ack=False) == 0xC3


@pytest.mark.rule("I2C-086")
def test_10_bit_read_without_the_full_address_before_is_not_answered():
    """The first byte matches 256 slaves; only the slave just addressed by both bytes may acknowledge it."""
    rig = ten_bit()
    rig.start()
    assert not rig.send(FIRST_BYTE | 1)
    rig.stop()
    rig.start()
    rig.send(FIRST_BYTE)
    rig.send(TEN & 0xFF ^ 1)
    assert not rig.restart(FIRST_BYTE | 1)
    assert rig.status(AAS | SDIR) == 0


@pytest.mark.rule("I2C-086")
@pytest.mark.parametrize("foreign", [[FIRST_BYTE ^ 2], [FIRST_BYTE, TEN & 0xFF ^ 1]])
def test_10_bit_read_after_another_slave_was_addressed_is_not_answered(foreign):
    rig = ten_bit()
    rig.start()
    assert rig.send(FIRST_BYTE)
    assert rig.send(TEN & 0xFF)
    rig.restart()
    for byte in foreign:
        rig.send(byte)
    assert not rig.restart(FIRST_BYTE | 1)
    assert rig.flag("SDIR") == 0


@pytest.mark.rule("I2C-087")
def test_a_10_bit_slave_does_not_answer_a_7_bit_address():
    rig = Rig().begin(XA, OWN)
    assert not rig.address(OWN)


@pytest.mark.rule("I2C-087")
def test_a_7_bit_slave_does_not_answer_a_10_bit_address():
    """As a 7-bit address, the first byte is 0x7A; the second byte contains the own address but is data."""
    rig = Rig().begin(0, TEN & 0x7F)
    rig.start()
    assert not rig.send(FIRST_BYTE)
    assert not rig.send(TEN & 0xFF)
    assert rig.flag("AAS") == 0


# Free data format


@pytest.mark.rule("I2C-054", "I2C-315", "I2C-316", "I2C-317", "I2C-319", "I2C-218", "I2C-320")
@pytest.mark.parametrize("oar", [0, OWN, 0x7F])
def test_free_data_format_the_first_byte_is_data_for_any_value(oar):
    rig = Rig().begin(FDF, oar)
    rig.start()
    assert rig.send(0xB1)
    assert rig.status(AAS | RRDY | SDIR) == AAS | RRDY
    assert rig.read("I2CDRR") == 0xB1
    assert rig.send_and_read(0x00) == 0x00
    assert rig.flag("AD0") == 0


@pytest.mark.rule("I2C-054", "I2C-317", "I2C-315")
def test_free_data_format_with_trx_the_slave_sends_from_the_first_bit_on():
    rig = Rig().begin(FDF | TRX)
    rig.write("I2CDXR", 0x9D)
    rig.start()
    assert rig.read_byte() == 0x9D
    assert rig.write_and_read_byte(0x3E, ack=False) == 0x3E
    rig.stop()
    assert rig.status(RRDY | BB) == 0


@pytest.mark.rule("I2C-315")
@pytest.mark.parametrize("bits", [2, 4, 7])
def test_free_data_format_the_first_byte_has_bc_bits(bits):
    rig = Rig().begin(FDF | bits)
    rig.start()
    value = 0b1011011 >> 7 - bits
    assert rig.send(value, bits)
    assert rig.read("I2CDRR") & (1 << bits) - 1 == value


@pytest.mark.rule("I2C-320")
@pytest.mark.parametrize("xa, answered", [(0, True), (XA, False)])
def test_without_free_data_format_xa_selects_the_format(xa, answered):
    rig = Rig().begin(xa)
    assert rig.address() == answered


@pytest.mark.rule("I2C-246", "I2C-175")
def test_a_high_speed_master_code_is_treated_as_a_foreign_address():
    rig = Rig().begin()
    assert not rig.address(0x08 >> 1)
    assert rig.status(AAS | ARDY) == 0
    rig.stop()
    assert rig.flag("SCD")
