"""A real-time clock with two-byte register addresses: write enable, calendar, rejected settings and notes."""

from __future__ import annotations

from datetime import datetime

import pytest

from periph_sim.devices.targets.rtc import BadTime, CalendarTime, registers_of, time_in
from periph_sim.scene.case.model import BadCase
from tests.devices.targets.bus_of import SECOND, Bus

WEL, BOTH = "6f W 00 3f 02", "6f W 00 3f 06"
TIME = "6f W 00 30 Sr 6f R 8"
MS = 10**6  # ticks


def clock(**more: object) -> Bus:
    return Bus(clock={"model": "isl12026", **more})


def unlocked(**more: object) -> Bus:
    bus = clock(**more)
    bus.do(WEL)
    bus.do(BOTH)
    return bus


def shown(bus: Bus, wait: int = 0) -> str:
    """The time registers, read after `wait` ticks."""
    bus.wait(wait)
    return bus.do(TIME).partition(" Sr 6f ")[2]


def test_it_counts_from_the_time_given_in_the_case():
    bus = clock(time="2012-02-29 23:59:58")
    assert shown(bus) == "58 59 a3 29 02 12 03 20"  # a Wednesday
    assert shown(bus, wait=SECOND) == "59 59 a3 29 02 12 03 20"
    assert shown(bus, wait=SECOND) == "00 00 80 01 03 12 04 20"


@pytest.mark.parametrize(
    ("time", "registers"),
    [("1900-01-01 00:00:00", "00 00 80 01 01 00 01 19"), ("2099-12-31 00:00:00", "00 00 80 31 12 99 04 20")],
)
def test_its_calendar_has_the_years_1900_to_2099(time: str, registers: str):
    assert shown(clock(time=time)) == registers


