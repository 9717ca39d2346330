"""Flags that read-modify-writes cleared, for each place in the firmware.

All registers that have flags which are cleared by writing 1 are covered. A field of several bits, such as PIEACK,
counts as one flag: it rises with each change to a value other than 0, and is cleared when it becomes 0. It is therefore
not reported that `PIEACK |= 0x80` also acknowledges other groups.

    CLEARABLE --> ClearedRegister --> ModifiesOfPlace: cleared flags, by whether firmware had read them
                        '-- Flag: its last rise

A `ClearedRegister` receives the records of one register. Its writes and the changes of its flags must be passed in the
order of their records. Its reads must be passed in their order, too. A read that belongs to a read-modify-write must be
passed after the write of the same read-modify-write and the changes that this write made. Only counts by place are
kept, so memory does not grow with the length of the run, unless the ticks of clearings are kept.
"""

# core: compiled

from __future__ import annotations

from typing import NamedTuple, final

from ..core.records import Kind
from ..core.registers import Field
from ..core.time import NO_TIME
from ..f28335.parts.f28335 import PART
from ..form.c_types import Text
from .register_maps import is_status, one_clears


class Clearable(NamedTuple):
    """A register with flags that are cleared by writing 1. status: True if it is a status register (`is_status`)."""

    name: str
    flags: tuple[Field, ...]
    status: bool


CLEARABLE = {
    f"{module.name}.{register.name}": Clearable(register.name, flags, is_status(register))
    for module in PART.modules
    for register in module.registers
    if (flags := one_clears(register))
}
CLEARABLE_FLAGS = {(Kind.FLAG, f"{of.name}.{flag.name}") for of in CLEARABLE.values() for flag in of.flags}
NEVER_YET = -1  # in place of the number of a record: there has been no such record


@final
class Modify:
    """A write that belongs to a read-modify-write.

    number, tick, place: the number of the record of the write, its tick, and its place in the firmware.
    written: the value that was written to the register.
    rose: for each flag, the number of the record of its last rise before the write; NEVER_YET if it never rose.
    cleared: mask of the flags that the write cleared.
    """

    __slots__ = ("cleared", "number", "place", "rose", "tick", "written")

    number: int
    tick: int
    written: int
    cleared: int
    place: Text
    rose: list[int]


@final
class Flag:
    """A flag of a register. rose: the number of the record of its last rise; NEVER_YET if it never rose."""

    __slots__ = ("mask", "name", "register", "rose")

    def __init__(self, field: Field, register: ClearedRegister) -> None:
        self.name: str = field.name
        self.mask: int = field.mask
        self.register = register
        self.rose = NEVER_YET


@final
class Cleared:
    """Count of the clearings of one or more flags.

    first: the tick of the first clearing; NO_TIME if there was none.
    ticks: the ticks of all clearings; None if ticks are not kept.
    """

    __slots__ = ("count", "first", "ticks")

    def __init__(self, keeps_ticks: bool = False) -> None:
        self.count = 0
        self.first = NO_TIME
        self.ticks: list[int] | None = [] if keeps_ticks else None

    def add(self, other: Cleared) -> None:
        """Add the count of `other`. `first` becomes the earlier of both first ticks; `ticks` does not change."""
        if other.count and (not self.count or other.first < self.first):
            self.first = other.first
        self.count += other.count

    def one_more(self, tick: int) -> None:
        if not self.count or tick < self.first:
            self.first = tick
        self.count += 1
        if self.ticks is not None:
            self.ticks.append(tick)


@final
class FlagOfPlace:
    """Effects of the read-modify-writes of one place on one flag.

    rose: number of times that the flag rose between the read and the write. If `ClearedRegister.keeps_ticks` is False,
        only those times are counted after which the write cleared the flag.
    between: clearings of a flag that rose between the read and the write.
    along: clearings of a flag that the read had returned as 1, by a statement that does not name the flag.
    unseen: the clearings in `along` before which the firmware had not read the flag since its last rise. Reads that
        belong to the read-modify-writes of this place do not count.
    """

    __slots__ = ("along", "between", "rose", "unseen")

    def __init__(self, keeps_ticks: bool) -> None:
        self.rose = 0
        self.between = Cleared(keeps_ticks)
        self.along = Cleared(keeps_ticks)
        self.unseen = Cleared(keeps_ticks)


@final
class FieldRead:
    """The last read of a field. field: "" for the whole register. number: the number of the record of the read."""

    __slots__ = ("field", "number")

    field: Text
    number: int


@final
class FieldReads:
    """The last read of each field of a register. A list suffices, because firmware reads few fields of one register."""

    __slots__ = ("_reads",)

    def __init__(self) -> None:
        self._reads: list[FieldRead] = []

    def add(self, field: Text, number: int) -> None:
        """Store a read as the last read of a field. number: the number of the record of the read."""
        read: FieldRead
        for read in self._reads:
            if read.field is field:
                read.number = number
                return
        for read in self._reads:
            if read.field == field:  # equal strings can be different objects; the first, faster loop compares objects
                read.field, read.number = field, number
                return
        read = FieldRead()
        read.field, read.number = field, number
        self._reads.append(read)

    def last(self, field: str) -> int:
        """Return the record number of the last read of a field, alone or with the whole register; NEVER_YET if none."""
        return max((read.number for read in self._reads if read.field in ("", field)), default=NEVER_YET)


