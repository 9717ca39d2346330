"""Measures of events over a recorded run, as arrays.

    table = formats.psr.read_table(path)
    timing.between(table, "bus address 0x68 read", "access W I2C-A.I2CDXR") --> durations and starts, int64 ticks

`between` passes the events in the table to the measure of `from EVENT to EVENT`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...traces.formats.record_table import RecordTable
from ..language.events import ANYTHING, Matcher, matcher, stretch_of
from ..language.language import measure_of
from ..language.scope import BadEvent, scope_of_table
from .pair import FIRST, SECOND, START, Between

Ticks = NDArray[np.int64]


class Durations(NamedTuple):
    """Times between pairs of events, in ticks.

    duration: from the first event to the second. start: the tick of the first event.
    """

    duration: Ticks
    start: Ticks


def between(
    table: RecordTable, begin: str, end: str, rule: str = "", transfers_in_round: int | None = None
) -> Durations:
    """Return the times from each `begin` to the `end` that belongs to it, if there is one.

    rule: the rule after the comma in a budget: "in order", "next" or "last"; "same transfer" or "same round" for pairs
    within a transfer or round, which lasts from its START to the START of the next one; or both: "last, same transfer".
    transfers_in_round: the number of transfers in a round; needed for "same round", because no record contains it.

    Raise BadEvent if a text names no event, or an event that this run cannot contain. Raise it also if a second `begin`
    comes before the `end` of the first one and no rule says which of them the `end` belongs to.
    """
    said = measure_of(f"from {begin} to {end}, {rule}" if rule else f"from {begin} to {end}")
    group = said.group
    if group == "unit" or said.clauses:
        raise BadEvent(f"{rule!r}: over a recorded run a rule is in order, next, last, same transfer or same round")
    scope = scope_of_table(table)
    first, second = (matcher(event, scope) for event in said.events)
    events = [(row, FIRST) for row in rows_of(first, table).tolist()]
    events += [(row, SECOND) for row in rows_of(second, table).tolist()]
    stretch = stretch_of(group, scope, f"'same {group}'") if group else None
    if stretch is not None:
        starts = rows_of(stretch.begin, table)
        if group == "round":
            if transfers_in_round is None or transfers_in_round < 1:
                raise BadEvent("same round needs transfers_in_round, 1 or more: no record says how many a round has")
            starts = starts[::transfers_in_round]
        events += [(row, START) for row in starts.tolist()]
    measure = Between(first, second, said.pairing, stretch)
    measure.keep()
    # If one record is several events, a START comes first, then the end of a pair, then the begin of the next pair.
    for row, place in sorted(events, key=lambda event: (event[0], -event[1])):
        measure.happened(place, int(table.tick[row]), 0)
    if measure.again is not None:
        raise BadEvent(
            f"{begin!r} of tick {measure.again[0]} came again before {end!r}, so it is not known which belong "
            "together; give the rule in order, next or last"
        )
    return Durations(*measure.all_kept())


def rows_of(matcher: Matcher, table: RecordTable) -> NDArray[np.int64]:
    """Return the rows at which an event happened, in order.

    Raise BadEvent for the n-th event of a group, which only a budget can find.
    """
    if matcher.group is not None:
        raise BadEvent(f"{matcher.text!r}: over a recorded run every one is found; leave first, last or the number out")
    found = np.zeros(len(table), bool)
    for one in matcher.each:
        what = None if one.what == ANYTHING else frozenset((one.what,))
        wanted = _named(table, "kind", frozenset((one.kind.value,))) & _named(table, "what", what)
        found |= wanted & _named(table, "where", one.where) & (table.value & one.mask == one.want)
    return np.flatnonzero(found)


def _named(table: RecordTable, column: str, names: frozenset[str] | None) -> NDArray[np.bool_]:
    if names is None:
        return np.ones(len(table), bool)
    known = np.array([name in names for name in table.names[column]], bool)
    return known[table.columns[column]] if len(known) else np.zeros(len(table), bool)


def periods(table: RecordTable, event: str) -> Durations:
    """Return the times from each event to the next of its kind. Raise BadEvent as `between` does."""
    ticks = happened(table, event)
    return Durations(np.diff(ticks), ticks[:-1])


def happened(table: RecordTable, event: str) -> Ticks:
    """Return the ticks at which an event happened. Raise BadEvent as `between` does."""
    return table.tick[rows_of(matcher(event, scope_of_table(table)), table)]
