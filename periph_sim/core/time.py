"""Time as a whole number of ticks, with exact conversion of seconds and clock cycles.

The tick rate is the LCM of 1 GHz and all clocks whose cycles must be whole ticks: with SYSCLKOUT at 150 MHz a tick is
1/3 ns and a cycle 20 ticks. For other clocks (a crystal with a ppm error, a 24 MHz logic analyser), the exact time of
the n-th edge is rounded down to a tick, so rounding errors do not add up.
"""

# core: compiled

from __future__ import annotations

from fractions import Fraction
from math import floor, lcm
from typing import Literal, final

from ..form.c_types import BigInt, Text
from .chip import NEVER
from .exact_number import SHOWN, exact_number, number_and_unit, unknown_unit
from .phrases import shorten
from .state import State

GHZ = 1_000_000_000
NO_TIME = -1
LAST_TICK = NEVER - 1  # the last valid tick, also in recordings, whose ticks are int64
DAY = 86_400
LONGEST = 365_250 * DAY  # maximum length of time, in seconds, that a user can write: 1000 years
MOST = NEVER  # maximum product that compiled code may compute, because its integers have 64 bits
# If a nanosecond has more ticks than this, messages about times that are too long suggest a crystal of a round
# frequency, because it makes ticks longer.
USUAL_PER_NS = 1000

UNITS: dict[str, Fraction] = {
    "ns": Fraction(1, GHZ),
    "us": Fraction(1, 1_000_000),
    "ms": Fraction(1, 1000),
    "s": Fraction(1),
    "min": Fraction(60),
    "h": Fraction(3600),
    "d": Fraction(86400),
}

Rounding = Literal["exact", "down", "up", "nearest"]


class TimeError(ValueError):
    """Error: a text is not a time, a time is too long or not a whole number of ticks, or a frequency is invalid."""


