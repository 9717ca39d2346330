"""Conversion between a time and the eight BCD registers of a calendar clock: SC MN HR DT MO YR DW Y2K.

    50 39 95 01 03 12 04 20  =  15:39:50 of 24 hours, 2012-03-01, the fourth day of the week

HR has bit 7, MIL, for 24 hours; else bit 5 is pm, and 12 comes before 1.

Source: Renesas FN8231, clock/calendar registers.
"""

from __future__ import annotations

from datetime import datetime, timedelta
from typing import NamedTuple

MIL, PM = 0x80, 0x20


class BadTime(ValueError):
    """Registers that contain no valid time; the message is one sentence."""


class CalendarTime(NamedTuple):
    """weekday: 0 to 6, with an arbitrary day 0. whole_day: 24-hour format."""

    at: datetime
    weekday: int
    whole_day: bool

    def later(self, seconds: int) -> CalendarTime:
        """Return the time `seconds` later."""
        at = self.at + timedelta(seconds=seconds)
        days = at.date().toordinal() - self.at.date().toordinal()
        return CalendarTime(at, (self.weekday + days) % 7, self.whole_day)


def registers_of(time: CalendarTime) -> bytes:
    """Return the registers from SC to Y2K."""
    at = time.at
    hour = _bcd(at.hour) | MIL if time.whole_day else _bcd((at.hour - 1) % 12 + 1) | PM * (at.hour >= 12)
    date = (_bcd(at.day), _bcd(at.month), _bcd(at.year % 100))
    return bytes([_bcd(at.second), _bcd(at.minute), hour, *date, time.weekday, _bcd(at.year // 100)])


def time_in(registers: bytes) -> CalendarTime:
    """Return the time in eight registers. BadTime if they contain none."""
    second, minute, hour, day, month, year, weekday, century = registers
    whole_day = bool(hour & MIL)
    hours = _number("HR", hour & ~(MIL if whole_day else PM))
    if not whole_day:
        if not 1 <= hours <= 12:
            raise BadTime(f"HR {hour:#04x} is no hour of 12; bit 7, MIL, makes it one of 24")
        hours = hours % 12 + 12 * bool(hour & PM)
    years = 100 * _number("Y2K", century) + _number("YR", year)
    date = years, _number("MO", month), _number("DT", day)
    try:
        at = datetime(*date, hours, _number("MN", minute), _number("SC", second))
    except BadTime:
        raise
    except ValueError as error:
        raise BadTime(f"{registers.hex(' ')} is no time: {error}") from None
    if weekday > 6:
        raise BadTime(f"DW {weekday:#04x} is no day of the week, 0 to 6")
    return CalendarTime(at, weekday, whole_day)


def _bcd(number: int) -> int:
    return number // 10 << 4 | number % 10


def _number(name: str, bcd: int) -> int:
    if bcd >> 4 > 9 or bcd & 0xF > 9:
        raise BadTime(f"{name} {bcd:#04x} is no number of two decimal digits")
    return 10 * (bcd >> 4) + (bcd & 0xF)
