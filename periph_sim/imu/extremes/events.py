"""Extremes that are not sweeps: lost frames, runs of weeks, divisions by 0, rejected parameters, small steps.

Each function in `EVENTS` of the package examines one extreme in each arithmetic (float32, a Q format ...) in `names`,
and yields its findings; those of `refused` do not depend on the arithmetic. The argument `worst` has the largest errors
of each arithmetic in the working range, by the name of the arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import inf, nan
from typing import Any

import numpy as np

from ..host_frame import ACCELERATION, ANGLE
from ..models.parameters import AccelerometerParameters, GyroscopeParameters, ImuParameters, MagnetometerParameters
from ..models.quantity import BadParameter
from ..numeric import arithmetic_names as named
from ..numeric.arithmetic import Arithmetic
from ..numeric.q import Q
from .frames import REFERENCE, Ints, codes_of
from .sweep import EVERY, ExtremeFinding, Happens, overflow_of
from .working_range import Worst

DAY = 86_400.0
MONTH = 30 * DAY
ROLL = 0  # the row of the gyroscope's x axis among the nine codes


def first_where(holds: Callable[[float], bool], low: float, high: float) -> float | None:
    """Return the smallest value from `low` to `high` for which `holds` is true; None if `holds` is false at `high`.

    The value is found by 48 bisections, so `holds` must be false below the value and true above.
    """
    if not holds(high):
        return None
    for _ in range(48):
        middle = (low + high) / 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def lost_frames(names: tuple[str, ...], worst: dict[str, Worst]) -> Iterator[ExtremeFinding]:
    """Examine a lost or doubled frame during a steady rotation.

    One sample then contains no change of the angle, and another sample contains twice the usual change. The sum of both
    samples is right, unless the double change exceeds the range of the converter.
    """
    rates = np.arange(1, 2001)
    steps = np.rint(np.radians(rates) * ImuParameters().period / ANGLE).astype(np.int64)
    none, once, twice = (_rolled(steps, k) for k in (0, 1, 2))
    for name in names:
        imu = ImuParameters()
        double = codes_of(name, imu, twice)
        sums = codes_of(name, imu, none).codes[ROLL] + double.codes[ROLL]
        meant = 2 * codes_of(REFERENCE, imu, once).codes[ROLL]
        off = np.abs(sums - meant)
        allowed = 2 * (1 if name == REFERENCE else worst[name].allowed()[ROLL])
        lost = np.flatnonzero(off > allowed)
        happens: Happens = "agrees"
        if len(lost):
            happens = overflow_of(name) if double.overflown[lost[0]] else "full scale"
        begins = float(rates[lost[0]]) if len(lost) else None
        yield ExtremeFinding("lost or doubled frame", name, happens, begins, "deg/s", float(off.max()))


def _rolled(steps: Ints, times: int) -> Ints:
    """Return the counts of n bodies that are at rest and then roll within one sample, int64[12, n] (see `frames`).

    Body k rolls by `times` * steps[k]. steps: an angle in counts for each body, int64[n].
    """
    counts = np.zeros((12, len(steps)), dtype=np.int64)
    counts[0] = counts[3] = -(times * steps) // 2
    counts[6] = counts[0] + times * steps
    return counts


def weeks(names: tuple[str, ...], worst: dict[str, Worst]) -> Iterator[ExtremeFinding]:
    """Examine a program that counts the time in seconds for 30 days, by adding Ts at every sample.

    In a Q format whose largest number is less than 30 days, the time ends at this number.

    Find the first time at which this addition has an error of more than half of Ts, and the first time at which it has
    no effect. The sensor models are not affected: they store no time and no sum, only the last attitude and body rates.
    """
    period = ImuParameters().period
    for name in names:
        a = named.scalar(name)
        end = min(MONTH, 2.0 ** (31 - a.bits) - 2.0**-a.bits) if isinstance(a, Q) else MONTH
        begins = _first_time(a, end, lambda grown: abs(grown - period) > period / 2)
        halts = _first_time(a, end, lambda grown: grown == 0)
        happens: Happens = "agrees"
        if begins is not None:
            happens = overflow_of(name) if isinstance(a, Q) else "off"
        note = f"{(float(a.value(a.constant(period))) / period - 1) * DAY:+.3g} s a day"
        if halts is not None:
            note += f", halts at {halts / 3600:.4g} h"
        yield ExtremeFinding(
            "time in seconds, 30 days", name, happens, None if begins is None else begins / 3600, "h", note=note
        )


def _first_time(a: Arithmetic[Any], end: float, holds: Callable[[float], bool]) -> float | None:
    """Return the first time in seconds at which adding Ts changes the time by an amount for which `holds` is true.

    Return None if there is no such time from 1 s to `end`.
    """
    step = a.constant(ImuParameters().period)

    def at(seconds: float) -> bool:
        with np.errstate(all="ignore"):
            before = a.constant(seconds)
            return holds(float(a.value(a.add(before, step)) - a.value(before)))

    return first_where(at, 1.0, end)


def zero_period(names: tuple[str, ...], worst: dict[str, Worst]) -> Iterator[ExtremeFinding]:
    """Examine the division of an angle's change by a Ts of 0, for a change of one count and for no change."""
    for name in names:
        a = named.scalar(name)
        with np.errstate(all="ignore"):
            step, zero = a.constant(ANGLE), a.constant(0.0)
            moved, still = (float(a.value(a.div(x, zero))) for x in (step, zero))
        happens: Happens = "NaN" if moved != moved or still != still else "saturates"
        yield ExtremeFinding("division by Ts = 0", name, happens, 0.0, "s", note=f"a step: {moved:g}, none: {still:g}")


