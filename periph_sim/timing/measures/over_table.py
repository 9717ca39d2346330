"""Measures of events over a recorded run, as arrays.

    table = formats.psr.read_table(path)
    timing.between(table, "bus address 0x68 read", "access W I2C-A.I2CDXR") --> durations and starts, int64 ticks

It finds what the budget `from EVENT to EVENT` finds while the run goes on.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...core.suggest import did_you_mean
from ...traces.formats.record_table import RecordTable
from ..language.events import Matcher, matcher, stretch_of
from ..language.scope import BadEvent, scope_of_table
from .pair import PAIRINGS

SAME = ("same transfer", "same round")

Ticks = NDArray[np.int64]


class Durations(NamedTuple):
    """duration: ticks from each first event to its second. start: when the first one was, the same length."""

    duration: Ticks
    start: Ticks


def between(
    table: RecordTable, begin: str, end: str, rule: str = "", transfers_in_round: int | None = None
) -> Durations:
    """Return the times from each `begin` to the `end` that belongs to it, if there is one.

    rule: as after the comma in a budget: "in order", "next" or "last"; "same transfer" or "same round" for pairs within
    one of them, from its START to the next one's; or both: "last, same transfer". transfers_in_round: how many
    transfers a round has; needed for "same round", as no record says it. BadEvent if a text names no event, or one that
    this run cannot have had, or if a second `begin` comes before the `end` of the first and no rule says what then.
    """
    pairing, group = _rules(rule)
    scope = scope_of_table(table)
    first, second = (rows_of(matcher(event, scope), table) for event in (begin, end))
    starts = np.empty(0, np.int64)
    if group:
        starts = rows_of(stretch_of(group, scope).begin, table)
        if group == "round":
            if transfers_in_round is None or transfers_in_round < 1:
                raise BadEvent("same round needs transfers_in_round, 1 or more: no record says how many a round has")
            starts = starts[::transfers_in_round]
        first = first[np.searchsorted(starts, first, side="right") > 0]
    if pairing == "in order":
        first, second = _in_order(first, second, starts)
        return Durations(table.tick[second] - table.tick[first], table.tick[first])
    following = np.searchsorted(second, first, side="right")
    groups = np.searchsorted(starts, first, side="right")
    shared = (following[1:] == following[:-1]) & (groups[1:] == groups[:-1])
    if shared.any() and not pairing:
        at = table.tick[first[:-1][shared][0]]
        raise BadEvent(
            f"{begin!r} of tick {at} came again before {end!r}, so it is not known which belong together; "
            "give the rule in order, next or last"
        )
    answered = following < len(second)
    if pairing == "last":
        answered[:-1] &= ~shared
    first, second = first[answered], second[following[answered]]
    same = np.searchsorted(starts, first, side="right") == np.searchsorted(starts, second, side="right")
    first, second = first[same], second[same]
    return Durations(table.tick[second] - table.tick[first], table.tick[first])


def rows_of(matcher: Matcher, table: RecordTable) -> NDArray[np.int64]:
    """Return the rows at which an event happened, in order.

    Raise BadEvent for the n-th event of a group, which only a budget can find.
    """
    if matcher.group is not None:
        raise BadEvent(f"{matcher.text!r}: over a recorded run every one is found; leave first, last or the number out")
    found = np.zeros(len(table), bool)
    for one in matcher.each:
        wanted = _named(table, "kind", frozenset((one.kind.value,))) & _named(table, "what", frozenset((one.what,)))
        found |= wanted & _named(table, "where", one.where) & (table.value & one.mask == one.want)
    return np.flatnonzero(found)


def _named(table: RecordTable, column: str, names: frozenset[str] | None) -> NDArray[np.bool_]:
    if names is None:
        return np.ones(len(table), bool)
    known = np.array([name in names for name in table.names[column]], bool)
    return known[table.columns[column]] if len(known) else np.zeros(len(table), bool)


def _rules(rule: str) -> tuple[str, str]:
    """Return (pairing, group)."""
    pairing = group = ""
    for word in filter(None, (part.strip() for part in rule.split(","))):
        if word in PAIRINGS and not pairing:
            pairing = word
        elif word in SAME and not group:
            group = word.removeprefix("same ")
        else:
            raise BadEvent(f"there is no rule {word!r} here; {did_you_mean(word, (*PAIRINGS, *SAME))}")
    return pairing, group


def _in_order(first: Ticks, second: Ticks, starts: Ticks) -> tuple[Ticks, Ticks]:
    """Return the rows of pairs, the n-th with the n-th. An event that waits as a group begins has no partner."""
    waiting: deque[int] = deque()
    pairs: list[tuple[int, int]] = []
    events = [(row, 0) for row in starts.tolist()] + [(row, 1) for row in second.tolist()]
    for row, what in sorted(events + [(row, 2) for row in first.tolist()]):
        if what == 0:
            waiting.clear()
        elif what == 2:
            waiting.append(row)
        elif waiting:
            pairs.append((waiting.popleft(), row))
    ones = np.array(pairs, np.int64).reshape(-1, 2)
    ones = ones[np.argsort(ones[:, 0], kind="stable")]
    return ones[:, 0], ones[:, 1]


def periods(table: RecordTable, event: str) -> Durations:
    """Return the times from each event to the next of its kind. BadEvent as for `between`."""
    ticks = happened(table, event)
    return Durations(np.diff(ticks), ticks[:-1])


def happened(table: RecordTable, event: str) -> Ticks:
    """Return the ticks at which an event happened. BadEvent as for `between`."""
    return table.tick[rows_of(matcher(event, scope_of_table(table)), table)]
