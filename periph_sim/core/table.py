"""Tables of a case file: classes whose fields are the keys, with checks of the file's values.

    class Cable(Table, frozen=True, kw_only=True):
        name: str | None = None
        from_: str = field(name="from")     the key `from`

A key without a field is rejected. `check_together` rejects keys that contradict each other.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Set
from fractions import Fraction
from operator import is_
from types import NoneType
from typing import Any, ClassVar, Self

from msgspec import Struct
from msgspec.structs import force_setattr

from .convert import convert

PLAIN = frozenset((str, int, bool, bytes, float, Fraction, NoneType))  # the types of most fields


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
        """Return a copy with other values, which are not checked."""
        new = copy.copy(self)
        for name, value in update.items():
            force_setattr(new, name, value)
        return new

    def model_dump(self) -> dict[str, Any]:
        """Return the values indexed by the names of their fields, without fields whose names begin with _."""
        return {name: getattr(self, name) for name in self.__struct_fields__ if name[0] != "_"}


def separate(value: Any) -> Any:
    """Return a copy whose dicts and lists are not shared with the original.

    Values that contain no dict and no list are not copied.
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
    changed = {}
    for name in kind.__struct_fields__:
        old = getattr(value, name)
        if type(old) not in PLAIN:
            new = separate(old)
            if new is not old:
                changed[name] = new
    return value.model_copy(update=changed) if changed else value
