"""The measures of events over a recorded run, all at once: a RecordTable and events as text go in, arrays come out.

    table = formats.psr.read_table(path)
    timing.between(table, "bus address 0x68 read", "access W I2C-A.I2CDXR") --> durations and starts, int64 ticks

It finds what the budget `from EVENT to EVENT` finds while the run goes on.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core.nearest import near
from ..formats.record_table import RecordTable
from .events import matcher, matcher_for, start_of_transfer
from .language import RULES
from .names import BadEvent, scope_of_table

Ticks = NDArray[np.int64]


class Durations(NamedTuple):
    """duration: ticks from each first event to its second. start: when the first one was, the same length."""

    duration: Ticks
    start: Ticks


def between(
    table: RecordTable, begin: str, end: str, rule: str = "next", transfers_in_round: int | None = None
) -> Durations:
    """From each `begin` to the next `end` after it, where there is one.

    rule: "next", "same transfer" or "same round": then only pairs in one transfer or round count, from its START to
    the next one's. transfers_in_round: how many transfers a round has; needed for "same round", as no record says it.
    BadEvent if a text names no event, or one that this run cannot have had.
    """
    if rule not in RULES:
        raise BadEvent(f"there is no rule {rule!r}; {near(rule, RULES)}")
    scope = scope_of_table(table)
    first, second = (matcher(event, scope).rows(table) for event in (begin, end))
    following = np.searchsorted(second, first, side="right")
    answered = following < len(second)
    first, second = first[answered], second[following[answered]]
    if rule != "next":
        starts = start_of_transfer(scope).rows(table)
        if rule == "same round":
            if transfers_in_round is None or transfers_in_round < 1:
                raise BadEvent("same round needs transfers_in_round, 1 or more: no record says how many a round has")
            starts = starts[::transfers_in_round]
        group = np.searchsorted(starts, first, side="right")
        same = (group > 0) & (group == np.searchsorted(starts, second, side="right"))
        first, second = first[same], second[same]
    return Durations(table.tick[second] - table.tick[first], table.tick[first])


def periods(table: RecordTable, event: str) -> Durations:
    """From each event to the next of its kind. BadEvent as for `between`."""
    ticks = happened(table, event)
    return Durations(np.diff(ticks), ticks[:-1])


def happened(table: RecordTable, event: str) -> Ticks:
    """The ticks at which an event happened. BadEvent as for `between`."""
    return table.tick[matcher_for(event, table).rows(table)]
