"""Types of values in case files: numbers, lengths of time, addresses and rates, with their limits."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated

from msgspec import Meta

from ...core.convert import After, Before
from ...core.exact_number import exact_number
from ...core.options import Value
from ...core.table import FREQUENCY_TEXT, Duration, Frequency, frequency


def _exact(value: object) -> Fraction:
    if isinstance(value, bool) or not isinstance(value, int | float | str | Fraction):
        raise ValueError(f"{value!r} is not a number")
    return value if isinstance(value, Fraction) else exact_number(str(value))


def _above_zero(value: Fraction) -> Fraction:
    if value <= 0:
        raise ValueError("it must be longer than 0")
    return value


def _scalar(value: object) -> object:
    if not isinstance(value, str | int):
        raise ValueError("expected a text, a whole number, true or false")
    return value


def _by_variable(value: object) -> object:
    """Return a flat table whose keys are full names: { timer = { count = 3 } } becomes { "timer.count" = 3 }."""
    if not isinstance(value, Mapping):
        return value
    flat: dict[str, object] = {}
    for name, one in value.items():
        inner = _by_variable(one)
        flat |= {f"{name}.{rest}": part for rest, part in inner.items()} if isinstance(inner, dict) else {name: inner}
    return flat


def _without_direction(value: object) -> object:
    """Return an address unchanged. Raise ValueError if it is 0x80 to 0xFF, so that it seems to contain the R/W bit."""
    if type(value) is int and 0x7F < value <= 0xFF:
        hint = f"without its R/W bit, {value:#04x} is {value >> 1:#04x}"
        raise ValueError(f"expected an address of 7 bits, 0x00 to 0x7f, but it is {value:#04x}; {hint}")
    return value


def _crystal(value: object) -> Fraction:
    """Return the frequency of a crystal in hertz. Raise ValueError if it is beyond the limits of SPRS439.

    value: a text with a unit, such as "30 MHz", or a Fraction in hertz. Raise ValueError for other values.
    """
    hertz = frequency(value, "MHz")
    if not 4_000_000 <= hertz <= 150_000_000:
        raise ValueError("expected 4 MHz to 150 MHz")
    return hertz


Exact = Annotated[Fraction, Before(_exact, int | float | str)]
Answer = Annotated[Value, Before(_scalar)]  # an answer to an open question
Length = Annotated[Duration, After(_above_zero)]
Address = Annotated[int, Before(_without_direction), Meta(ge=0, le=0x7F)]
Byte = Annotated[int, Meta(ge=0, le=0xFF)]
BusRate = Annotated[Frequency, Meta(le=5_000_000)]  # hertz, up to the fastest mode of UM10204
Crystal = Annotated[Fraction, Before(_crystal, FREQUENCY_TEXT)]  # hertz at X1/X2 or XCLKIN
Ppm = Annotated[Exact, Meta(ge=-100_000, le=100_000)]
RateError = Annotated[Exact, Meta(ge=-50, le=50)]
Bits = Annotated[Exact, Meta(ge=0)]
VariableValues = Annotated[dict[str, int | float], Before(_by_variable, dict[str, int | float])]
Axes = tuple[Exact, Exact, Exact]
CodeCycles = Annotated[int, Meta(ge=0, le=1000)]
PassCycles = Annotated[int, Meta(ge=1, le=1000)]
