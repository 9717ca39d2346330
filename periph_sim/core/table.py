"""Tables of a case file: classes whose fields are the keys, with the types of their values.

    class Cable(Table, frozen=True, kw_only=True):
        name: str | None = None
        from_: str = field(name="from")     the key `from`

A key without a field is rejected, unless the class sets `OTHERS`. `check_together` rejects keys that contradict each
other.

Exact numbers are written as texts with units. `Duration` converts "250 us" to seconds as an exact fraction and rejects
a number without a unit. `DurationRange` converts "240 us to 260 us" to a `Spread`. `Frequency` converts "100 kHz" to
hertz, `HexBytes` converts "1d 00 ff" to bytes, and `Share` converts "90 %" to a fraction.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Set
from fractions import Fraction
from functools import lru_cache
from operator import is_
from types import NoneType
from typing import Annotated, Any, ClassVar, Self

from msgspec import Meta, Struct
from msgspec.structs import force_setattr

from .convert import Before, convert
from .exact_number import SHOWN, exact_number, number_and_unit, unknown_unit
from .phrases import shorten
from .time import UNITS as TIMES
from .time import TimeError, seconds

PLAIN = frozenset((str, int, bool, bytes, float, Fraction, NoneType))  # types of values that need not be copied


class Table(Struct, frozen=True, kw_only=True):
    """Base of tables. Fields whose names begin with _ are not keys."""

    OTHERS: ClassVar[str] = ""  # the name of the field that receives unknown keys; "" to reject them

    def check_together(self, given: Set[str]) -> None:
        """Raise ValueError with a phrase if the keys contradict each other. given: the keys in the file."""

    @classmethod
    def model_validate(cls, tree: object) -> Self:
        """Return a table made from a tree of keys and values. Raise BadTable, with all mistakes, if it is not valid."""
        return convert(cls, tree)

    def model_copy(self, *, update: Mapping[str, Any]) -> Self:
        """Return a copy in which the fields in `update` have other values. These values are not checked."""
        new = copy.copy(self)
        for name, value in update.items():
            force_setattr(new, name, value)
        return new


def separate(value: Any) -> Any:
    """Return a copy whose dicts and lists are not shared with the original.

    A tuple or an object of a `Table` class is copied if it contains a dict or list at any depth. Values of all other
    types are shared.
    """
    kind = type(value)
    if kind in PLAIN:
        return value
    if kind is dict:
        return {key: inner if type(inner) in PLAIN else separate(inner) for key, inner in value.items()}
    if kind is list:
        return [inner if type(inner) in PLAIN else separate(inner) for inner in value]
    if kind is tuple:
        several = [separate(inner) for inner in value]
        return value if all(map(is_, several, value)) else tuple(several)
    if not issubclass(kind, Table):
        return value
    old = {name: getattr(value, name) for name in kind.__struct_fields__}
    changed = {name: new for name, inner in old.items() if (new := separate(inner)) is not inner}
    return value.model_copy(update=changed) if changed else value


LOWEST, HIGHEST = Fraction(1, 1000), 10**12  # limits of a frequency in Hz; ticks and cycles then fit 64 bits
HERTZ = {"Hz": 1, "kHz": 1_000, "MHz": 1_000_000, "GHz": 1_000_000_000}


def share(value: object) -> Fraction:
    """Return the share, from 0 to 1, in a text such as "40 %". A Fraction is returned unchanged.

    Raise ValueError for other values. The message states what to write.
    """
    if isinstance(value, Fraction):
        return value
    text = str(value).strip()
    try:
        percent = exact_number(text.removesuffix("%"))
    except ValueError:
        percent = Fraction(-1)
    if not text.endswith("%") or not 0 <= percent <= 100:
        raise ValueError(f"{value!r} is not a share from 0 % to 100 %; write for instance '90 %'")
    return percent / 100


def duration(value: object) -> Fraction:
    """Return the seconds in a text such as "250 us". A Fraction is returned unchanged.

    Raise ValueError for other values and for negative times. The message states what to write.
    """
    if isinstance(value, Fraction):
        return value
    if not isinstance(value, str):
        raise ValueError(_no_unit(value, "ms"))
    length = _length(value)
    if isinstance(length, str):
        raise ValueError(length)
    return length


@lru_cache(maxsize=4096)  # scenes of one case repeat the same texts
def _length(text: str) -> Fraction | str:
    """Return a duration in seconds, or an error message if the text is not a duration."""
    try:
        length = seconds(text)
    except TimeError as error:
        return str(error)
    return f"{text!r} is negative; a duration is 0 or more" if length < 0 else length


class Spread(Struct, frozen=True):
    """A range of times in seconds, for a time that is not exactly known, such as the write time of an EEPROM.

    Each use of the time, such as a call of `Dsp.compute`, draws a value in this range.

    Raise ValueError for a negative or empty range.
    """

    least: Fraction
    most: Fraction

    def __post_init__(self) -> None:
        if not 0 <= self.least <= self.most:
            raise ValueError(
                f"{self.least} s to {self.most} s is not a range; write the smaller value first, and none below 0"
            )

    def __add__(self, fixed: Fraction) -> Spread:
        return Spread(self.least + fixed, self.most + fixed)

    def __str__(self) -> str:
        return f"{self.least} s to {self.most} s"


def spread(value: object) -> Spread:
    """Return the range in a text such as "240 us to 260 us" or "250 us". A Spread is returned unchanged.

    Raise ValueError as `duration` does, or if the second time is shorter than the first.
    """
    if isinstance(value, Spread):
        return value
    if isinstance(value, str):
        return _range(value)
    length = duration(value)
    return Spread(length, length)


@lru_cache(maxsize=4096)
def _range(text: str) -> Spread:
    first, to, second = text.partition(" to ")
    least = duration(first)
    most = duration(second) if to else least
    if most < least:
        raise ValueError(f"{text!r}: {second} is shorter than {first}; write the least first")
    return Spread(least, most)


def frequency(value: object, usual: str = "kHz") -> Fraction:
    """Return the hertz in a text such as "100 kHz". A Fraction is returned unchanged.

    usual: the unit that error messages suggest; for a whole number of 10,000 or more without a unit, this is Hz.

    Raise ValueError for other values. The message states what to write.
    """
    if isinstance(value, Fraction):
        return value
    if not isinstance(value, str):
        raise ValueError(_no_unit(value, "Hz" if isinstance(value, int) and value >= 10_000 else usual))
    quoted = shorten(repr(value), SHOWN)
    number, unit = number_and_unit(value)
    if not any(map(str.isdigit, number)) or not unit:
        example = f"write for instance {number or '100'} {usual} ({', '.join(HERTZ)})"
        raise ValueError(f"{quoted}: expected a number and a unit; {example}")
    if unit not in HERTZ:
        raise ValueError(f"{quoted}: {unknown_unit(number, unit, HERTZ)}")
    try:
        hertz = exact_number(number) * HERTZ[unit]
    except ValueError as error:
        raise ValueError(f"{quoted}: {error}") from None
    if hertz <= 0:
        raise ValueError(f"{quoted}: a frequency is above 0")
    if not LOWEST <= hertz <= HIGHEST:
        raise ValueError(f"{quoted}: a frequency is 1/1000 Hz to 1000 GHz")
    return hertz


def _no_unit(value: object, unit: str) -> str:
    """Return an error message for a value that is not a text with a unit. unit: the unit in the example."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return f'expected a number with its unit, as in "20 {unit}"'
    return f'{value!r} has no unit; write for instance "{value} {unit}"'


