"""I2C free data format (FDF): there is no address, and TRX is the direction. SPRUG03B section 2.5.3, Table 7."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.f28335.i2c.options import I2cOptions

from ..i2c_bus import SCL, SDA, SLOT, Bench, Foreign, Target

rule = pytest.mark.rule


@rule("I2C-056", "I2C-315", "I2C-316", "I2C-317", "I2C-318")
@settings(max_examples=20, deadline=None)
@given(st.lists(st.integers(0, 255), min_size=1, max_size=4), st.integers(0, 0x3FF))
def test_master_transmitter_sends_data_from_the_first_byte_on(data: list[int], sar: int):
    b = Bench(Target(free="r"))
    b.w("I2CSAR", sar)
    b.send(data, extra="STP FDF")
    assert b.decoded_at_stop(free=True) == " ".join(["S", *(f"{d:02x} A" for d in data), "P"])
    assert b.target.got == data
    assert not b.flag("NACK")


@rule("I2C-056", "I2C-315", "I2C-316", "I2C-317", "I2C-318")
def test_master_receiver_receives_from_the_first_byte_on():
    b = Bench(Target(free="t", gives=[0x81, 0x42, 0x18]))
    assert b.read_all(3, extra="STP FDF") == [0x81, 0x42, 0x18]
    assert b.decoded(free=True) == "S 81 A 42 A 18 N P"


@rule("I2C-315", "I2C-316")
@pytest.mark.parametrize("bc", [1, 3, 7, 0])
def test_the_first_byte_has_bc_bits_too(bc: int):
    bits = bc or 8
    b = Bench(Target(free="r", bits=bits))
    b.write_all([0x35, 0x4A], extra="STP FDF", bc=bc)
    assert b.target.got == [0x35 & (1 << bits) - 1, 0x4A & (1 << bits) - 1]
    assert len(b.times(SCL, 1)) == 2 * (bits + 1) + 1


@rule("I2C-317", "I2C-319", "I2C-054", "I2C-316")
@pytest.mark.parametrize("own", [0x00, 0x50])
def test_a_slave_with_trx_0_receives_every_transfer_for_any_own_address(own: int):
    b = Bench(Foreign("S 77 12 P", at=2000), own=own)
    b.mode("FDF")
    assert b.drain(2) == [0x77, 0x12]
    b.run(4 * SLOT)
    assert b.foreign.acknowledges == "AA"


@rule("I2C-070", "I2C-316")
def test_the_first_byte_is_right_justified_with_zeros_above_it():
    b = Bench(second=I2cOptions())
    b.mode("FDF", 5, b.s)
    b.send([0x15], extra="STP FDF", bc=5)
    assert b.drain(1, b.s) == [0x15]


@rule("I2C-317", "I2C-319", "I2C-054")
def test_two_modules_one_as_receiver_one_as_transmitter():
    b = Bench(second=I2cOptions())
    b.mode("FDF TRX", chip=b.s)
    b.w("I2CDXR", 0x93, b.s)
    b.mode("MST STT STP FDF", count=2)
    got = []
    while len(got) < 2:
        b.until(lambda: b.flag("RRDY") or b.flag("XRDY", b.s))
        if b.flag("XRDY", b.s):
            b.w("I2CDXR", 0x94, b.s)
        if b.flag("RRDY"):
            got.append(b.r("I2CDRR"))
    b.stopped()
    assert got == [0x93, 0x94]
    assert b.decoded(free=True) == "S 93 A 94 N P"


@rule("I2C-320")
@pytest.mark.parametrize("xa, said", [("", "S 34W A 12 A P"), ("XA", "S 7aW A 34 A 12 A P")])
def test_without_fdf_the_format_is_given_by_xa(xa: str, said: str):
    b = Bench(Target(0x34), Target(0x234))
    b.w("I2CSAR", 0x234 if xa else 0x34)
    assert b.write_all([0x12], extra="STP " + xa) == said


@rule("I2C-318", "I2C-089")
def test_i2csar_0_is_not_a_general_call_in_the_free_data_format():
    b = Bench(Target(free="r"))
    b.w("I2CSAR", 0)
    b.send([0x12], extra="FDF", until="ARDY")
    assert not b.flag("NACK")


@pytest.mark.parametrize(("before", "after", "said"), [("FDF", "", "S 5a A P"), ("", "FDF", "S 50W A 5a A P")])
def test_the_format_is_that_of_the_write_that_sets_stt(before: str, after: str, said: str):
    """I2CMDR is written again after the fall of SDA of the START."""
    b = Bench(Target(free="r") if before else Target())
    b.mode(f"FREE MST TRX STT STP {before}", count=1, data=0x5A)
    b.edge(SDA, 0)
    b.mode(f"FREE MST TRX STP {after}")
    b.stopped()
    assert b.decoded(free=bool(before)) == said
