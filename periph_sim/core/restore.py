"""Restoring of a snapshot in the modules of a scene that was built from the same case.

    snapshot --plan: each value made or found--> assignments --apply--> modules

Attributes are assigned only after all values of the snapshot have been made or found, so a snapshot that does not fit
changes nothing. If the scene has an object of the same class in the same attribute, that object is kept with its
wiring, and only its declared attributes are set. Other objects are created.
"""

from __future__ import annotations

from array import array
from collections import deque
from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from random import Random
from typing import Any

from msgspec import Struct

from .snapshot import (
    ARRAY,
    Foreign,
    Found,
    FunctionRef,
    Made,
    Module,
    PlainContainer,
    Ref,
    Snapshot,
    absolute,
    class_name,
)
from .state import Time, state_of

CONTAINERS: dict[str, Callable[[Any], Any]] = {
    one.__name__: one for one in (list, tuple, deque, set, frozenset, dict, bytearray)
}


class NotRestorable(ValueError):
    """A snapshot that does not fit the scene or cannot be restored. The message is one sentence."""


def restore(snapshot: Snapshot, modules: Mapping[str, Module]) -> None:
    """Set each declared attribute of these modules that has a value in the snapshot.

    Raise NotRestorable, with nothing changed, if any attribute cannot be set.
    """
    _Plan(snapshot, modules).apply()


class _Plan:
    """The assignments that restore a snapshot. `_objects` has the scene's object for each name in the snapshot."""

    def __init__(self, snapshot: Snapshot, modules: Mapping[str, Module]) -> None:
        self._values = snapshot.values
        self._cycles = snapshot.cycles
        self._finds: dict[str, Callable[..., object]] = {}  # maps the name of a class to its `Keyed.find`
        self._now = {Time.TICKS: snapshot.tick, Time.RECORDS: snapshot.number}
        self._objects: dict[str, Any] = {name: module.target for name, module in modules.items()}
        self._used = {id(module.target) for module in modules.values()}  # ids of the objects that already have a name
        self._assigned: list[tuple[Any, str, Any]] = []
        self._randoms: list[tuple[Random, Any]] = []
        others = sorted(self._cycles.keys() ^ modules.keys())
        if others:
            raise NotRestorable(f"only one of the snapshot and the scene has {' and '.join(others)}")
        for name, module in modules.items():
            self._finds = {class_name(kind): keyed.find for kind, keyed in module.keys.items()}
            self._now[Time.CYCLES] = self._cycles[name]
            self._attributes(name, module.target)

    def apply(self) -> None:
        """Make all assignments, then call `restored` of each assigned object that has this method."""
        for random, state in self._randoms:
            random.setstate(state)
        for target, attribute, value in self._assigned:
            if getattr(target, attribute, self) is not value:
                setattr(target, attribute, value)
        for target in {id(one): one for one, _, _ in self._assigned}.values():
            if hasattr(target, "restored"):
                target.restored()

    def _attributes(self, name: str, target: Any) -> None:
        state = state_of(type(target))
        assert state is not None
        kind = class_name(type(target))
        if self._values[name] != Made(kind):
            raise NotRestorable(f"{name} is a {self._values[name].kind} in the snapshot and a {kind} in the scene")
        self._objects[name] = target
        self._used.add(id(target))
        for attribute, time in state.times.items():
            place = f"{name}.{attribute}"
            if place in self._values:
                value = self._value(place, getattr(target, attribute, None), time)
                self._assigned.append((target, attribute, value))

    def _value(self, name: str, current: Any, time: Time) -> Any:
        """Return the object to assign for the snapshot's value of this name. current: the scene's present object."""
        value = self._values[name]
        match value:
            case Foreign(kind):
                raise NotRestorable(f"{name} is a {kind}, which declares no state, so it cannot be restored")
            case Ref(owner, method):
                return getattr(self._objects[owner], method) if method else self._objects[owner]
            case Found(kind, key):
                return self._finds[kind](*key)
            case FunctionRef(function):
                if getattr(current, "__qualname__", "") != function:
                    raise NotRestorable(
                        f"{name} is the function {function}, which the scene does not have in its place"
                    )
                return current
            case PlainContainer(kind, items):
                self._objects[name] = made = self._group(kind, items, current, time)
                return made
            case Made(kind, keys):
                return self._made(name, kind, keys, current, time)
        return value if time is Time.NONE else absolute(value, self._now[time])

    def _group(self, kind: str, items: tuple[Any, ...], current: Any, time: Time) -> Any:
        if kind == "Random":
            random = current if isinstance(current, Random) else Random()
            self._randoms.append((random, items))
            return random
        whole = items if time is Time.NONE else [absolute(one, self._now[time]) for one in items]
        return array(kind[-1], whole) if kind.startswith(ARRAY) else CONTAINERS[kind](whole)

    def _made(self, name: str, kind: str, keys: tuple[object, ...], current: Any, time: Time) -> Any:
        if kind == "chain":
            return self._chain(name, keys, current, time)
        if kind == "method":
            owner = self._value(f"{name}.owner", getattr(current, "__self__", None), Time.NONE)
            return getattr(owner, str(keys[0]))
        if kind in CONTAINERS or kind == "partial" or keys:
            self._objects[name] = made = self._items(name, kind, keys, current, time)
            return made
        if current is None or class_name(type(current)) != kind or id(current) in self._used:
            current = self._new(name, kind)
        self._attributes(name, current)
        return current

    def _new(self, name: str, kind: str) -> Any:
        """Return a new object of a class; its attributes are not set yet.

        Raise NotRestorable if the class does not declare in STATE that its attributes are complete (`State.made`).
        """
        cls = _class_of(kind)
        state = state_of(cls)
        if state is None or not state.made:
            raise NotRestorable(f"{name} is a {kind} in the snapshot, and the scene has none in its place")
        return cls.__new__(cls)

    def _items(self, name: str, kind: str, keys: tuple[object, ...], current: Any, time: Time) -> Any:
        cls: Any = CONTAINERS.get(kind) or (partial if kind == "partial" else _class_of(kind))
        state = state_of(cls)
        times = {} if state is None else state.times
        items = [self._value(f"{name}[{key!r}]", _item_of(current, key), times.get(str(key), time)) for key in keys]
        if cls is dict:
            return dict(zip(keys, items, strict=True))
        if cls is partial:
            function, arguments, keywords = items
            return partial(function, *arguments, **keywords)
        return cls(items) if kind in CONTAINERS else cls(*items)

    def _chain(self, name: str, keys: tuple[object, ...], current: Any, time: Time) -> Any:
        elements = []
        for key in keys:
            elements.append(self._value(f"{name}[{key!r}]", current, time))
            current = getattr(current, "following", None)
        for element, following in zip(elements, [*elements[1:], None], strict=False):
            self._assigned.append((element, "following", following))
        return elements[0] if elements else None


def _class_of(name: str) -> Any:
    """Return the class for which `class_name` returns this name."""
    parts = name.split(".")
    inside = next(place for place, part in enumerate(parts) if part.lstrip("_")[0].isupper())
    found: Any = import_module(".".join(parts[:inside]))
    for part in parts[inside:]:
        found = getattr(found, part)
    return found


def _item_of(current: Any, key: Any) -> Any:
    """Return the item with this key in a container or structure of the scene; None if there is none."""
    if isinstance(current, Struct | tuple) and isinstance(key, str):
        return getattr(current, key, None)
    try:
        return current[key]
    except (TypeError, KeyError, IndexError):
        return None
