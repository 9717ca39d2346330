"""Dataclasses that cost next to nothing to import: a class with annotations goes in, the same class comes out.

    @dataclass(frozen=True)
    class Span:             as `dataclasses.dataclass` makes it; but its `__init__`, `__eq__` and `__hash__` are written
        begin: int          when they are first called. Six methods of each class were an eighth of a short run.
        end: int

`dataclasses.fields`, `replace`, `asdict` and `is_dataclass` know such a class. What is asked for beyond `frozen`, `eq`
and `slots`, or of a field beyond a default, the standard library makes at once, as it does for a class with a base
that it made.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import MISSING, Field, FrozenInstanceError, make_dataclass
from typing import TYPE_CHECKING, Any

FIELDS, PARAMS = "__dataclass_fields__", "__dataclass_params__"
OWN = "__lazy_fields__"  # in a class made here: name --> (annotation, default, or a Field with its factory)

Method = Callable[..., Any]
Entries = dict[str, tuple[Any, Any]]


def _lazy_dataclass(kind: type | None = None, /, **asked: bool) -> Any:
    """The decorator, with or without arguments."""
    return (lambda one: _made(one, **asked)) if kind is None else _made(kind, **asked)


if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:
    dataclass = _lazy_dataclass


def _made(kind: type, frozen: bool = False, eq: bool = True, slots: bool = False, **others: bool) -> type:
    entries = None if others else _entries(kind)
    if entries is None:
        return dataclasses.dataclass(frozen=frozen, eq=eq, slots=slots, **others)(kind)
    own = kind.__annotations__
    for name in own:
        default = entries[name][1]
        if isinstance(default, Field):
            _put_default(kind, name, default)
    if slots:
        kind = _with_slots(kind, own, frozen)
    own_init = "__init__" in kind.__dict__
    for name, method in _methods(kind, entries, frozen, eq).items():
        if name not in kind.__dict__ or (name == "__hash__" and kind.__dict__[name] is None):
            setattr(kind, name, method)
    setattr(kind, OWN, entries)
    for name in (FIELDS, PARAMS):
        setattr(kind, name, _Later(kind, name, frozen))
    if not own_init:
        kind.__signature__ = _Signature(kind, frozen)  # type: ignore[attr-defined]
    return kind


def _entries(kind: type) -> Entries | None:
    """Every field, those of bases first; None if the standard library has to make the class."""
    entries: Entries = {}
    for base in kind.__mro__[-1:0:-1]:
        if OWN in base.__dict__:
            entries |= base.__dict__[OWN]
        elif FIELDS in base.__dict__:
            return None
    for name, hint in kind.__annotations__.items():
        default = kind.__dict__.get(name, MISSING)
        if isinstance(default, Field):
            usual = default.init and default.repr and default.compare and default.hash is None
            if not usual or default.kw_only is True:
                return None
        if not isinstance(hint, str) or "ClassVar" in hint or "InitVar" in hint or "KW_ONLY" in hint:
            return None
        entries[name] = hint, default
    return entries


def _put_default(kind: type, name: str, given: Field[Any]) -> None:
    if given.default is MISSING:
        delattr(kind, name)
    else:
        setattr(kind, name, given.default)


def _with_slots(kind: type, own: dict[str, Any], frozen: bool) -> type:
    """The class anew, with a slot for each of its fields instead of a dictionary."""
    inherited = {name for base in kind.__mro__[1:] for name in getattr(base, "__slots__", ())}
    namespace = {name: value for name, value in kind.__dict__.items() if name not in own}
    namespace["__slots__"] = tuple(name for name in own if name not in inherited)
    namespace.pop("__dict__", None)
    namespace.pop("__weakref__", None)
    if frozen:
        namespace.setdefault("__getstate__", _state)
        namespace.setdefault("__setstate__", _put_state)
    qualname = kind.__qualname__
    made = type(kind)(kind.__name__, kind.__bases__, namespace)
    made.__qualname__ = qualname
    return made


def _state(self: Any) -> list[Any]:
    return [getattr(self, name) for name in getattr(type(self), OWN)]


def _put_state(self: Any, state: list[Any]) -> None:
    for name, value in zip(getattr(type(self), OWN), state, strict=True):
        object.__setattr__(self, name, value)


def _methods(kind: Any, entries: Entries, frozen: bool, eq: bool) -> dict[str, Any]:
    """What the class gets where it has none of its own."""
    names = tuple(entries)

    def __repr__(self: Any) -> str:
        return f"{type(self).__qualname__}({', '.join([f'{name}={getattr(self, name)!r}' for name in names])})"

    found: dict[str, Any] = {"__repr__": __repr__, "__match_args__": names}
    found["__init__"] = _written_when_used(kind, "__init__", lambda: _init(kind, entries, frozen))
    if eq:
        found["__eq__"] = _written_when_used(kind, "__eq__", lambda: _eq(names))
        found["__hash__"] = _written_when_used(kind, "__hash__", lambda: _hash(names)) if frozen else None
    if frozen:

        def __setattr__(self: Any, name: str, value: object) -> None:
            if type(self) is kind or name in names:
                raise FrozenInstanceError(f"cannot assign to field {name!r}")
            super(kind, self).__setattr__(name, value)

        def __delattr__(self: Any, name: str) -> None:
            if type(self) is kind or name in names:
                raise FrozenInstanceError(f"cannot delete field {name!r}")
            super(kind, self).__delattr__(name)

        found |= {"__setattr__": __setattr__, "__delattr__": __delattr__}
    return found


def _written_when_used(kind: Any, name: str, text_of: Callable[[], tuple[str, dict[str, Any]]]) -> Method:
    """A method that puts another in its place: the one that a text says, with what its names stand for."""

    def method(self: Any, *args: Any, **kwargs: Any) -> Any:
        text, known = text_of()
        exec(text, known)
        written = known[name]
        written.__qualname__ = f"{kind.__qualname__}.{name}"
        setattr(kind, name, written)
        return written(self, *args, **kwargs)

    return method


def _eq(names: Sequence[str]) -> tuple[str, dict[str, Any]]:
    one, other = (_tuple(owner, names) for owner in ("self", "other"))
    same = f"return {one} == {other}"
    return f"def __eq__(self, other):\n if other.__class__ is self.__class__: {same}\n return NotImplemented", {}


def _hash(names: Sequence[str]) -> tuple[str, dict[str, Any]]:
    return f"def __hash__(self): return hash({_tuple('self', names)})", {}


def _tuple(owner: str, names: Sequence[str]) -> str:
    return f"({''.join(f'{owner}.{name}, ' for name in names)})"


def _init(kind: Any, entries: Entries, frozen: bool) -> tuple[str, dict[str, Any]]:
    known: dict[str, Any] = {"_put": object.__setattr__, "_NONE": MISSING}
    arguments, lines = ["self"], []
    for name, (_, default) in entries.items():
        value, given = name, default.default if isinstance(default, Field) else default
        if isinstance(default, Field) and default.default_factory is not MISSING:
            known[f"_make_{name}"] = default.default_factory
            value = f"_make_{name}() if {name} is _NONE else {name}"
            arguments.append(f"{name}=_NONE")
        elif given is not MISSING:
            known[f"_else_{name}"] = given
            arguments.append(f"{name}=_else_{name}")
        else:
            arguments.append(name)
        lines.append(f"_put(self, {name!r}, {value})" if frozen else f"self.{name} = {value}")
    if hasattr(kind, "__post_init__"):
        lines.append("self.__post_init__()")
    return f"def __init__({', '.join(arguments)}):\n " + "\n ".join(lines or ["pass"]), known


class _Later:
    """An attribute that the standard library looks for, made when it does."""

    def __init__(self, kind: type, name: str, frozen: bool) -> None:
        self._kind, self._name, self._frozen = kind, name, frozen

    def __get__(self, instance: object, owner: type) -> Any:
        like = _like(self._kind, self._frozen)
        for name in (FIELDS, PARAMS):
            setattr(self._kind, name, getattr(like, name))
        return getattr(self._kind, self._name)


class _Signature:
    """What `inspect.signature` says of the class, whose own `__init__` is not written yet."""

    def __init__(self, kind: type, frozen: bool) -> None:
        self._kind, self._frozen = kind, frozen

    def __get__(self, instance: object, owner: type) -> Any:
        from inspect import signature

        if owner is not self._kind:
            raise AttributeError("__signature__")  # a class derived from it has one of its own
        return signature(_like(self._kind, self._frozen))


def _like(kind: Any, frozen: bool) -> type:
    """A class with the same fields, made by the standard library."""
    fields: list[Any] = []
    for name, (hint, default) in getattr(kind, OWN).items():
        fields.append((name, hint) if default is MISSING else (name, hint, default))
    return make_dataclass(kind.__name__, fields, repr=False, eq=False, frozen=frozen)
