"""Normal states of scenes. If the normal states at two times are equal, the scene continues equally from both.

    modules --NormalCollector--> {"dsp.SCI-A.chip._rx": ("SciRx", (0, 12, ...)), ...} --> digest

A snapshot (`core.snapshot`) contains everything that a restored scene needs to go on, but also values that have no
effect any more: counters, instants of the past, and the instants at which periodic grids began. The classes declare
which of their attributes these are (`core.state`: results, expires, grids). A normal state is a snapshot without them.
A class that needs more has a method `normal_state(cycle, tick)`, which returns the values to compare instead of its
attributes, by name. For example, the name `_bits.next_tick` is that of attribute `next_tick` of attribute `_bits`.

If a declaration is missing, equal states can look different. Then a table cannot be closed, but no proof is wrong. If a
declaration is wrong, or if an attribute contains an instant that is not declared as one, different states can look
equal. To find such mistakes, tests change what normal states leave out, and closed tables run entries again.
"""

# core: compiled

from __future__ import annotations

from array import array
from collections import deque
from collections.abc import Callable, Collection, Mapping
from functools import partial
from hashlib import blake2b
from math import lcm
from operator import attrgetter
from random import Random
from typing import Any, NamedTuple

from ..core.agent import Event
from ..core.chip import NEVER
from ..core.snapshot import PLAIN, Collector, Fixed, Foreign, Module, class_name
from ..core.state import State, Time, state_of
from ..scene.scene import Scene
from ..scene.state import modules_of

EXPIRED = "expired"  # replaces an instant that is long past
LONG_PAST = 1000  # an instant is long past after 1 / LONG_PAST seconds, so 1 ms
DIGEST = 16  # length of a digest, in bytes

NormalState = dict[str, object]


class NotComparable(Exception):
    """Error: a part of a scene declares no state, so the states of the scene cannot be compared."""


class AttributePlan(NamedTuple):
    """The way in which the attributes of the objects of a class are collected for the normal state.

    kind: the name of the class.
    state: the `State` object in which the class lists its attributes.
    normalises: True if the class has a method `normal_state`.
    names: the attributes that are stored unchanged, if their values are plain.
    values: a function that returns the values of `names` for an object.
    others: the other attributes, each as (name, unit of its instants, is special). Special attributes are listed in
        `state.grids`, `expires` or `chains`, and `NormalCollector.collect` collects them; `_value` collects the others.
    """

    kind: str
    state: State
    normalises: bool
    names: tuple[str, ...]
    values: Callable[[object], Any]
    others: tuple[tuple[str, Time, bool], ...]


