"""Physical quantities and poses in the settings of motions: texts with units that are converted to numbers.

`Angle` converts "50 deg" to rad, `Rate` converts "52.2 rpm" to rad/s, and `Acceleration` converts "0.5 g" to g. A
number without a unit is an error in a case, because its unit would be a guess. Values beyond the range of a motion are
errors.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import inf, isfinite, pi
from operator import attrgetter
from typing import Annotated

from ...core.convert import Before
from ...core.exact_number import number_and_unit
from ...core.time import UNITS as TIMES

GRAVITY = 9.81  # m/s**2 in one g, as in the dissertation

ANGLE_UNITS = {"rad": 1.0, "deg": pi / 180, "mrad": 1e-3}
RATE_UNITS = {"rad/s": 1.0, "deg/s": pi / 180, "rpm": 2 * pi / 60}
ACCELERATION_UNITS = {"g": 1.0, "mg": 1e-3, "m/s^2": 1 / GRAVITY}
TIME_UNITS = {unit: float(length) for unit, length in TIMES.items()}
FREQUENCY_UNITS = {"Hz": 1.0, "mHz": 1e-3, "kHz": 1e3}

ANGLE_RANGE = 2 * pi  # maximum angle in rad, since recordings use -180 to 180 degrees, or 0 to 360 degrees
ACCELERATION_RANGE = 100.0  # maximum acceleration in g; far beyond the sensors' ranges and an airframe's strength
RATE_RANGE = 1000.0  # maximum rate in rad/s


def quantity(units: Mapping[str, float], least: float, most: float, value: object) -> float:
    """Parse a text such as "52.2 rpm" and convert it to the unit whose factor is 1.

    units: for each accepted unit, the factor that converts a number in this unit.
    least, most: the inclusive limits of the converted number.
    value: the text. A number is refused, because it has no unit.

    Raise ValueError, whose message says what is wrong, if the value is invalid.
    """
    example = " or ".join(units)
    if not isinstance(value, str):
        raise ValueError(f"{value!r} has no unit; write a number, a blank and {example}")
    digits, unit = number_and_unit(value)
    if unit not in units:
        raise ValueError(f"{value!r}: expected a number, a blank and {example}")
    try:
        number = float(Fraction(digits)) * units[unit]
    except (ValueError, ZeroDivisionError, OverflowError):
        raise ValueError(f"{value!r}: {digits!r} is not a number") from None
    if not isfinite(number) or not least <= number <= most:
        base = next(unit for unit, factor in units.items() if factor == 1)
        raise ValueError(f"{value!r}: expected {shown(most, base, least)}")
    return number


def shown(most: float, unit: str, least: float | None = None) -> str:
    """Format the range from `least` to `most`, or from -most to `most` if `least` is None.

    If `most` is infinite, only the lower limit is shown.
    """
    low = -most if least is None else least
    if most == inf:
        return f"{low:g} {unit} or more"
    return f"{low:.6g} to {most:.6g} {unit}"


def _validator(units: Mapping[str, float], least: float, most: float) -> Before:
    return Before(partial(quantity, units, least, most), str)


Angle = Annotated[float, _validator(ANGLE_UNITS, -ANGLE_RANGE, ANGLE_RANGE)]
Rate = Annotated[float, _validator(RATE_UNITS, 1e-6, RATE_RANGE)]
Acceleration = Annotated[float, _validator(ACCELERATION_UNITS, -ACCELERATION_RANGE, ACCELERATION_RANGE)]
Seconds = Annotated[float, _validator(TIME_UNITS, 0.0, inf)]
Hertz = Annotated[float, _validator(FREQUENCY_UNITS, 0.0, 1e6)]


@dataclass(frozen=True)
class Pose:
    """The six values of a motion at one time: attitude in rad, linear acceleration in g."""

    phi: Angle = 0.0
    theta: Angle = 0.0
    psi: Angle = 0.0
    ax: Acceleration = 0.0
    ay: Acceleration = 0.0
    az: Acceleration = 0.0


LEVEL = Pose()  # level, pointing north, at rest


six_values = attrgetter("phi", "theta", "psi", "ax", "ay", "az")  # reads the attributes in the order of a host frame
