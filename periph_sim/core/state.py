"""Declared state: each class lists once the attributes that its future depends on.

    class Receiver:
        STATE = State("word level", cycles="_start due")

An attribute that is not in the list is wiring, which the construction of the scene makes, a cache, or history that only
reports read. Snapshots (`core.snapshot`), their comparison and restoring (`core.restore`) are based on these lists.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum


class Time(Enum):
    """Kind of instants that the integers of an attribute are."""

    NONE = "no time"
    TICKS = "ticks of the kernel"
    CYCLES = "cycles of the unit's clock"
    RECORDS = "numbers of records"


class State:
    """The attributes of a class that are its state, as names with a space between them.

    plain: values, objects with a state of their own, containers of both, and callbacks.
    ticks, cycles, records: integers, or containers of them, that a snapshot keeps relative to the present one.
    chains: first elements of linked lists, whose elements have the attribute `following`.
    made: the list is complete, so that restoring can make an object.
    """

    def __init__(
        self,
        plain: str = "",
        *,
        ticks: str = "",
        cycles: str = "",
        records: str = "",
        chains: str = "",
        made: bool = False,
    ) -> None:
        self.made = made
        self.times = dict.fromkeys((plain + " " + chains).split(), Time.NONE)
        for names, time in ((ticks, Time.TICKS), (cycles, Time.CYCLES), (records, Time.RECORDS)):
            self.times |= dict.fromkeys(names.split(), time)
        self.chains = frozenset(chains.split())


def state_of(kind: type) -> State | None:
    """Return the state that a class and its bases declare; None if none of them declares any."""
    if kind not in _states:
        declared = [vars(one)["STATE"] for one in reversed(kind.__mro__) if "STATE" in vars(one)]
        _states[kind] = _whole(declared) if declared else None
    return _states[kind]


_states: dict[type, State | None] = {}


def _whole(declared: Iterable[State]) -> State:
    """Return the state that a class declares together with its bases, which come first."""
    whole = State()
    for one in declared:
        whole.times |= one.times
        whole.chains |= one.chains
        whole.made = one.made
    return whole
