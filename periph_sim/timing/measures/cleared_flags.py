"""Registers whose flags are cleared by writing 1, and what the read-modify-writes of each place cleared of them.

    CLEARABLE --> ClearedRegister --> Place: flags that its writes cleared, by whether firmware had read them
                        '-- Flag: its last rise

Everything is counted by place, so memory does not grow with the run.
"""

# core: compiled

from __future__ import annotations

from typing import NamedTuple, final

from ...core.records import Kind
from ...core.registers import Field
from ...core.time import NO_TIME
from ...form.c_types import Text
from ...records.register_maps import is_status, one_clears
from ..language.scope import MAPS


class Clearable(NamedTuple):
    """A register with flags that writing 1 clears. status: hardware sets flags of it."""

    name: str
    flags: tuple[Field, ...]
    status: bool


CLEARABLE = {
    f"{module}.{register.name}": Clearable(register.name, flags, is_status(register))
    for module, registers in MAPS.items()
    for register in registers
    if (flags := one_clears(register))
}
CLEARABLE_FLAGS = {(Kind.FLAG, f"{of.name}.{flag.name}") for of in CLEARABLE.values() for flag in of.flags}
NEVER_YET = -1  # instead of a record's number


@final
class Modify:
    """A write with its read. rose: the last rise of each flag before it. cleared: mask of the flags that it cleared."""

    __slots__ = ("cleared", "number", "place", "rose", "tick", "written")

    number: int
    tick: int
    written: int
    cleared: int
    place: Text
    rose: list[int]


@final
class Flag:
    """rose: the record of its last rise."""

    __slots__ = ("mask", "name", "register", "rose")

    def __init__(self, field: Field, register: ClearedRegister) -> None:
        self.name: str = field.name
        self.mask: int = field.mask
        self.register = register
        self.rose = NEVER_YET


@final
class Cleared:
    """Number of times that something was cleared, and the tick of the first time: NO_TIME for never."""

    __slots__ = ("count", "first")

    def __init__(self) -> None:
        self.count = 0
        self.first = NO_TIME

    def add(self, count: int, first: int) -> None:
        """Add a count. first: the tick of its first time."""
        if count and (not self.count or first < self.first):
            self.first = first
        self.count += count


def last_look(looks: dict[str, int], field: str) -> int:
    """Return the record number of the last read that showed a field; NEVER_YET for none. looks: by name of a field."""
    return max(looks.get("", NEVER_YET), looks.get(field, NEVER_YET))


@final
class Place:
    """The writes of one place in the firmware, and the flags that they cleared.

    proven: bits that were written as 1 and not read as 1.
    always: bits that were written as 1 each time.
    between: by flag, the writes that cleared it though it rose after their read.
    along: by flag, the writes that cleared it after it was read as 1.
    unseen: those of `along` before which the firmware had not read the flag since it rose.
    looks: record numbers of the last reads made for these writes, by field; "" for the whole register.
    """

    __slots__ = ("along", "always", "between", "looks", "named", "proven", "unseen")

    def __init__(self) -> None:
        self.looks: dict[str, int] = {}
        self.proven = 0
        self.always = -1
        self.named: set[str] = set()
        self.between: dict[str, Cleared] = {}
        self.along: dict[str, Cleared] = {}
        self.unseen: dict[str, Cleared] = {}

    def meant(self, flags: list[Flag]) -> set[str]:
        """Return the flags that firmware may have intended to clear here."""
        if self.named:
            return self.named
        ones = {flag.name for flag in flags if self.always & flag.mask}
        return {flag.name for flag in flags if self.proven & flag.mask} or ones


@final
class ClearedRegister:
    """A register with flags that writing 1 clears. status: hardware sets flags of it. last: its last read-modify-write.

    looks: the last plain reads, as of a place. places: the places of its writes.
    """

    __slots__ = ("flags", "last", "looks", "places", "status")

    def __init__(self, register: Clearable) -> None:
        self.flags = [Flag(field, self) for field in register.flags]
        self.status: bool = register.status
        self.looks: dict[str, int] = {}
        self.places: dict[str, Place] = {}
        self.last: Modify | None = None

    def flag(self, name: str) -> Flag | None:
        flag: Flag
        for flag in self.flags:
            if flag.name == name:
                return flag
        return None

    def looked_at(self, flag: Flag, place: Text) -> int:
        """Return the record number of the last read that showed this flag, except reads for the writes of a place."""
        last: int = last_look(self.looks, flag.name)
        other: Place
        for at, other in self.places.items():
            if at != place:
                last = max(last, last_look(other.looks, flag.name))
        return last
