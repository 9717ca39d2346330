"""A real-time clock with two-byte register addresses, ISL12026 or X1226: its time and control registers.

    START, 0x6F+W, 00 3f 02, STOP       sets WEL: without it, writes of other registers are not acknowledged
    START, 0x6F+W, 00 3f 06, STOP       sets RWEL: without it, writes of other registers are ignored
    START, 0x6F+W, 00 30, SC MN HR DT MO YR DW Y2K, STOP     the time, from the STOP on
    START, 0x6F+W, 00 30, START, 0x6F+R, SC MN ...           the time as it was when the read began

The alarm and control registers, 0x00 to 0x17, are non-volatile. After a write of these registers, the device does not
acknowledge its address for `write_time`, and RWEL becomes 0. These registers are stored, but have no effect. A write
wraps around in a group of eight registers; a read wraps from 0x3F to 0. The EEPROM that these chips have at address
0x57 is not part of this model.

Source: Renesas FN8231 (ISL12026), FN8098 (X1226): clock/control registers, status register, page write.
"""

from __future__ import annotations

from datetime import datetime, timedelta
from typing import Annotated, NamedTuple

from msgspec import Meta

from ...core.convert import After
from ...core.registers import NamedByte, RegisterMap, byte_register
from ...core.state import State
from ...core.table import DurationRange, Spread, Table, duration
from . import BadDevice, PlainReply, TargetContext, address_among

__all__ = ["MODELS", "Settings", "build"]

# Bits of HR. MIL selects the 24-hour format. PM is the afternoon in the 12-hour format, whose hours are 12, 1, 2 to 11.
MIL, PM = 0x80, 0x20


class BadTime(ValueError):
    """Error: the registers contain no valid time. The message is one sentence."""


class CalendarTime(NamedTuple):
    """The time that a clock chip shows.

    at: date and time.
    weekday: 0 to 6. The chip does not define which day is 0.
    whole_day: True in the 24-hour format.
    """

    at: datetime
    weekday: int
    whole_day: bool

    def later(self, seconds: int) -> CalendarTime:
        """Return the time that is `seconds` later."""
        at = self.at + timedelta(seconds=seconds)
        days = at.date().toordinal() - self.at.date().toordinal()
        return CalendarTime(at, (self.weekday + days) % 7, self.whole_day)


