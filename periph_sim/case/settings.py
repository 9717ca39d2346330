"""Types for settings in case files and firmware: texts with units go in, exact numbers come out.

`Duration` takes "250 us" and gives seconds as an exact fraction; a bare number is refused,
since its unit would be a guess. `Frequency` takes "100 kHz". `HexBytes` takes "1d 00 ff".
"""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

from pydantic import BeforeValidator, PlainSerializer

from ..core.time import TimeError, seconds

HERTZ = {"Hz": 1, "kHz": 1_000, "MHz": 1_000_000, "GHz": 1_000_000_000}


def duration(value: object) -> Fraction:
    """Seconds. ValueError with the way out when the unit is missing or unknown, or the time is negative."""
    if isinstance(value, Fraction):
        return value
    if not isinstance(value, str):
        raise ValueError(f'{value!r} has no unit; write for instance "{value} ms"')
    try:
        length = seconds(value)
    except TimeError as error:
        raise ValueError(str(error)) from None
    if length < 0:
        raise ValueError(f"{value!r} is negative; a duration is 0 or more")
    return length


def frequency(value: object) -> Fraction:
    """Hertz. ValueError with the way out when the unit is missing or unknown."""
    if isinstance(value, Fraction):
        return value
    if not isinstance(value, str):
        raise ValueError(f'{value!r} has no unit; write for instance "{value} kHz"')
    number, _, unit = value.strip().partition(" ")
    if unit not in HERTZ:
        raise ValueError(f"{value!r}: expected a number, a blank and one of {', '.join(HERTZ)}")
    try:
        hertz = Fraction(number) * HERTZ[unit]
    except (ValueError, ZeroDivisionError):
        raise ValueError(f"{value!r}: {number!r} is not a number") from None
    if hertz <= 0:
        raise ValueError(f"{value!r}: a frequency is above 0")
    return hertz


def hex_bytes(value: object) -> bytes:
    """Bytes from "1d 00 ff" or a list of numbers 0 to 255."""
    if isinstance(value, bytes):
        return value
    try:
        if isinstance(value, str):
            return bytes.fromhex(value)
        if isinstance(value, list) and all(type(v) is int for v in value):
            return bytes(value)
    except ValueError:
        pass
    raise ValueError(f'{value!r} are no bytes; write for instance "1d 00 ff"')


Duration = Annotated[Fraction, BeforeValidator(duration), PlainSerializer(str)]
Frequency = Annotated[Fraction, BeforeValidator(frequency), PlainSerializer(str)]
HexBytes = Annotated[bytes, BeforeValidator(hex_bytes), PlainSerializer(lambda b: b.hex(" "))]
