"""Named events: text goes in, an Event, and with a Scope the test for its records comes out.

    event   = "edge" wire ( "rise" | "fall" | "change" )
            | "flag" field ( "rise" | "fall" | "change" | "=" number )
            | "access" ( "R" | "W" ) register
            | "interrupt" vector ( "enter" | "leave" )
            | "span" span ( "begin" | "end" )
            | "bus" ( "START" | "repeated" "START" | "STOP" | "arbitration" "lost" | "stuck"
                    | "address" [ number ] [ "read" | "write" ] | "byte" [ number ] )
            | "frame" [ number ]
            | "note" ( "duty" | "lost" | "unknown" )

    Event + Scope --> Matcher(kind, where, what, mask, want)
                        |-- fits(record)   as the run goes on
                        '-- rows(table)    over a recorded run, all at once

Both say the same of every record: kind, place and thing are equal, and `value & mask == want`. `EVENTS` is the list
of what can be named.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core.nearest import near
from ..core.records import Kind, Record
from ..formats.record_table import RecordTable
from .names import BadEvent, Scope, scope_of_table
from .words import Words

EVERYTHING = -1  # all bits of a value
CHANGES = ("rise", "fall", "change")
NOTES = ("duty", "lost", "unknown")
BUS = ("START", "repeated START", "STOP", "address", "byte", "arbitration lost", "stuck")


@dataclass(frozen=True)
class Event:
    """kind: the event's first word. name: what it is about. how: which change or way. number: a value, if given."""

    kind: str
    text: str
    unit: str = ""
    name: str = ""
    how: str = ""
    number: int | None = None


@dataclass(frozen=True)
class Matcher:
    """where: the places it may happen at; None for any."""

    text: str
    kind: Kind
    where: frozenset[str] | None
    what: str
    mask: int = 0
    want: int = 0
    free: bool = False  # the name is free text, so that nobody knows whether it can happen

    def fits(self, record: Record) -> bool:
        return (
            record.what == self.what
            and record.kind is self.kind
            and (self.where is None or record.where in self.where)
            and record.value & self.mask == self.want
        )

    @property
    def subjects(self) -> frozenset[str]:
        """The wires or registers whose records it needs, as `Recorder.subscribe` has them; none if it needs all."""
        places = self.where or frozenset()
        if self.kind is Kind.EDGE:
            return places
        if self.kind is Kind.FLAG:
            return frozenset(f"{place}.{self.what.partition('.')[0]}" for place in places)
        if self.kind is Kind.ACCESS:
            return frozenset(f"{place}.{self.what[2:]}" for place in places)
        return frozenset()

    def rows(self, table: RecordTable) -> NDArray[np.int64]:
        """The rows at which it happened, in order."""
        wanted = (
            _named(table, "kind", frozenset((self.kind.value,)))
            & _named(table, "what", frozenset((self.what,)))
            & _named(table, "where", self.where)
        )
        rows: NDArray[np.int64] = np.flatnonzero(wanted)
        kept: NDArray[np.int64] = rows[table.value[rows] & self.mask == self.want]
        return kept


def _named(table: RecordTable, column: str, names: frozenset[str] | None) -> NDArray[np.bool_]:
    if names is None:
        return np.ones(len(table), bool)
    known = np.array([name in names for name in table.names[column]], bool)
    return known[table.columns[column]] if len(known) else np.zeros(len(table), bool)


def event_of(text: str) -> Event:
    """The event that a text names. BadEvent otherwise."""
    words = Words(text)
    event = read_event(words)
    words.end()
    return event


def read_event(words: Words) -> Event:
    """The event that comes next. BadEvent otherwise."""
    begin = words.place
    kind = words.one_of(list(EVENTS))
    unit, name, how, number = EVENTS[kind].read(words)
    return Event(kind, words.between(begin), unit, name, how, number)


def matcher(event: Event | str, scope: Scope) -> Matcher:
    """The test for an event. BadEvent if it cannot happen in this scene."""
    if isinstance(event, str):
        event = event_of(event)
    return EVENTS[event.kind].match(event, scope)


def matcher_for(event: Event | str, table: RecordTable) -> Matcher:
    """The same for a recorded run."""
    return matcher(event, scope_of_table(table))


def start_of_transfer(scope: Scope) -> Matcher:
    """What begins a transfer: a START that is no repeated one."""
    return matcher("bus START", scope)


Parts = tuple[str, str, str, int | None]


def _read_edge(words: Words) -> Parts:
    return "", words.name("a wire")[1], words.one_of(list(CHANGES)), None


def _read_flag(words: Words) -> Parts:
    unit, name = words.name("a field")
    how = words.one_of([*CHANGES, "="])
    number = None
    if how == "=":
        number = words.number(0xFFFFFFFF)
        if number is None:
            raise BadEvent(f"{words.text!r}: a number is expected after =")
    return unit, name, how, number


def _read_access(words: Words) -> Parts:
    way = words.one_of(["R", "W"])
    unit, name = words.name("a register")
    return unit, name, way, None