class NormalCollector(Collector):
    """Collects the normal state of modules.

    modules: the modules, by name. tick: the present tick.
    long_past: for each unit of time, the age from which on an instant is long past.
    ignored: the names of attributes that are left out.
    periods: the period in cycles of each periodic process, such as the sampling of an SCI, by the name of the attribute
        with the cycle at which one of its periods began (`State.grids`).
    """

    def __init__(
        self, modules: Mapping[str, Module], tick: int, long_past: Mapping[Time, int], ignored: Collection[str]
    ) -> None:
        self._long_past = long_past
        self._ignored = ignored
        self._owners = {name.rpartition(".")[0] for name in ignored}
        self._instead: dict[int, dict[str, object]] = {}  # [id of an object][attribute]: value to store instead
        self.periods: dict[str, int] = {}
        Collector.__init__(self, modules, tick, 0)

    def attributes(self, name: str, target: object) -> None:
        """Store the attributes of an object. name: the name of the object in the normal state."""
        kind = type(target)
        instead: dict[str, object] = self._instead.get(id(target), NOTHING)
        plan: AttributePlan | None = _plans.get(kind) if not instead else None
        if plan is None or plan.normalises:
            if hasattr(target, "normal_state"):
                self._normalise(target)
                instead = self._instead.get(id(target), NOTHING)
            key: object = (kind, frozenset(instead)) if instead else kind
            if key not in _plans:
                _plans[key] = _plan(kind, instead)
            plan = _plans[key]
        assert plan is not None
        values: Any
        try:
            values = plan.values(target)
        except AttributeError:  # some attributes are not set yet
            values = [getattr(target, attribute, None) for attribute in plan.names]
        stored: list[object] = [plan.kind, *values]
        self.values[name] = stored
        if name in self._owners or not {*map(type, values)} <= PLAIN:
            for number, value in enumerate(values):
                attribute = plan.names[number]
                if type(value) not in PLAIN:
                    stored[number + 1] = ""
                    self._value(f"{name}.{attribute}", value, Time.NONE)
                elif f"{name}.{attribute}" in self._ignored:
                    stored[number + 1] = None
        for attribute, time, is_special in plan.others:
            found: Any = getattr(target, attribute, NOT_SET)
            if found is NOT_SET:
                continue
            if is_special:
                self.collect(f"{name}.{attribute}", target, attribute, plan.state)
            else:
                self._value(f"{name}.{attribute}", found, time)
        for attribute, other in instead.items():
            self.values[f"{name}.{attribute}"] = other

    def _normalise(self, target: Any) -> None:
        """Call the method `normal_state` of an object, and note the values that it returns for `_instead`."""
        for path, value in target.normal_state(self.now[Time.CYCLES], self.now[Time.TICKS]).items():
            *parts, attribute = path.split(".")
            owner: object = target
            for part in parts:
                owner = getattr(owner, part)
            self._instead.setdefault(id(owner), {})[attribute] = value

    def collect(self, place: str, target: object, attribute: str, state: State) -> None:
        """Store an attribute: modulo its period, as EXPIRED if it is long past, else as `Collector.collect` does."""
        time, value = state.times[attribute], getattr(target, attribute)
        if attribute in state.grids:
            self.values[place] = self._on_grid(place, value, getattr(target, state.grids[attribute]), time)
        elif attribute in state.expires:
            self.values[place] = self._expiring(value, time)
        else:
            Collector.collect(self, place, target, attribute, state)

    def _value(self, name: str, value: Any, time: Time) -> None:
        kind = type(value)
        if kind in PLAIN:  # checked first, because most values are plain
            self.values[name] = value if time is Time.NONE else self._relative(value, time)
        elif kind is Event and not value.queued:
            self.values[name] = "not queued"
        elif id(value) in self._names:
            self.values[name] = ("reference", self._names[id(value)])
        elif kind in _plans and not self._in_chain and kind not in self._module.keys:
            self._names[id(value)] = name
            self._named.append(value)
            self.attributes(name, value)
        elif kind is Random:
            _, numbers, gauss_next = value.getstate()
            self.values[name] = ("Random", hash(numbers), gauss_next)
        else:
            Collector._value(self, name, value, time)

    def _container(self, name: str, value: Any, time: Time) -> None:
        kind = type(value)
        if kind is array or kind is bytearray:
            self.values[name] = (kind.__name__, blake2b(value, digest_size=DIGEST).digest())
        elif kind in SEQUENCES and {*map(type, value)} <= PLAIN:
            items = value if time is Time.NONE else [self._relative(one, time) for one in value]
            self.values[name] = (kind.__name__, *items)
        else:
            Collector._container(self, name, value, time)

    def _relative(self, value: Any, time: Time) -> Any:
        if type(value) is int and 0 < value < NEVER:  # most instants; other values can have a special meaning
            return value - self.now[time]
        found = Collector._relative(self, value, time)
        return tuple(found) if isinstance(found, Fixed) else found

    def _on_grid(self, place: str, value: Any, period: Any, time: Time) -> Any:
        """Return the time since the present period began. value: an instant at which a period began, or a list."""
        if isinstance(value, list):
            pairs = enumerate(zip(value, period, strict=True))
            return tuple([self._on_grid(f"{place}[{n}]", one, each, time) for n, (one, each) in pairs])
        if not period or abs(value) >= NEVER:
            return value
        if time is Time.CYCLES:
            self.periods[place] = period
        return (self.now[time] - value) % period

    def _expiring(self, value: Any, time: Time) -> Any:
        """Return an instant relative to now, or EXPIRED if it is long past. value: an instant, or a container."""
        if isinstance(value, dict):
            left = {key: self._expiring(one, time) for key, one in value.items()}
            return tuple(sorted((key, one) for key, one in left.items() if one != EXPIRED))
        if isinstance(value, list | tuple):
            return tuple([self._expiring(one, time) for one in value])
        if value is None or abs(value) >= NEVER:
            return value
        return EXPIRED if value - self.now[time] < -self._long_past[time] else value - self.now[time]


