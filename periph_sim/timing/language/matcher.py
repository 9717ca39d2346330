"""Matcher: the test of whether a record is a named event.

    Matcher(kind, where, what, mask, want)
      |-- may_be(kind, where, what), value & mask == want   during the run
      '-- fits(record)                                      for a Record object

Both tests have the same result for every record.
"""

from __future__ import annotations

from functools import cached_property

from msgspec import Struct

from ...core.records import Kind, Record
from .scope import Thing

EVERYTHING = -1  # the mask of all bits of a value
ANYTHING = ""  # `what` of a matcher that accepts all things of its kind


class Group(Struct, frozen=True):
    """A part of a run in which events are counted, such as a transfer.

    begin: the event at which the group begins: a START, the start of a frame, or the entry of a service routine. Not
        every such START or frame begins a round or a burst.
    end: a STOP, the end of a frame, or the return from a service routine. Only a return ends its group. Any other group
        lasts until the next group of the same kind begins.
    """

    name: str  # one of `events.GROUPS`
    begin: Matcher
    end: Matcher


class Matcher(Struct, frozen=True, dict=True):
    """Test of whether a record is an event.

    where: the places, such as wires or modules, whose records can be the event; None for all places.
    what: the thing that the record must have; ANYTHING for all things of the kind.
    mask: the bits of the record's value that are compared.
    want: the value that these bits must have.
    others: the matchers of alternative events, joined by "or".
    nth: the number of the event that counts in each group, from 1; -1 for the last event; 0 if every event counts.
    group: the group in which events are numbered; None if every event counts.
    thing: for a derived record, the properties of its thing, such as the unit of the value; None for other records.
    """

    text: str
    kind: Kind
    where: frozenset[str] | None
    what: str
    mask: int = 0
    want: int = 0
    free: bool = False  # True if the name was not checked, so it is not known whether the event can happen
    others: tuple[Matcher, ...] = ()
    nth: int = 0
    group: Group | None = None
    thing: Thing | None = None

    @cached_property
    def each(self) -> tuple[Matcher, ...]:
        """A tuple of this matcher and the matchers in `others`."""
        return (self, *self.others)

    def fits(self, record: Record) -> bool:
        """Return True if a record is this event. The number of the event within its group is not checked."""
        return any(
            one.may_be(record.kind, record.where, record.what) and record.value & one.mask == one.want
            for one in self.each
        )

    def may_be(self, kind: Kind, where: str, what: str) -> bool:
        """Return True if a record of this kind, place and thing may be this event, depending on its value."""
        fits = self.what in (what, ANYTHING) and kind is self.kind
        return fits and (self.where is None or where in self.where)

    @cached_property
    def subjects(self) -> frozenset[str]:
        """The wires or registers whose records this matcher needs; empty if it needs the records of all of them.

        The matchers in `others` are ignored.
        """
        places = self.where or frozenset()
        if self.kind in (Kind.EDGE, Kind.FRAME):
            return places
        if self.kind is Kind.FLAG:
            return frozenset(f"{place}.{self.what.partition('.')[0]}" for place in places)
        if self.kind is Kind.ACCESS and self.what != ANYTHING:
            return frozenset(f"{place}.{self.what[2:]}" for place in places)
        return frozenset()
