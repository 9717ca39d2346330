"""Snapshots: the state of a simulation as plain values, one for each attribute of its named modules.

    {"SDA": wire, "dsp.SCI-A": socket, ...} --take_snapshot--> {"dsp.SCI-A.chip._rx.status": 0, ...}

The declared attributes (`core.state`) of each module are visited recursively and named by their paths. Instants are
stored relative to now. An object or method that already has a name is stored as a `Ref` to it. An object of a class
without declared state is stored as `Foreign`: it is compared by its class only and cannot be restored.
"""

# core: compiled

from __future__ import annotations

from array import array
from collections import deque
from collections.abc import Callable, Collection, Iterator, Mapping
from datetime import datetime
from enum import Enum
from fractions import Fraction
from functools import partial
from random import Random
from types import ModuleType
from typing import Any, NamedTuple

from msgspec import Struct

from .chip import NEVER
from .state import State, Time, state_of

NOT_YET = -1  # an instant that is not known yet
PLAIN = frozenset((type(None), bool, int, float, str, bytes, Fraction, datetime))
OTHER_PLAIN = (Enum, int, float, str, bytes)  # objects of subclasses of these are plain, too
CONTAINERS = (list, tuple, deque, set, frozenset, dict, bytearray, array)
ARRAY = "array of "  # how the text `kind` of an array begins; the type code of the array's items follows
KEYED_BY_OBJECTS = "dict keyed by objects"


class Keyed(NamedTuple):
    """Functions for a class whose objects are not stored in a snapshot, because the scene can find them by a key.

    key_of: a function that returns the key of an object, or None if the object has no key.
    find: a function that returns the scene's object for a key; its arguments are the items of the key.
    """

    key_of: Callable[[Any], tuple[object, ...] | None]
    find: Callable[..., object]


class Module(NamedTuple):
    """A named part of a scene.

    target: the object whose declared attributes (`core.state`) are the state of the module.
    cycle: the present cycle of the module's clock; 0 for a module without a clock.
    keys: for each class whose objects the scene can find by a key, the functions that do so.
    """

    target: object
    cycle: int = 0
    keys: Mapping[type, Keyed] = {}


class Ref(NamedTuple):
    """A reference to an object that has a name already, or to a method of this object."""

    name: str
    method: str = ""


class Found(NamedTuple):
    """A reference to an object that the scene finds by a key (see `Keyed`), so that the object itself is not stored.

    For example, the key of the object that describes an access has the address of the access.
    """

    kind: str
    key: tuple[object, ...]


class Made(NamedTuple):
    """The entry of an object or container in a snapshot. Each of its attributes or items has an entry of its own.

    keys: the keys, indices or field names of the items, or the name of a method; empty for an object with declared
        state (`core.state`).
    """

    kind: str
    keys: tuple[object, ...] = ()


class PlainContainer(NamedTuple):
    """A container of plain values, or a random generator.

    items: the values of the container, the pairs (key, value) of a dict, or the state of the generator.
    """

    kind: str
    items: tuple[Any, ...]


class FunctionRef(NamedTuple):
    """A reference to a function of a Python module. name: the function's qualified name."""

    name: str


class Fixed(NamedTuple):
    """A special value in place of a tick, cycle or record number. It is stored as it is, not relative to now.

    value: None, NOT_YET, or a number of magnitude NEVER or more. In a record number, 0 (no record) replaces NOT_YET.
    """

    value: int | None


class Foreign(NamedTuple):
    """An object that is not stored and cannot be restored, such as one of a class that declares no state.

    kind: the name of its class; for a method or an inner function, the qualified name; for a dictionary with keys that
        are not plain values, KEYED_BY_OBJECTS.
    """

    kind: str


class Absent(NamedTuple):
    """Placeholder, in the comparison of two snapshots, for a value that one of the snapshots does not have."""


class Snapshot(NamedTuple):
    """The state of a scene between two runs.

    identity: pairs of a name and a text that must be equal in the scene into which the snapshot is restored.
    tick: the time of the kernel.
    number: the number of the last record.
    cycles: for each module, its present cycle; 0 for a module without a clock.
    values: the values of the collected attributes and items, by their names.
    logs: for each unit that runs C sources, the log of their accesses. The stack of such a program is restored by
        executing the program again with this log.
    base: the snapshot of a checkpoint, an earlier instant of the same run; it has `logs`, and restoring can start
        there. None if the run has no checkpoint.
    """

    identity: tuple[tuple[str, str], ...]
    tick: int
    number: int
    cycles: dict[str, int]
    values: dict[str, Any]
    logs: Mapping[str, Any] = {}
    base: Snapshot | None = None

    def differences(self, other: Snapshot) -> dict[str, tuple[object, object]]:
        """Return the values that differ, as a dictionary from their names to pairs (value here, value in `other`)."""
        found: dict[str, tuple[object, object]] = {}
        for name in {**self.values, **other.values}:
            here, there = (one.values.get(name, Absent()) for one in (self, other))
            if here != there:
                found |= _item_differences(name, here, there)
        return found


