"""Named events compiled to tests of records: an Event and a Scope go in, a Matcher comes out.

    Event + Scope --> Matcher(kind, where, what, mask, want)
                        |-- fits(record)   as the run goes on
                        '-- rows(table)    over a recorded run, all at once

Both say the same of every record: kind, place and thing are equal, and `value & mask == want`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.records import Kind, Record
from ..formats.record_table import RecordTable
from .language import Event, event_of
from .names import BadEvent, Scope, scope_of_table

EVERYTHING = -1  # all bits of a value


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


def matcher(event: Event | str, scope: Scope) -> Matcher:
    """The test for an event. BadEvent if it cannot happen in this scene."""
    if isinstance(event, str):
        event = event_of(event)
    return _COMPILED[event.kind](event, scope)


def matcher_for(event: Event | str, table: RecordTable) -> Matcher:
    """The same for a recorded run."""
    return matcher(event, scope_of_table(table))


def start_of_transfer(scope: Scope) -> Matcher:
    """What begins a transfer: a START that is no repeated one."""
    return matcher("bus START", scope)


def _edge(event: Event, scope: Scope) -> Matcher:
    mask, want = {"rise": (1, 1), "fall": (1, 0), "change": (0, 0)}[event.how]
    return Matcher(event.text, Kind.EDGE, frozenset((scope.wire(event.name),)), "level", mask, want)


def _flag(event: Event, scope: Scope) -> Matcher:
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


def _access(event: Event, scope: Scope) -> Matcher:
    unit, module, register = scope.register(event.unit, event.name)
    return Matcher(event.text, Kind.ACCESS, frozenset((unit,)), f"{event.how} {module}.{register.name}")


def _interrupt(event: Event, scope: Scope) -> Matcher:
    unit = scope.vector(event.unit, event.name)
    return Matcher(event.text, Kind.IRQ, frozenset((unit,)), event.name, EVERYTHING, int(event.how == "enter"))


def _span(event: Event, scope: Scope) -> Matcher:
    unit = frozenset((scope.unit(event.unit),))
    return Matcher(event.text, Kind.SPAN, unit, event.name, EVERYTHING, int(event.how == "begin"), free=True)


def _bus(event: Event, scope: Scope) -> Matcher:
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


def _frame(event: Event, scope: Scope) -> Matcher:
    if not scope.host:
        raise BadEvent(f"{event.text!r} needs a host in the scene, which has none; watch edges of RX or TX")
    if event.number is None:
        return Matcher(event.text, Kind.FRAME, None, "byte")
    return Matcher(event.text, Kind.FRAME, None, "byte", EVERYTHING, event.number)


def _note(event: Event, scope: Scope) -> Matcher:
    return Matcher(event.text, Kind.NOTE, scope.places(event.unit), event.name)


_COMPILED = {
    "edge": _edge,
    "flag": _flag,
    "access": _access,
    "interrupt": _interrupt,
    "span": _span,
    "bus": _bus,
    "frame": _frame,
    "note": _note,
}