def refused(names: tuple[str, ...], worst: dict[str, Worst]) -> Iterator[ExtremeFinding]:
    """Yield a finding for a Ts of 0 and for several non-finite parameters: each must be refused."""
    tried: tuple[tuple[str, Callable[[], object]], ...] = (
        ("Ts = 0", lambda: ImuParameters(period=0.0)),
        ("Ts infinite", lambda: ImuParameters(period=inf)),
        ("bias NaN", lambda: GyroscopeParameters(bias=(0.0, nan, 0.0))),
        ("scale infinite", lambda: AccelerometerParameters(scale=inf)),
        ("field NaN", lambda: MagnetometerParameters(earth_field=(nan, 0.0, 0.0))),
    )
    for what, make in tried:
        yield refusal(f"parameter: {what}", why_refused(make, BadParameter))


def refusal(extreme: str, message: str) -> ExtremeFinding:
    """Return the finding for an input that must be refused. message: the message of the error; "" for no error."""
    return ExtremeFinding(extreme, EVERY, "refused" if message else "agrees", None, "", note=message or "it passed")


def why_refused(tried: Callable[[], object], error: type[Exception]) -> str:
    """Call `tried` and return the message of the expected error; "" if this error is not raised."""
    try:
        tried()
    except error as raised:
        return str(raised)
    return ""


def smallest_steps(names: tuple[str, ...], worst: dict[str, Worst]) -> Iterator[ExtremeFinding]:
    """Examine the resolution.

    Count the accelerometer's codes that never occur while the acceleration rises count by count. Calculate the change
    of the gyroscope's roll rate, in LSB, that is caused by one count of roll.
    """
    g = int(AccelerometerParameters().full_scale / ACCELERATION)
    ramp = np.zeros((12, 2 * g + 1), dtype=np.int64)
    ramp[9] = np.arange(-g, g + 1)
    seen = len(np.unique(codes_of(REFERENCE, ImuParameters(), ramp).codes[3]))
    turn = np.zeros((12, 1), dtype=np.int64)
    turn[6] = 1
    for name in names:
        missing = seen - len(np.unique(codes_of(name, ImuParameters(), ramp).codes[3]))
        turned, still = (codes_of(name, ImuParameters(), counts).exact[ROLL] for counts in (turn, 0 * turn))
        step = float((turned - still)[0])
        note = f"{missing} of {seen} accelerometer codes never shown; one count of roll is {step:.2f} LSB of rate"
        happens: Happens = "agrees" if missing <= 0 and step > 0 else "off"
        yield ExtremeFinding("smallest LSB", name, happens, None, "", note=note)