def registers_of(time: CalendarTime) -> bytes:
    """Return a time as the BCD registers SC MN HR DT MO YR DW Y2K.

    50 39 95 01 03 12 04 20  =  15:39:50 of 24 hours, 2012-03-01, the fourth day of the week
    """
    at = time.at
    hour = _bcd(at.hour) | MIL if time.whole_day else _bcd((at.hour - 1) % 12 + 1) | PM * (at.hour >= 12)
    date = (_bcd(at.day), _bcd(at.month), _bcd(at.year % 100))
    return bytes([_bcd(at.second), _bcd(at.minute), hour, *date, time.weekday, _bcd(at.year // 100)])


def time_in(registers: bytes) -> CalendarTime:
    """Return the time in the registers SC MN HR DT MO YR DW Y2K. Raise BadTime if they contain no valid time."""
    second, minute, hour, day, month, year, weekday, century = registers
    whole_day = bool(hour & MIL)
    hours = _number("HR", hour & ~(MIL if whole_day else PM))
    if not whole_day:
        if not 1 <= hours <= 12:
            raise BadTime(f"HR {hour:#04x} is no hour of 12; bit 7, MIL, makes it one of 24")
        hours = hours % 12 + 12 * bool(hour & PM)
    years = 100 * _number("Y2K", century) + _number("YR", year)
    date = years, _number("MO", month), _number("DT", day)
    time = hours, _number("MN", minute), _number("SC", second)
    try:
        at = datetime(*date, *time)
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


MODELS = ("isl12026", "x1226")
ADDRESS = 0x6F
SIZE, PAGE = 0x40, 8
CLOCK, STORED, STATUS = range(0x30, 0x38), range(0x18), 0x3F
RTCF, WEL, RWEL = 1, 2, 4  # bits of the status register
NAMES = ("SC", "MN", "HR", "DT", "MO", "YR", "DW", "Y2K")
SECTION = "FN8231 clock/control memory map"
HOUR, LATCHES = (("MIL", "7"), ("H", "5:0")), (("RWEL", "2"), ("WEL", "1"), ("RTCF", "0"))
MAP = RegisterMap(
    "ISL12026",
    SECTION,
    (
        *(
            byte_register(at, name, "R/W", 0, SECTION, HOUR if name == "HR" else ())
            for at, name in zip(CLOCK, NAMES, strict=True)
        ),
        byte_register(STATUS, "SR", "R/W", 0, SECTION, LATCHES),
    ),
)
DIRECTIVE = "FN8231, writing to the clock/control registers"
SECONDS_PER_PPM = 1_000_000


def _plain(value: datetime | None) -> datetime | None:
    if value is not None and (value.tzinfo is not None or value.microsecond):
        raise ValueError("the time of a clock has no time zone and whole seconds")
    return value


class Settings(Table, frozen=True, kw_only=True):
    """A real-time clock with two-byte register addresses.

    time: initial time, `2012-02-29 23:59:58`; without it the clock is stopped and RTCF is set
    ppm: crystal error, parts per million
    battery: the clock runs on without supply
    write_time: duration of a nonvolatile write
    """

    time: Annotated[datetime | None, After(_plain)] = None
    ppm: Annotated[int, Meta(ge=-1000, le=1000)] = 0
    battery: bool = True
    write_time: DurationRange = Spread(duration("10 ms"), duration("10 ms"))


class Rtc(PlainReply):
    """The clock on the bus. `answer` returns this object itself as the reply."""

    STATE = State(
        "_place _stored _raw _why_none _running _failed _latches _pointer _begin _buffer _shown",
        ticks="_busy_until",
    )

    def __init__(self, settings: Settings, place: TargetContext, address: int) -> None:
        self.addresses = (address,)
        self.pointer_bytes = 2
        self._settings = settings
        self._place = place
        self._second = place.ticks(duration("1 s")) * SECONDS_PER_PPM // (SECONDS_PER_PPM + settings.ppm)
        self._stored = bytearray(SIZE)
        self._raw = bytes(len(CLOCK))  # contents of the time registers while the clock is stopped
        self._why_none = ""  # why the time that was written last is invalid; otherwise ""
        # A time, and the tick at which the clock had this time; None while the clock is stopped.
        self._running: tuple[CalendarTime, int] | None = None
        self._failed = settings.time is None
        if settings.time is not None:
            weekday = (settings.time.weekday() + 1) % 7  # Sunday is 0
            self._running = CalendarTime(settings.time, weekday, whole_day=True), place.start
        self._forget()

    def _forget(self) -> None:
        """Clear the state that is lost without supply, even with a battery."""
        self._latches = 0
        self._pointer = 0
        self._begin: int  # first register of the present write
        self._buffer: dict[int, int] = {}
        self._shown: bytes  # time registers, as latched when the device was addressed
        self._busy_until = 0

    def power_on(self) -> None:
        self._forget()
        if not self._settings.battery:
            self._running, self._failed, self._raw, self._why_none = None, True, bytes(len(CLOCK)), ""

    # Transfers ---------------------------------------------------------------------

    def answer(self, address_byte: int) -> Rtc | None:
        if address_byte >> 1 not in self.addresses or self._place.kernel.now < self._busy_until:
            return None
        self._shown = self._clock()
        if address_byte & 1 and self._why_none:
            self._place.duty(f"{self._why_none}; it does not count from there in this model", DIRECTIVE)
        return self

    def named(self, value: int, before: int | None) -> NamedByte:
        register = MAP.at(self._pointer)
        return NamedByte(f"{self._pointer:#06x}") if register is None else register.named(value)

    def send_byte(self, byte: int) -> int:
        at, self._pointer = self._pointer, (self._pointer + 1) % SIZE
        if at == STATUS:
            return self._latches | self._failed * RTCF
        return self._shown[at - CLOCK.start] if at in CLOCK else self._stored[at]

    def receive_byte(self, byte: int, value: int) -> bool:
        if byte < 2:
            self._pointer = (0 if byte == 0 else self._pointer << 8) | value
            if byte == 1:
                if self._pointer >= SIZE:
                    self._place.duty(f"register {self._pointer:#06x} was named; it has 0 to {SIZE - 1:#04x}", DIRECTIVE)
                    self._pointer %= SIZE
                self._begin = self._pointer
            return True
        if self._pointer != STATUS and not self._latches & WEL:
            self._place.duty("a register was written before WEL was set; it is not acknowledged", DIRECTIVE)
            return False
        self._buffer[self._pointer] = value
        page = self._pointer & -PAGE
        self._pointer = page | self._pointer + 1 & PAGE - 1
        return True

    def on_end(self, stop: bool, whole: bool) -> None:
        buffer, self._buffer = self._buffer, {}
        if not buffer:
            return
        if not stop or not whole:
            how = "a STOP in the middle of a byte" if stop else "a START instead of a STOP"
            self._place.duty(f"the write at {self._begin:#04x} has no effect: {how} ended it", DIRECTIVE)
        elif STATUS in buffer:
            self._unlock(buffer[STATUS])
        elif not self._latches & RWEL:
            self._place.duty(f"the write at {self._begin:#04x} is ignored: RWEL is not set", DIRECTIVE)
        else:
            self._write(buffer)

    def _unlock(self, value: int) -> None:
        """Apply a write of the status register.

        0x02 sets WEL, 0x06 sets RWEL if WEL is already set, and 0 clears both. Any other write only adds a note.
        """
        if value == WEL | RWEL and self._latches & WEL:
            self._latches = WEL | RWEL
        elif value in (0, WEL):
            self._latches = value and self._latches | WEL
        else:
            problem = "sets RWEL before WEL" if value == WEL | RWEL else "is none of 0x00, 0x02 and 0x06"
            self._place.duty(f"{value:#04x} was written to the status register, which {problem}", DIRECTIVE)

    def _write(self, buffer: dict[int, int]) -> None:
        place = self._place
        clock = {at: value for at, value in buffer.items() if at in CLOCK}
        if clock:
            self._set(clock)
        stored = {at: value for at, value in buffer.items() if at in STORED}
        if stored:
            for at, value in stored.items():
                self._stored[at] = value
            self._latches &= ~RWEL
            least, most = (
                place.ticks(end) for end in (self._settings.write_time.least, self._settings.write_time.most)
            )
            self._busy_until = place.kernel.now + place.random.randint(least, most)
        if not clock and not stored:
            self._place.duty(f"register {self._begin:#04x} was written, which it does not have", DIRECTIVE)

    # The time ------------------------------------------------------------------------

    def _clock(self) -> bytes:
        """Return the eight registers of the present time."""
        if self._running is None:
            return self._raw
        time, since = self._running
        return registers_of(time.later((self._place.kernel.now - since) // self._second))

    def _set(self, written: dict[int, int]) -> None:
        """Write these time registers. The other time registers keep their present values.

        If the registers then contain no valid time, the clock stops.
        """
        registers = bytearray(self._clock())
        for at, value in written.items():
            registers[at - CLOCK.start] = value
        self._failed, self._why_none = False, ""
        try:
            self._running = time_in(bytes(registers)), self._place.kernel.now
        except BadTime as error:
            self._raw, self._running, self._why_none = bytes(registers), None, str(error)


def build(model: str, settings: Settings, place: TargetContext) -> Rtc:
    if settings.time is not None and not 1900 <= settings.time.year <= 2099:
        raise BadDevice("its calendar has the years 1900 to 2099", "time")
    return Rtc(settings, place, address_among(place, model, (ADDRESS,)))
