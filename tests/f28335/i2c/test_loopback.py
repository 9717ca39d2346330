"""I2C digital loopback (DLB). SPRUG03B Table 5 (DLB), Figure 15."""

from __future__ import annotations

from functools import partial

import pytest

from ..i2c_bus import SCL, SDA, SLOT, Bench, Foreign, Target, with_

rule = pytest.mark.rule

OWN = 0x2A


def loop(b: Bench, data: list[int], extra: str = "STP") -> list[int]:
    """Send bytes in loopback and return the received ones."""
    b.w("I2COAR", OWN)
    b.mode("FREE MST TRX STT DLB " + extra, count=len(data))
    got, left = [], list(data)
    while len(got) < len(data):
        b.until(lambda: b.flag("RRDY") or (left and b.flag("XRDY")))
        if left and b.flag("XRDY"):
            b.w("I2CDXR", left.pop(0))
        if b.flag("RRDY"):
            got.append(b.r("I2CDRR"))
    return got


def decoded_bytes(b: Bench) -> list[str]:
    """Return the decoded transfer without acknowledge bits, because the manual does not specify them on the pin."""
    return [word for word in b.decoded().split() if word not in "AN"]


@rule("I2C-307")
@pytest.mark.parametrize("data", [[0x5C], [1, 2, 3], [0xFF, 0x00, 0xAA]])
def test_bytes_from_i2cdxr_are_received_in_i2cdrr(data: list[int]):
    b = Bench()
    assert loop(b, data) == data


@rule("I2C-307", "I2C-044", "I2C-040")
def test_i2cmdr_after_the_transfer_has_the_value_that_users_saw_on_a_related_device():
    """0x6E60 is written; at the end of the transfer it is 0x4260, because STT, STP and MST have cleared themselves."""
    b = Bench()
    loop(b, [0x5C])
    b.until(lambda: not b.flag("STP"))
    b.run(2 * SLOT)
    assert b.r("I2CMDR") == 0x4260
    assert b.flags("NACK AL BB") == ""


@rule("I2C-311", "I2C-312")
def test_the_pins_show_the_transfer_to_the_own_address():
    b = Bench()
    loop(b, [0x5C, 0xA3])
    b.run(4 * SLOT)
    assert decoded_bytes(b) == ["S", f"{OWN:02x}W", "5c", "a3", "P"]


@rule("I2C-312")
def test_without_dlb_the_address_is_i2csar():
    b = Bench(Target(0x50), own=OWN)
    assert b.write_all([0x5C]) == "S 50W A 5c A P"


@rule("I2C-310")
def test_a_level_forced_on_the_sda_pin_is_not_seen():
    b = Bench()
    b.pull(SDA)
    assert loop(b, [0x5C, 0xFF]) == [0x5C, 0xFF]
    assert b.flags("AL NACK") == ""


@rule("I2C-309")
def test_a_level_forced_on_the_scl_pin_does_not_stop_the_clock():
    b = Bench()
    b.pull(SCL)
    assert loop(b, [0x5C]) == [0x5C]


@rule("I2C-306")
def test_without_dlb_the_module_waits_for_the_scl_pin():
    b = Bench(Target(0x50))
    b.mode("MST TRX STT STP", count=1, data=0x5C)
    b.edge(SCL, 0, 3)
    b.pull(SCL)
    assert b.held(30 * SLOT)
    b.release(SCL)
    assert b.decoded_at_stop() == "S 50W A 5c A P"


@rule("I2C-306")
def test_without_dlb_nothing_is_received():
    b = Bench(Target(0x50), own=OWN)
    b.write_all([0x5C])
    assert b.flags("RRDY") == "" and b.peek("I2CDRR") == 0


@rule("I2C-313")
def test_loopback_needs_mst():
    b = Bench()
    b.duties()
    b.mode("DLB")
    (note,) = b.duties()
    assert "DLB" in note.text and "MST" in note.text

    b = Bench()
    b.duties()
    b.w("I2COAR", OWN)
    b.mode("MST TRX DLB")
    assert not [note for note in b.duties() if "DLB" in note.text]


@rule("I2C-314")
def test_loopback_in_the_free_data_format_is_not_supported():
    b = Bench()
    b.duties()
    b.mode("MST TRX DLB FDF")
    (note,) = b.duties()
    assert "DLB" in note.text and "FDF" in note.text


@rule("I2C-309", "I2C-310")
def test_a_foreign_transfer_on_the_pins_is_ignored():
    b = Bench(Foreign("S 2AW 12 P"), own=OWN)
    b.mode("MST TRX DLB")
    b.run(30 * SLOT)
    assert b.foreign.done and b.foreign.acknowledges == "NN"
    assert b.flags("AAS RRDY") == ""


# ---- leaving loopback: the levels of the pins count again ------------------------------------------------

FILTER = 16  # delay of the filter in cycles, plus one
LEAVING = pytest.mark.parametrize("way", ["DLB written 0", "IRS written 0 and 1"])


def leave(b: Bench, way: str) -> None:
    if way != "DLB written 0":
        b.w("I2CMDR", 0)
    b.mode("")
    b.run(FILTER)


@rule("I2C-306")
@LEAVING
def test_after_loopback_a_clock_edge_of_others_is_no_start(way: str):
    """SCL and SDA are low in a transfer of others. When SCL rises and then SDA, this is only a STOP."""
    b = Bench()
    b.mode("MST TRX DLB")
    for line in (SDA, SCL):
        b.pull(line)
        b.run(FILTER)
    assert b.flags("BB SCD") == ""
    leave(b, way)
    b.release(SCL)
    b.run(FILTER)
    assert b.flags("BB SCD") == ""
    b.release(SDA)
    b.run(FILTER)
    assert b.flags("BB SCD") == "SCD"


@rule("I2C-306", "I2C-037")
@LEAVING
def test_after_loopback_a_start_waits_for_scl_held_by_others(way: str):
    b = Bench(Target(0x50))
    b.mode("MST TRX DLB")
    b.pull(SCL)
    b.run(FILTER)
    leave(b, way)
    b.send([0x12])
    b.run(10 * SLOT)
    assert b.times(SDA, 0) == [] and b.flags("BB STT") == "STT"
    b.release(SCL)
    assert b.decoded_at_stop() == "S 50W A 12 A P"


def test_a_receiver_counts_bytes_even_if_the_filter_suppresses_every_bit():
    """A filter of 20 module clocks is wider than the high period of SCL."""
    b = Bench(options=with_(noise_filter_cycles=20))
    b.mode("FREE MST STT STP DLB", count=3)
    b.drain(2)
    assert not b.flag("NACKSNT")
    b.drain(1)
    b.run(2 * SLOT)
    assert b.flag("NACKSNT")


def _waits_for_data(b: Bench) -> bool:
    return not b.flag("XSMT")


def test_a_byte_written_just_before_the_stop_is_received_after_the_usual_delay():
    n, early = 8 * 15, 50
    whole, b = (Bench(options=with_(dlb_delay="after_dxr_write"), psc=14) for _ in range(2))
    for bench in (whole, b):
        bench.w("I2COAR", OWN)
        bench.mode("FREE MST TRX STT STP DLB", count=1)
        bench.until(partial(_waits_for_data, bench))
        bench.w("I2CDXR", 0x5C)
    stop = whole.until(lambda: not whole.flag("STP"))
    b.run(stop - early - b.now)
    assert b.r("I2CDRR") == 0x5C
    b.w("I2CDXR", 0xA3)
    written = b.now
    assert b.flag("STP")
    assert b.until(lambda: b.flag("RRDY")) == written + n > stop
    assert b.r("I2CDRR") == 0xA3