def _read_interrupt(words: Words) -> Parts:
    unit, name = words.name("an interrupt's name")
    return unit, name, words.one_of(["enter", "leave"]), None


def _read_span(words: Words) -> Parts:
    unit, name = words.name("a span's name")
    while words.next and words.next not in ("begin", "end", "to", ","):
        name += f" {words.take('begin or end')}"
    return unit, name, words.one_of(["begin", "end"]), None


def _read_bus(words: Words) -> Parts:
    what = words.one_of([name.split()[0] for name in BUS])
    if what == "repeated":
        return "", f"repeated {words.one_of(['START'])}", "", None
    if what == "arbitration":
        return "", f"arbitration {words.one_of(['lost'])}", "", None
    if what == "address":
        number = words.number(0x7F)
        how = words.one_of(["read", "write"]) if words.next in ("read", "write") else ""
        return "", what, how, number
    return "", what, "", words.number(0xFF) if what == "byte" else None


def _read_frame(words: Words) -> Parts:
    return "", "byte", "", words.number(0xFF)


def _read_note(words: Words) -> Parts:
    unit, name = words.name("a note's code")
    if name not in NOTES:
        raise BadEvent(f"{words.text!r}: there is no note {name!r}; {near(name, NOTES)}")
    return unit, name, "", None


def _match_edge(event: Event, scope: Scope) -> Matcher:
    mask, want = {"rise": (1, 1), "fall": (1, 0), "change": (0, 0)}[event.how]
    return Matcher(event.text, Kind.EDGE, frozenset((scope.wire(event.name),)), "level", mask, want)


def _match_flag(event: Event, scope: Scope) -> Matcher:
    unit, module, register, field = scope.field(event.unit, event.name)
    width = field.msb - field.lsb + 1
    if event.number is not None and event.number >> width:
        raise BadEvent(f"{event.name} has {width} bits and so is never {event.number:#x}")
    if width > 1 and event.how in ("rise", "fall"):
        raise BadEvent(f"{event.name} has {width} bits and so does not {event.how}; write change, or = and a value")
    mask, want = {
        "rise": (EVERYTHING, 1),
        "fall": (EVERYTHING, 0),
        "change": (0, 0),
        "=": (EVERYTHING, event.number or 0),
    }[event.how]
    place = frozenset((f"{unit}.{module}",))
    return Matcher(event.text, Kind.FLAG, place, f"{register.name}.{field.name}", mask, want)


def _match_access(event: Event, scope: Scope) -> Matcher:
    unit, module, register = scope.register(event.unit, event.name)
    return Matcher(event.text, Kind.ACCESS, frozenset((unit,)), f"{event.how} {module}.{register.name}")


def _match_interrupt(event: Event, scope: Scope) -> Matcher:
    unit = scope.vector(event.unit, event.name)
    return Matcher(event.text, Kind.IRQ, frozenset((unit,)), event.name, EVERYTHING, int(event.how == "enter"))


def _match_span(event: Event, scope: Scope) -> Matcher:
    unit = frozenset((scope.unit(event.unit),))
    return Matcher(event.text, Kind.SPAN, unit, event.name, EVERYTHING, int(event.how == "begin"), free=True)


def _match_bus(event: Event, scope: Scope) -> Matcher:
    if not scope.controller:
        raise BadEvent(f"{event.text!r} needs a controller in the scene, which has none; watch edges of SCL and SDA")
    mask = want = 0
    if event.name == "address":  # value: address, R/W, NACK from bit 2 down
        if event.number is not None:
            mask, want = -4, event.number << 2
        if event.how:
            mask, want = mask | 2, want | (2 if event.how == "read" else 0)
    elif event.number is not None:
        mask, want = -2, event.number << 1
    return Matcher(event.text, Kind.BUS, None, event.name, mask, want)


def _match_frame(event: Event, scope: Scope) -> Matcher:
    if not scope.host:
        raise BadEvent(f"{event.text!r} needs a host in the scene, which has none; watch edges of RX or TX")
    if event.number is None:
        return Matcher(event.text, Kind.FRAME, None, "byte")
    return Matcher(event.text, Kind.FRAME, None, "byte", EVERYTHING, event.number)


def _match_note(event: Event, scope: Scope) -> Matcher:
    return Matcher(event.text, Kind.NOTE, scope.places(event.unit), event.name)


class EventKind(NamedTuple):
    """read: the words behind the kind's own. match: the test for what they say."""

    read: Callable[[Words], Parts]
    match: Callable[[Event, Scope], Matcher]


EVENTS = {
    "edge": EventKind(_read_edge, _match_edge),
    "flag": EventKind(_read_flag, _match_flag),
    "access": EventKind(_read_access, _match_access),
    "interrupt": EventKind(_read_interrupt, _match_interrupt),
    "span": EventKind(_read_span, _match_span),
    "bus": EventKind(_read_bus, _match_bus),
    "frame": EventKind(_read_frame, _match_frame),
    "note": EventKind(_read_note, _match_note),
}