def hex_bytes(value: object) -> bytes:
    """Return the bytes of "1d 00 ff" or of a list of numbers from 0 to 255. Bytes are returned unchanged.

    Raise ValueError for other values.
    """
    if isinstance(value, bytes):
        return value
    try:
        if isinstance(value, str):
            return bytes.fromhex(value)
        if isinstance(value, list) and all(type(v) is int for v in value):
            return bytes(value)
    except ValueError:
        pass
    raise ValueError(f'{value!r} is not a sequence of bytes; write for instance "1d 00 ff"')


def _text_type(pattern: str, *examples: str) -> Any:
    """Return a type for the JSON schema that editors read: a text with this pattern. The converters check the text."""
    schema = {"pattern": pattern, "examples": [*examples]}  # `Meta(pattern=...)` would compile the pattern at import
    return Annotated[str, Meta(extra_json_schema=schema)]


_TIME = rf"\s*[-+0-9._eE/]+\s*({'|'.join(TIMES)}|[\u00b5\u03bc]s)\s*"
DURATION_TEXT = _text_type(f"^{_TIME}$", "250 us", "1.5 ms")
_RANGE = _text_type(f"^{_TIME}( to {_TIME})?$", "240 us to 260 us")
FREQUENCY_TEXT = _text_type(rf"^\s*[-+0-9._eE/]+\s*({'|'.join(HERTZ)})\s*$", "100 kHz")
_BYTES = _text_type(r"^[0-9a-fA-F\s]*$", "1d 00 ff") | list[Annotated[int, Meta(ge=0, le=255)]]
_SHARE = _text_type(r"^\s*[-+0-9._eE/]+\s*%\s*$", "90 %")

Duration = Annotated[Fraction, Before(duration, DURATION_TEXT)]
DurationRange = Annotated[Spread, Before(spread, _RANGE)]
Frequency = Annotated[Fraction, Before(frequency, FREQUENCY_TEXT)]
HexBytes = Annotated[bytes, Before(hex_bytes, _BYTES)]
Share = Annotated[Fraction, Before(share, _SHARE)]