def take_snapshot(
    modules: Mapping[str, Module], tick: int, number: int, identity: tuple[tuple[str, str], ...]
) -> Snapshot:
    """Return the state of these modules at tick `tick`, without changing them.

    number: the number of the last record.
    """
    collector = Collector(modules, tick, number)
    return Snapshot(identity, tick, number, {name: one.cycle for name, one in modules.items()}, collector.values)


def class_name(kind: type) -> str:
    """Return the name of a class with its module, as in "periph_sim.core.wire.Pin"."""
    return f"{kind.__module__}.{kind.__qualname__}"


def absolute(value: Any, now: int) -> Any:
    """Return the absolute instant of a value that a snapshot stores relative to `now`.

    In a tuple, only the first number is an instant; the other items are returned unchanged.
    """
    if isinstance(value, Fixed):
        return value.value
    if isinstance(value, tuple):
        place = _first_instant(value)
        return (*value[:place], absolute(value[place], now), *value[place + 1 :])
    return value + now


class Collector:
    """Visits modules recursively and collects their state.

    values: the collected values, by their names. Instants in them are relative to `now`.
    now: the present instant in each unit of time, as a tick, a cycle and a record number. The cycle is that of the
        visited module's clock, so it is set again for each module.
    """

    def __init__(self, modules: Mapping[str, Module], tick: int, number: int) -> None:
        self.values: dict[str, Any] = {}
        self._names = {id(module.target): name for name, module in modules.items()}
        self._named: list[object] = []  # keeps the named objects alive, so that their ids stay unique
        self._module: Module = Module(None)
        self._in_chain = False
        self.now = {Time.TICKS: tick, Time.RECORDS: number}
        for name, module in modules.items():
            self._module = module
            self.now[Time.CYCLES] = module.cycle
            self.attributes(name, module.target)

    def attributes(self, name: str, target: object) -> None:
        """Collect the declared attributes of an object. An attribute that is not set yet has no entry."""
        state = state_of(type(target))
        assert state is not None, f"{name} is a {type(target).__name__}, which declares no state"
        self.values[name] = Made(class_name(type(target)))
        for attribute in state.times:
            if hasattr(target, attribute):
                self.collect(f"{name}.{attribute}", target, attribute, state)

    def collect(self, place: str, target: object, attribute: str, state: State) -> None:
        """Collect one declared attribute of an object. place: its name in the snapshot."""
        value, time = getattr(target, attribute), state.times[attribute]
        if attribute in state.chains:
            self._in_chain = True
            self._items(place, "chain", dict(enumerate(_chained(value))), time)
            self._in_chain = False
        else:
            self._value(place, value, time)

    def _value(self, name: str, value: Any, time: Time) -> None:
        kind = type(value)
        if kind in PLAIN or isinstance(value, Enum):
            self.values[name] = self._relative(value, time)
        elif id(value) in self._names:
            self.values[name] = Ref(self._names[id(value)])
        elif kind in self._module.keys:
            key = self._module.keys[kind].key_of(value)
            self.values[name] = Foreign(class_name(kind)) if key is None else Found(class_name(kind), key)
        elif isinstance(value, partial):
            parts = {"func": value.func, "args": value.args, "keywords": value.keywords}
            self._items(name, "partial", parts, time)
        elif callable(value) and hasattr(value, "__name__"):
            self._function(name, value)
        else:
            self._names[id(value)] = name
            self._named.append(value)
            if kind in CONTAINERS:
                self._container(name, value, time)
            else:
                self._object(name, value, time)

    def _container(self, name: str, value: Any, time: Time) -> None:
        kind, items = type(value).__name__, list(value.items() if isinstance(value, dict) else value)
        if isinstance(value, array):
            kind = f"{ARRAY}{value.typecode}"
        if _are_plain(value) and (not isinstance(value, dict) or _are_plain(value.values())):
            if isinstance(value, set | frozenset):
                items.sort()
            if time is not Time.NONE:
                items = [self._relative(one, time) for one in items]
            self.values[name] = PlainContainer(kind, tuple(items))
        else:
            self._items(name, kind, value if isinstance(value, dict) else dict(enumerate(items)), time)

    def _items(self, name: str, kind: str, items: Mapping[Any, object], time: Time) -> None:
        if not _are_plain(items):
            self.values[name] = Foreign(KEYED_BY_OBJECTS)
            return
        self.values[name] = Made(kind, tuple(items))
        for key, value in items.items():
            self._value(f"{name}[{key!r}]", value, time)

    def _object(self, name: str, value: Any, time: Time) -> None:
        """Collect an object that has just been named.

        An object without declared state, unless it is a tuple, a Struct or a Random, is stored as `Foreign` and loses
        its name. The same is done for an object in a linked list whose class does not declare `made`, because the place
        of an object in the list may change.
        """
        kind = type(value)
        state = state_of(kind)
        if isinstance(value, Random):
            self.values[name] = PlainContainer("Random", value.getstate())
        elif isinstance(value, str) or (_is_plain(value) and time is Time.NONE):
            self.values[name] = value
        elif isinstance(value, tuple | Struct):
            fields = value.__struct_fields__ if isinstance(value, Struct) else getattr(value, "_fields", ())
            times = {} if state is None else state.times
            self.values[name] = Made(class_name(kind), fields)
            for field in fields:
                self._value(f"{name}[{field!r}]", getattr(value, field), times.get(field, time))
        elif state is not None and (state.made or not self._in_chain):
            self.attributes(name, value)
        else:
            del self._names[id(value)]
            self.values[name] = Foreign(class_name(kind))

    def _function(self, name: str, value: Any) -> None:
        """Collect a method or a function.

        A method is stored as a reference to its owner, which gets a name if it has none. A function is stored by name.
        An inner function with a closure, and a method whose owner cannot be stored, become `Foreign`.
        """
        owner = getattr(value, "__self__", None)
        if owner is None or isinstance(owner, ModuleType):
            kind = Foreign if getattr(value, "__closure__", None) else FunctionRef
            self.values[name] = kind(value.__qualname__)
        elif id(owner) in self._names:
            self.values[name] = Ref(self._names[id(owner)], value.__name__)
        elif state_of(type(owner)) is None or self._in_chain:
            self.values[name] = Foreign(value.__qualname__)
        else:
            self.values[name] = Made("method", (value.__name__,))
            self._value(f"{name}.owner", owner, Time.NONE)

    def _relative(self, value: Any, time: Time) -> Any:
        return value if time is Time.NONE else _relative(value, self.now[time], time)