@final
class ModifiesOfPlace:
    """The read-modify-writes of one register at one place in the firmware.

    flags: the effects on each flag of the register, in the order of `ClearedRegister.flags`.
    count: number of read-modify-writes.
    proven: mask of the bits that were at least once written as 1 although they had been read as 0. The firmware
        certainly intended to clear them.
    always: mask of the bits that every write set to 1.
    last_reads: for each assigned field, the last read of the register by a read-modify-write that assigns this field.
    named: names of the fields that the statements at this place assign; empty if they assign the whole register.
    """

    __slots__ = ("always", "count", "flags", "last_reads", "named", "proven")

    def __init__(self, flags: list[FlagOfPlace]) -> None:
        self.flags = flags
        self.count = 0
        self.last_reads = FieldReads()
        self.proven = 0
        self.always = -1
        self.named: set[str] = set()

    def meant(self, flags: list[Flag]) -> set[str]:
        """Return the names of the flags that firmware may have intended to clear here.

        These are the fields, even if they are no flags, that the statements at this place name; if they name no field,
        the flags in `proven`; if `proven` has no flag, the flags in `always`.

        flags: the flags of the register.
        """
        if self.named:
            return self.named
        ones = {flag.name for flag in flags if self.always & flag.mask}
        return {flag.name for flag in flags if self.proven & flag.mask} or ones


@final
class ClearedRegister:
    """A register with flags that are cleared by writing 1, and the effects of read-modify-writes on these flags.

    status: True if it is a status register (`is_status`).
    last: the write of the last read-modify-write of the register; None if there was none.
    last_reads: the last read of each field, without the reads that belong to a read-modify-write.
    places: a dictionary from a place in the firmware to its read-modify-writes.
    keeps_ticks: True to keep the ticks at which flags were cleared, and to count flags that rose between read and write
        but were not cleared.
    """

    __slots__ = ("flags", "keeps_ticks", "last", "last_reads", "places", "status")

    def __init__(self, register: Clearable, keeps_ticks: bool = False) -> None:
        self.keeps_ticks = keeps_ticks
        self.flags = [Flag(field, self) for field in register.flags]
        self.status: bool = register.status
        self.last_reads = FieldReads()
        self.places: dict[str, ModifiesOfPlace] = {}
        self.last: Modify | None = None

    def flag(self, name: str) -> Flag | None:
        return next((flag for flag in self.flags if flag.name == name), None)

    def last_read(self, flag: Flag, place: Text) -> int:
        """Return the record number of the last read of this flag, by its own name or in a read of the whole register.

        The value that was read does not matter. Reads that belong to read-modify-writes at `place` do not count. The
        result is NEVER_YET if there was no read.
        """
        last: int = self.last_reads.last(flag.name)
        other: ModifiesOfPlace
        for at, other in self.places.items():
            if at != place:
                last = max(last, other.last_reads.last(flag.name))
        return last

    def flag_changed(self, flag: Flag, number: int, tick: int, value: int, cause: int) -> None:
        """Process the record of a flag that rises (`value` is not 0) or is cleared (`value` is 0)."""
        if value:
            flag.rose = number
            return
        last = self.last
        if last is not None and cause == last.number and tick == last.tick:
            last.cleared |= flag.mask

    def written(self, number: int, tick: int, value: int, place: Text) -> Modify:
        """Process the record of a write that belongs to a read-modify-write, and return the write.

        Pass the result to `judge` as its argument `made`, together with the read of the same read-modify-write.
        """
        made = Modify()
        made.number, made.tick, made.written, made.cleared, made.place = number, tick, value, 0, place
        made.rose = [flag.rose for flag in self.flags]
        self.last = made
        return made

    def judge(self, number: int, value: int, field: Text, made: Modify | None) -> None:
        """Process a read of the register. Calls must be in the order of the reads.

        If the read is the first half of a read-modify-write, the flags that the write cleared are counted at the place
        of the write. `ModifiesOfPlace.meant` decides later which of these flags the firmware intended to clear.

        number: the number of the record of the read.
        value: the value that was read.
        field: the name of the field that was read; "" for the whole register.
        made: the write of the same read-modify-write; None if the read does not belong to a read-modify-write.
        """
        if made is None:
            self.last_reads.add(field, number)
            return
        place: ModifiesOfPlace | None = self.places.get(made.place)
        if place is None:
            place = self.places[made.place] = ModifiesOfPlace([FlagOfPlace(self.keeps_ticks) for _ in self.flags])
        place.count += 1
        place.proven |= made.written & ~value
        place.always &= made.written
        if field:
            place.named.add(field)
        at: int
        flag: Flag
        for at, flag in enumerate(self.flags):
            is_cleared = made.cleared & flag.mask != 0
            if not (is_cleared or self.keeps_ticks):  # without ticks, only cleared flags are counted
                continue
            of: FlagOfPlace = place.flags[at]
            if made.rose[at] > number:
                of.rose += 1
                if is_cleared:
                    of.between.one_more(made.tick)
            elif is_cleared and value & flag.mask and field != flag.name:
                of.along.one_more(made.tick)
                if self.last_read(flag, made.place) < made.rose[at]:
                    of.unseen.one_more(made.tick)
        place.last_reads.add(field, number)