def _plan(kind: type, instead: Collection[str]) -> AttributePlan:
    """Return the plan of a class. instead: the attributes for which a method `normal_state` returned other values."""
    state = state_of(kind)
    assert state is not None, f"{kind.__name__} declares no state"
    left_out = {*state.results, *instead}
    counts = [name for name, time in state.times.items() if name not in left_out and time is not Time.RECORDS]
    special = {*state.grids, *state.expires, *state.chains}
    plain = tuple(name for name in counts if name not in special and state.times[name] is Time.NONE)
    values: Callable[[object], Any] = _no_values
    if plain:
        values = attrgetter(*plain) if len(plain) > 1 else partial(_one_value, plain[0])
    others = tuple([(name, state.times[name], name in special) for name in counts if name not in plain])
    return AttributePlan(class_name(kind), state, hasattr(kind, "normal_state"), plain, values, others)


def _no_values(target: object) -> Any:
    return ()


def _one_value(attribute: str, target: object) -> Any:
    return (getattr(target, attribute),)


NOTHING: dict[str, object] = {}
NOT_SET = object()
SEQUENCES = (list, tuple, deque)
_plans: dict[object, AttributePlan] = {}  # by the class, or by (class, names of attributes with other values)


def normal_state(scene: Scene, ignored: Collection[str] = ()) -> NormalState:
    """Return the normal state of a scene that is not running now, by the names of its parts.

    ignored: the names of attributes that are left out. Raise NotComparable if a part declares no state.
    """
    return _collected(scene, ignored).values


def periods_of(scene: Scene) -> dict[str, int]:
    """Return the period in cycles of each periodic process of a scene, such as the sampling of an SCI.

    The keys of the result are names of attributes: such an attribute has a cycle at which a period began.
    """
    return _collected(scene, ()).periods


def period_of(scene: Scene) -> int:
    """Return the number of cycles after which all periodic processes of a scene repeat: the period of an orbit."""
    return lcm(*periods_of(scene).values())


def _collected(scene: Scene, ignored: Collection[str]) -> NormalCollector:
    scene.kernel.settle()
    per_second = scene.timebase.per_second
    cycles = max((int(dsp.clock.hz) for dsp in scene.units.values()), default=per_second)
    long_past = {Time.TICKS: per_second // LONG_PAST, Time.CYCLES: cycles // LONG_PAST}
    found = NormalCollector(modules_of(scene), scene.kernel.now, long_past, ignored)
    for name, value in found.values.items():
        if isinstance(value, Foreign):
            raise NotComparable(f"{name} is a {value.kind}, which declares no state")
    return found


def digest(state: NormalState) -> bytes:
    """Return a digest of a normal state. Equal states have equal digests."""
    text = " ".join(state) + repr(list(state.values()))
    return blake2b(text.encode(), digest_size=DIGEST).digest()


def differences(one: NormalState, other: NormalState) -> list[str]:
    """Return the names of the attributes in which two normal states differ."""
    found: list[str] = []
    plans = {(plan.kind, len(plan.names)): plan for plan in _plans.values()}
    for name in {**one, **other}:
        here, there = one.get(name), other.get(name)
        if here == there:
            continue
        if isinstance(here, list) and isinstance(there, list) and here[0] == there[0]:
            names = plans[str(here[0]), len(here) - 1].names
            pairs = zip(names, here[1:], there[1:], strict=True)
            found += [f"{name}.{attribute}" for attribute, before, after in pairs if before != after]
        else:
            found.append(name)
    return found
