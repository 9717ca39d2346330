"""Phrases that describe the valid values of a type, for messages about values in a file."""

from __future__ import annotations

from enum import Enum
from fractions import Fraction
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import msgspec

UNIONS = (Union, UnionType)
NAMES: dict[Any, str] = {int: "a whole number", float: "a number", Fraction: "a number", str: "a text"}
NAMES |= {bool: "true or false", bytes: "bytes", Path: "a path", list: "a list", tuple: "a list"}


def expected(kind: Any, found: object) -> str:
    """Return a phrase that describes the valid values of a plain type, for a message. found: the invalid value."""
    origin, arguments = get_origin(kind), get_args(kind)
    is_enum = isinstance(kind, type) and issubclass(kind, Enum)
    if origin is Literal or is_enum:
        shown = [repr(one.value if is_enum else one) for one in (kind if is_enum else arguments)]
        return " or ".join(filter(None, [", ".join(shown[:-1]), shown[-1]]))
    if origin is Annotated:
        is_of_kind = type(found) is arguments[0] or isinstance(found, list | tuple)
        return limits_of(arguments[1]) if is_of_kind else expected(arguments[0], found)
    if origin in UNIONS:
        there = [one for one in arguments if one is not NoneType]
        # If any members of the union have the Python type of `found` and limits, only these members are described.
        alike = [one for one in there if get_origin(one) is Annotated and type(found) is get_args(one)[0]]
        return ", or ".join(expected(one, found) for one in alike or there)
    if origin is tuple and ... not in arguments:
        return f"a list of {len(arguments)}"
    if (origin or kind) in (list, tuple) and isinstance(found, str):
        return f"a list, as in [{found!r}]"
    return NAMES.get(origin or kind) or f"a {getattr(kind, '__name__', kind)}"


def limits_of(limits: msgspec.Meta) -> str:
    """Return the limits of a value, or of a list's length, as a phrase such as "1 to 10"."""
    if limits.min_length is not None:
        return f"{limits.min_length} or more entries"
    if limits.ge is None:
        return f"{limits.le} or less"
    return f"{limits.ge} or more" if limits.le is None else f"{limits.ge} to {limits.le}"
