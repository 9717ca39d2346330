"""Declared state: each class lists once the attributes that determine the future behaviour of its objects.

    class Receiver:
        STATE = State("word level", cycles="_start due")    # `_start` and `due` are instants, in cycles

Attributes that are not in the list are wiring (made when the scene is built), caches, or history (read only by
reports). Snapshots (`core.snapshot`), their comparison and restoring (`core.restore`) are based on these lists.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum


class Time(Enum):
    """Unit of the instants that an attribute contains as integers; NONE for attributes without instants."""

    NONE = "no time"
    TICKS = "ticks of the kernel"
    CYCLES = "cycles of the unit's clock"
    RECORDS = "numbers of records"

    __hash__ = object.__hash__  # the hash method of Enum is slow, and a normal state needs hundreds of hashes


class State:
    """The attributes of a class that are its state. Arguments that are texts are names with spaces between them.

    plain: attributes that are values, objects with declared state, containers of values or objects, or callbacks.
    ticks, cycles, records: integers, or containers of integers, that a snapshot stores relative to the present tick,
        the present cycle or the number of the last record.
    chains: attributes with the first element of a linked list. The attribute `following` of each element leads to the
        next one.
    made: True if the attributes are complete, so that restoring can create an object of the class from them.

    Some of these attributes may differ between two states with the same future. `proof.normal_state` uses these lists:

    results: attributes that only reports read, and data that only makes the simulation faster.
    expires: instants that have no effect once they are long past.
    grids: for each attribute with an instant that repeats periodically, the attribute with the period. Only the time
        from now to the next repetition has an effect. Both attributes may be lists.
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
        results: str = "",
        expires: str = "",
        grids: Mapping[str, str] | None = None,
    ) -> None:
        self.made = made
        self.results = frozenset(results.split())
        self.expires = frozenset(expires.split())
        self.grids = dict(grids or {})
        self.times = dict.fromkeys((plain + " " + chains).split(), Time.NONE)
        for names, time in ((ticks, Time.TICKS), (cycles, Time.CYCLES), (records, Time.RECORDS)):
            self.times |= dict.fromkeys(names.split(), time)
        self.chains = frozenset(chains.split())


def state_of(kind: type) -> State | None:
    """Return the state that a class and its bases declare; None if none of them declares any."""
    if kind not in _states:
        declared = [vars(one)["STATE"] for one in reversed(kind.__mro__) if "STATE" in vars(one)]
        whole = State()
        for one in declared:
            whole.times |= one.times
            whole.chains |= one.chains
            whole.results |= one.results
            whole.expires |= one.expires
            whole.grids |= one.grids
            whole.made = one.made
        _states[kind] = whole if declared else None
    return _states[kind]


_states: dict[type, State | None] = {}
