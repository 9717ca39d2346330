"""The tables of a case file: a class whose fields are the keys; a tree goes in, a checked object comes out.

    class Cable(Table, frozen=True, kw_only=True):
        name: str | None = None
        from_: str = field(name="from")     the key `from`

A key that no field names is refused. `check_together` says what keys contradict each other.
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

PLAIN = frozenset((str, int, bool, bytes, float, Fraction, NoneType))  # which most fields have


class Table(Struct, frozen=True, kw_only=True):
    """Fields whose names begin with _ are no keys."""

    OTHERS: ClassVar[str] = ""  # the field, if any, that takes the keys which no field names

    def check_together(self, given: Set[str]) -> None:
        """ValueError, a phrase, where the keys contradict each other. given: those that the file has."""

    @classmethod
    def model_validate(cls, tree: object) -> Self:
        """The table that a tree says, as a file would. BadTable, with all that is wrong, if it says none."""
        return convert(cls, tree)

    def model_copy(self, *, update: Mapping[str, Any]) -> Self:
        """The same with other values, which are taken as they are."""
        new = copy.copy(self)
        for name, value in update.items():
            force_setattr(new, name, value)
        return new

    def model_dump(self) -> dict[str, Any]:
        """Its values, by field, without those whose names begin with _."""
        return {name: getattr(self, name) for name in self.__struct_fields__ if name[0] != "_"}


def separate(value: Any) -> Any:
    """The same with dicts and lists of its own: who changes one changes it for nobody else.

    What holds none is handed on as it is.
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