def round_ratio(value: Fraction, rounding: Rounding) -> BigInt:
    """Return `value` rounded to a whole number. Raise TimeError if `rounding` is "exact" and `value` is not whole."""
    if value.denominator == 1:
        return value.numerator
    if rounding == "down":
        return value.numerator // value.denominator
    if rounding == "up":
        return -(-value.numerator // value.denominator)
    if rounding == "nearest":
        return (2 * value.numerator + value.denominator) // (2 * value.denominator)
    raise TimeError(f"{value} is not a whole number; choose a rounding: down, up or nearest")


def seconds(text: Text) -> Fraction:
    """Return the exact seconds in "250 us" or "1.5 ms". Raise TimeError if it is not a length of time, or too long."""
    quoted = shorten(repr(text), SHOWN)
    number, unit = number_and_unit(text.replace("\u00b5", "u").replace("\u03bc", "u"))  # micro sign, letter mu
    if not unit:
        written = shorten(text.strip() or "20", SHOWN)
        raise TimeError(f"{quoted} has no unit; write for instance {written} ms ({', '.join(UNITS)})")
    if unit not in UNITS:
        if not any(map(str.isdigit, number)):
            raise TimeError(f"{quoted} is no length of time; write for instance 20 ms ({', '.join(UNITS)})")
        raise TimeError(f"{quoted}: {unknown_unit(number, unit, UNITS)}")
    try:
        length = exact_number(number) * UNITS[unit]
    except ValueError as error:
        raise TimeError(f"{quoted}: {error}") from None
    if abs(length) > LONGEST:
        raise TimeError(f"{quoted} is longer than {LONGEST // DAY} d, the longest time that can be given")
    return length


class Timebase:  # core: python
    """The length of a tick. per_second: number of ticks in a second. per_ns: number of ticks in a nanosecond."""

    STATE = State("per_second per_ns", made=True)

    def __init__(self, *clocks_hz: int) -> None:
        self.per_second = lcm(GHZ, *clocks_hz)
        self.per_ns = self.per_second // GHZ

    def ticks(self, length: Fraction | str, rounding: Rounding = "exact") -> int:
        """Return a length of time, in seconds or as text with a unit, in ticks.

        Raise TimeError if a text is no length of time, if the length is too long, or if the number of ticks is not
        whole and `rounding` is "exact".
        """
        value = seconds(length) if isinstance(length, str) else length
        return self.fitting(round_ratio(value * self.per_second, rounding))

    def fitting(self, ticks: int) -> int:
        """Return a length of time in ticks unchanged. Raise TimeError if it is longer than LAST_TICK."""
        if abs(ticks) > LAST_TICK:
            length, most = days(self.seconds(ticks)), days(self.seconds(LAST_TICK))
            ticks_are = f"with ticks of 1/{self.per_second} s the longest is {most}{self._way_out}"
            raise TimeError(f"a time of {length} is too long: {ticks_are}")
        return ticks

    def end_of_run(self, start: int, length: Fraction) -> int:
        """Return the tick at which a run of `length` seconds ends. Raise TimeError if this tick is after LAST_TICK."""
        end = start + round_ratio(length * self.per_second, "nearest")
        if end > LAST_TICK:
            most = self.seconds(LAST_TICK - start)
            raise TimeError(
                f"a run of {days(length)} ends after the last tick, number 2^62; with ticks of 1/{self.per_second} s "
                f"the longest is {days(most)}{self._way_out}"
            )
        return end

    @property
    def _way_out(self) -> str:
        if self.per_ns <= USUAL_PER_NS:
            return ""
        return "; a crystal of a round frequency, its error as ppm, has longer ticks"

    def seconds(self, ticks: int) -> Fraction:
        """Return ticks in seconds, exactly."""
        return Fraction(ticks, self.per_second)

    def show(self, ticks: int) -> str:
        """Return ticks as text: below 10 ms in us and below 10 s in ms, with three decimals; else in s, with six."""
        us = Fraction(ticks * 1_000_000, self.per_second)
        if abs(us) < 10_000:
            return f"{float(us):.3f} us"
        return f"{float(us / 1000):.3f} ms" if abs(us) < 10_000_000 else f"{float(us / 1_000_000):.6f} s"


def days(length: Fraction) -> str:
    """Return a length of time as text for messages: in days, or in seconds if the length is below one day.

    Numbers below 100,000 are rounded down to a tenth. Others are rounded to three significant digits.
    """
    value, unit = (length / DAY, "d") if length >= DAY else (length, "s")
    return f"{float(Fraction(floor(value * 10), 10)):g} {unit}" if value < 100_000 else f"{float(value):.3g} {unit}"


@final
class Clock:
    """The cycles of one clock in ticks: cycle n begins at tick(n).

    hz may be any positive rational number. `retune` changes it from a given cycle on. That cycle keeps its tick, so
    cycle counts do not jump. `tick` and `cycle_at` are valid for times after the last `retune`.
    """

    STATE = State(
        "timebase hz _num _den _exact _wide _near",
        ticks="_tick0 _last_tick",
        cycles="_cycle0 _last_cycle",
        made=True,
    )

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Return the values that are compared in place of attributes; see `proof.normal_state`.

        If a cycle is a whole number of ticks, the time from the start of a cycle to `tick` replaces all instants.
        Otherwise no attribute is replaced.
        """
        if self._den != 1:
            return {}
        return {"_tick0": (tick - self._tick0) % self._num, **dict.fromkeys(["_cycle0", "_last_tick", "_last_cycle"])}

    hz: Fraction
    _wide: bool
    _num: int
    _den: int
    _near: int

    def __init__(self, timebase: Timebase, hz: Fraction | int, *, tick0: int = 0, cycle0: int = 0) -> None:
        self.timebase = timebase
        self.hz = Fraction(hz)
        self._tick0 = tick0
        self._cycle0 = cycle0
        self._num, self._den = self._period(self.hz)
        self._last_cycle, self._last_tick = cycle0, tick0  # cache of the last result, which is often needed again

    def _period(self, hz: Fraction) -> tuple[int, int]:
        if hz <= 0:
            raise TimeError(f"a clock cannot have {hz} Hz; its frequency must be above 0")
        period = self.timebase.per_second / hz
        self._exact = period.numerator, period.denominator
        self._wide = period < 1 or period.numerator * period.denominator > MOST
        self._near = MOST // max(self._exact)  # n * `_num` and n * `_den` fit 64 bits for each n below `_near`
        return (0, 0) if self._wide else self._exact

    def tick(self, cycle: int) -> int:
        """Return the tick at which this cycle begins, rounded down if it is between two ticks."""
        passed, den = cycle - self._cycle0, self._den
        if den == 1:
            return self._tick0 + passed * self._num
        if self._wide:
            return self._tick0 + self._wide_ticks(passed)
        if cycle != self._last_cycle:
            self._last_cycle = cycle
            if -self._near < passed < self._near:
                self._last_tick = self._tick0 + passed * self._num // den
            else:
                whole = passed // den  # divide first, because the product could exceed 64 bits in a long run
                self._last_tick = self._tick0 + whole * self._num + (passed - whole * den) * self._num // den
        return self._last_tick

    def cycle_at(self, tick: int) -> int:
        """Return the first cycle that begins at or after this tick.

        An input without a synchroniser that changes at this tick is sampled in this cycle.
        """
        left, num = self._tick0 - tick, self._num
        if self._den == 1:
            return self._cycle0 - left // num
        if self._wide:
            return self._cycle0 - self._wide_cycles(left)
        if tick == self._last_tick:
            return self._last_cycle
        if -self._near < left < self._near:
            return self._cycle0 - left * self._den // num
        whole = left // num
        return self._cycle0 - whole * self._den - (left - whole * num) * self._den // num

    def _wide_ticks(self, cycles: BigInt) -> BigInt:
        """Return the length of some cycles in ticks, computed with Python's integers: products may exceed 64 bits."""
        num, den = self._exact
        return cycles * num // den

    def _wide_cycles(self, ticks: BigInt) -> BigInt:
        num, den = self._exact
        return ticks * den // num

    def cycle_after(self, tick: int) -> int:
        """Return the first cycle that begins after this tick.

        An input with a synchroniser that changes at this tick is sampled in this cycle.
        """
        return self.cycle_at(tick + 1)

    def retune(self, cycle: int, hz: Fraction | int) -> None:
        """Set the frequency to `hz` from `cycle` on."""
        self._tick0 = self._last_tick = self.tick(cycle)
        self._cycle0 = self._last_cycle = cycle
        self.hz = Fraction(hz)
        self._num, self._den = self._period(self.hz)