def test_its_crystal_can_be_fast():
    fast, exact = clock(time="2012-01-01 00:00:00", ppm=1000), clock(time="2012-01-01 00:00:00")
    fast.wait(SECOND - SECOND // 1000 + 1000)
    exact.wait(SECOND - SECOND // 1000 + 1000)
    assert (shown(fast)[:2], shown(exact)[:2]) == ("01", "00")


def test_its_crystal_is_exact_by_default():
    bus = clock(time="2012-01-01 00:00:00")
    assert shown(bus, wait=1000 * SECOND - MS // 2)[:5] == "39 16"  # addressed at most 0.5 ms before 00:16:40
    assert shown(bus, wait=MS)[:5] == "40 16"


def test_all_bytes_of_a_long_read_are_of_one_time():
    bus = Bus(
        clock={"model": "isl12026", "time": "2012-01-01 00:00:59", "stretch": {"length": "20 ms", "access": "read"}}
    )
    assert shown(bus, wait=SECOND - 50 * MS) == "59 00 80 01 01 12 00 20"
    assert shown(bus)[:5] == "00 01"


def test_its_time_is_set_by_eight_bytes_while_both_latches_are_set():
    bus = clock()
    assert bus.do("6f W 00 3f Sr 6f R 1").split()[-1] == "01"  # RTCF is set: the time was lost
    assert bus.do("6f W 00 30 50") == "6f 00 30 50!"
    bus.do(WEL)
    bus.do("6f W 00 30 50")
    bus.do(BOTH)
    bus.do("6f W 00 30 50 39 95 01 03 12 04 20")
    assert shown(bus) == "50 39 95 01 03 12 04 20"
    assert bus.do("6f W 00 3f Sr 6f R 1").split()[-1] == "06"
    assert bus.notes("clock") == [
        "a register was written before WEL was set; it is not acknowledged",
        "the write at 0x30 is ignored: RWEL is not set",
    ]


def test_a_write_of_one_register_keeps_the_others():
    bus = unlocked(time="2012-03-01 15:39:50")
    for at, value in (("37", "20"), ("35", "07"), ("34", "12"), ("33", "03"), ("31", "10"), ("30", "20")):
        bus.do(f"6f W 00 {at} {value}")
    assert shown(bus) == "20 10 95 03 12 07 04 20"


def test_zeros_clear_the_latches_and_only_the_right_sequence_sets_both():
    bus = unlocked()
    bus.do("6f W 00 3f 00")
    assert bus.do("6f W 00 30 50") == "6f 00 30 50!"
    bus.do(BOTH)
    bus.do("6f W 00 3f 40")
    assert bus.do("6f W 00 3f Sr 6f R 1").split()[-1] == "01"
    assert [text[:43] for text in bus.notes("clock")[1:]] == [
        "0x06 was written to the status register, wh",
        "0x40 was written to the status register, wh",
    ]


def test_a_write_of_nonvolatile_registers_takes_the_write_time_and_clears_rwel():
    bus = unlocked(write_time="2 ms")
    bus.do("6f W 00 0e aa bb cc")  # wraps within eight registers
    assert bus.do("6f W 00 0e") == "6f!"
    bus.wait(2 * MS)
    assert bus.do("6f W 00 0e Sr 6f R 2").split()[-2:] == ["aa", "bb"]
    assert bus.do("6f W 00 08 Sr 6f R 1").split()[-1] == "cc"
    assert bus.do("6f W 00 3f Sr 6f R 1").split()[-1] == "03"  # WEL and RTCF


def test_a_write_without_a_stop_has_no_effect():
    bus = unlocked(time="2012-03-01 15:39:50")
    bus.do("6f W 00 30 11 Sr 6f R 1")
    assert shown(bus)[:2] == "50"
    assert bus.notes("clock") == ["the write at 0x30 has no effect: a START instead of a STOP ended it"]


def test_an_hour_without_mil_is_read_as_12_hour_format():
    bus = unlocked(time="2012-03-01 15:39:50")
    bus.do("6f W 00 32 15")
    assert shown(bus)[:8] == "50 39 15"
    assert bus.notes("clock") == [
        "HR 0x15 is no hour of 12; bit 7, MIL, makes it one of 24; it does not count from there in this model"
    ]


@pytest.mark.parametrize(("battery", "after"), [(True, "01"), (False, "00")])
def test_a_battery_keeps_the_time_over_a_loss_of_power(battery: bool, after: str):
    fault = [{"kind": "off", "after": "0.5 s", "until": "0.7 s"}]
    bus = unlocked(time="2012-03-01 15:39:00", battery=battery, fault=fault)
    assert shown(bus, wait=SECOND + 10 * MS)[:2] == after
    assert bus.do("6f W 00 3f Sr 6f R 1").split()[-1] == ("00" if battery else "01")


def test_accesses_to_missing_registers_are_noted():
    bus = unlocked()
    bus.do("6f W 00 18 11")
    bus.do("6f W 00 38 11")
    bus.do("6f W 01 30")
    assert bus.notes("clock") == [
        "register 0x18 was written, which it does not have",
        "register 0x38 was written, which it does not have",
        "register 0x0130 was named; it has 0 to 0x3f",
    ]


def test_an_address_beyond_its_registers_is_taken_modulo_their_number():
    bus = unlocked()
    bus.do("6f W 01 45 aa")
    bus.wait(10 * MS)
    assert bus.do("6f W 00 05 Sr 6f R 1").split()[-1] == "aa"
    assert bus.do("6f W 02 05 Sr 6f R 1").split()[-1] == "aa"


def test_times_are_equal_after_conversion_to_registers_and_back():
    for hour in range(24):
        for whole_day in (True, False):
            time = CalendarTime(datetime(1999, 12, 31, hour, 59, 8), 6, whole_day)
            assert time_in(registers_of(time)) == time
    assert registers_of(CalendarTime(datetime(1999, 12, 31, 0, 5, 9), 6, False)).hex(" ") == "09 05 12 31 12 99 06 19"
    assert CalendarTime(datetime(1999, 12, 31, 23, 59, 59), 6, True).later(1) == (datetime(2000, 1, 1), 0, True)


@pytest.mark.parametrize(
    ("registers", "sentence"),
    [
        ("5a 39 95 01 03 12 04 20", "SC 0x5a is no number of two decimal digits"),
        ("50 39 95 30 02 12 04 20", "is no time: day is out of range"),
        ("50 39 95 01 03 12 07 20", "DW 0x07 is no day of the week"),
        ("50 39 13 01 03 12 04 20", "HR 0x13 is no hour of 12"),
    ],
)
def test_registers_without_a_valid_time_are_rejected(registers: str, sentence: str):
    with pytest.raises(BadTime, match=sentence):
        time_in(bytes.fromhex(registers))


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"time": "noon"}, "device.clock.time"),
        ({"time": "2012-03-01T15:39:50Z"}, "no time zone and whole seconds"),
        ({"time": "1899-12-31 23:59:59"}, "its calendar has the years 1900 to 2099"),
        ({"time": "2100-01-01 00:00:00"}, "its calendar has the years 1900 to 2099"),
        ({"address": 0x68}, "isl12026 has no address 0x68; it can have 0x6f"),
        ({"tiem": "2012-03-01 15:39:50"}, "a isl12026 has no such key"),
    ],
)
def test_invalid_settings_are_rejected_with_one_sentence(given: dict[str, object], sentence: str):
    with pytest.raises(BadCase, match=sentence) as error:
        clock(**given)
    assert "\n" not in str(error.value)