def _relative(value: Any, now: int, time: Time) -> Any:
    """Return an instant relative to `now`, or a special value as Fixed.

    In a tuple, only the first number is an instant; the other items are returned unchanged.
    """
    if isinstance(value, tuple):
        place = _first_instant(value)
        return (*value[:place], _relative(value[place], now, time), *value[place + 1 :])
    none = 0 if time is Time.RECORDS else NOT_YET
    return Fixed(value) if value is None or value == none or abs(value) >= NEVER else value - now


def _first_instant(values: tuple[Any, ...]) -> int:
    return next(place for place, one in enumerate(values) if type(one) is int or isinstance(one, Fixed))


def _is_plain(value: object) -> bool:
    if isinstance(value, tuple):
        return _are_plain(value)
    return type(value) in PLAIN or isinstance(value, OTHER_PLAIN)


def _are_plain(values: Collection[object]) -> bool:
    """Return True if all values are plain.

    The set of their types is compared with PLAIN first, which is fast for the 34,816 words of RAM.
    """
    return {*map(type, values)} <= PLAIN or all(map(_is_plain, values))


def _chained(first: Any) -> Iterator[Any]:
    while first is not None:
        yield first
        first = first.following


def _item_differences(name: str, here: Any, there: Any) -> dict[str, tuple[object, object]]:
    """Return the differences of a value in two snapshots.

    For two containers of plain values with the same type and length, these are the items that differ. For all other
    values, they are the two whole values.
    """
    both = isinstance(here, PlainContainer) and isinstance(there, PlainContainer)
    if not both or here.kind != there.kind or here.kind == "Random" or len(here.items) != len(there.items):
        return {name: (here, there)}
    pairs = enumerate(zip(here.items, there.items, strict=True))
    return {f"{name}[{place}]": pair for place, pair in pairs if pair[0] != pair[1]}
