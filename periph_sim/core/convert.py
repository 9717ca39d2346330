"""What a file says, checked against types: a value and an annotation go in, an object comes out, or each mistake.

    3, "250 us", {...}, [...] --converter_of(annotation)--> int, Fraction, a class of keys, a tuple ...

Annotations are Python's: `int`, `tuple[str, ...]`, `Literal[...]`, `X | None`, a `Table` or a dataclass, whose keys are
its fields. `Annotated` adds checks, each after the ones before it: `Before`, `After`, and limits as `msgspec.Meta`.
A type that is none of these is left to msgspec; one annotated for pydantic to that, if its file imported it.
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from types import NoneType, SimpleNamespace, UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import msgspec

T = TypeVar("T")
Place = tuple[str | int, ...]  # keys and numbers that lead to a value, from the outermost table in
NOTHING: Any = msgspec.UNSET  # where a message has no value to repeat


class Before(msgspec.Struct, frozen=True):
    """Called with what the file says, for what is checked on. said: the type of that, for editors."""

    function: Callable[[Any], object]
    said: Any = None


class After(msgspec.Struct, frozen=True):
    """Called with what the checks before made of it, for the value. ValueError, a phrase, refuses it."""

    function: Callable[[Any], object]


class Mistake(msgspec.Struct, frozen=True):
    """One thing wrong, and where. error: that a check raised. known: the keys that a table has, for a key it has not.

    by_type: no value of that type would do.
    """

    place: Place
    what: str = ""
    found: Any = NOTHING
    error: ValueError | None = None
    is_missing: bool = False
    known: tuple[str, ...] | None = None
    by_type: bool = False


class BadTable(ValueError):
    """A table that is not as its class says. mistakes: all of them, in the order of the class's keys."""

    def __init__(self, mistakes: list[Mistake]) -> None:
        super().__init__("; ".join(_in_short(one) for one in mistakes))
        self.mistakes = mistakes

    @property
    def first(self) -> Mistake:
        """What to say first: a key that there is not, since it is often a missing one misspelt."""
        return next((one for one in self.mistakes if one.known is not None), self.mistakes[0])


def _in_short(one: Mistake) -> str:
    what = one.what or ("it is missing" if one.is_missing else "there is no such key")
    return ": ".join(filter(None, [".".join(map(str, one.place)), what]))


Converter = Callable[[Any, Place, list[Mistake]], Any]  # mistakes are added to the list; the result is then nothing


def convert(kind: type[T], tree: object) -> T:
    """An object of a `Table` or a dataclass from the keys that a file gives it. BadTable if it is not as that says."""
    mistakes: list[Mistake] = []
    made: T = converter_of(kind)(tree, (), mistakes)
    if mistakes:
        raise BadTable(mistakes)
    return made


class Key:
    """A key of a table. name: of its field. convert: what checks it, made when the first file gives it."""

    def __init__(self, kind: type, name: str, default: object) -> None:
        self._kind = kind
        self.name = name
        self.default = default
        self._converter: Converter | None = None

    @property
    def is_required(self) -> bool:
        return self.default is NOTHING

    @property
    def annotation(self) -> Any:
        owner = next(base for base in self._kind.__mro__ if self.name in vars(base).get("__annotations__", {}))
        names = vars(sys.modules[owner.__module__]) if owner.__module__ in sys.modules else {}
        alone: Any = SimpleNamespace(__annotations__={self.name: vars(owner)["__annotations__"][self.name]})
        return get_type_hints(alone, names, include_extras=True)[self.name]

    @property
    def convert(self) -> Converter:
        if self._converter is None:
            self._converter = converter_of(self.annotation)
        return self._converter


@lru_cache(maxsize=256)  # of a file that is loaded again the class is a new one
def keys_of(kind: type) -> dict[str, Key]:
    """The keys of a `Table` or a dataclass, as a file calls them, in the order of its fields."""
    return _keys_of_dataclass(kind) if dataclasses.is_dataclass(kind) else _keys_of_struct(kind)


def _keys_of_struct(kind: Any) -> dict[str, Key]:
    names, defaults = kind.__struct_fields__, kind.__struct_defaults__
    padded = (msgspec.NODEFAULT,) * (len(names) - len(defaults)) + defaults
    found = {}
    for name, said, default in zip(names, kind.__struct_encode_fields__, padded, strict=True):
        if name.startswith("_") or name == kind.OTHERS:
            continue
        if default is msgspec.NODEFAULT:
            default = NOTHING
        elif hasattr(default, "factory"):  # of {} and []
            default = default.factory()
        found[said] = Key(kind, name, default)
    return found


def _keys_of_dataclass(kind: Any) -> dict[str, Key]:
    found = {}
    for field in dataclasses.fields(kind):
        if field.init:
            has_none = field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
            found[field.name] = Key(kind, field.name, NOTHING if has_none else field.default)
    return found


def is_table(kind: object) -> bool:
    """Whether its values are tables in a file: a `Table`, or a dataclass."""
    return isinstance(kind, type) and (hasattr(kind, "OTHERS") or dataclasses.is_dataclass(kind))


@lru_cache(maxsize=256)
def _table(kind: Any) -> Converter:
    others = getattr(kind, "OTHERS", "")
    check = getattr(kind, "check_together", None) if hasattr(kind, "OTHERS") else None

    def made(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        if isinstance(value, kind):
            return value
        if not isinstance(value, Mapping):
            mistakes.append(Mistake(place, "expected a table", value, by_type=True))
            return None
        keys = keys_of(kind)
        before = len(mistakes)
        values = {}
        for said, key in keys.items():
            if said in value:
                values[key.name] = key.convert(value[said], (*place, said), mistakes)
            elif key.is_required:
                mistakes.append(Mistake((*place, said), is_missing=True))
        rest = {said: one for said, one in value.items() if said not in keys}
        if rest and others:
            values[others] = rest
        else:
            mistakes += [Mistake((*place, said), known=tuple(keys)) for said in rest]
        if len(mistakes) > before:
            return None
        try:
            new = kind(**values)
            if check is not None:
                check(new, value.keys())
        except ValueError as error:
            mistakes.append(Mistake(place, str(error), error=error))
            return None
        return new

    return made


def converter_of(annotation: Any) -> Converter:
    """What checks values of that type."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _annotated(annotation, arguments[0], arguments[1:])
    if origin in (Union, UnionType):
        return _union(arguments)
    if origin is Literal:
        return _literal(arguments)
    if origin is tuple and len(arguments) == 2 and arguments[1] is ...:
        return _list(tuple, arguments[0])
    if origin is tuple:
        return _row(arguments)
    if origin in (list, set, frozenset):
        return _list(origin, arguments[0])
    if origin in (dict, Mapping):
        return _dict(arguments[1])
    if annotation in (Any, object):
        return _anything
    if is_table(annotation):
        return _table(annotation)
    return _PLAIN.get(annotation) or _other(annotation)


def _annotated(whole: Any, kind: Any, checks: tuple[Any, ...]) -> Converter:
    if any(type(check).__module__.partition(".")[0] in ("pydantic", "annotated_types") for check in checks):
        return _by_pydantic(whole)
    before = [check.function for check in checks if isinstance(check, Before)]
    after = [check for check in checks if isinstance(check, After | msgspec.Meta)]
    of_kind = converter_of(kind)

    def checked(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        count = len(mistakes)
        said = value
        try:
            for function in before:
                value = function(value)
            value = of_kind(value, place, mistakes)
            for check in after:
                if len(mistakes) > count:
                    return None
                if isinstance(check, After):
                    value = check.function(value)
                elif what := _beyond(check, value):
                    mistakes.append(Mistake(place, what, said))
        except ValueError as error:
            mistakes.append(Mistake(place, str(error), said, error))
        return value

    return checked


def _beyond(limits: msgspec.Meta, value: Any) -> str:
    """What is expected of a value that limits refuse; empty if they do not."""
    if limits.min_length is not None and len(value) < limits.min_length:
        return f"expected {limits.min_length} or more entries"
    if (limits.ge is None or value >= limits.ge) and (limits.le is None or value <= limits.le):
        return ""
    if limits.ge is None:
        return f"expected {limits.le} or less"
    return f"expected {limits.ge} or more" if limits.le is None else f"expected {limits.ge} to {limits.le}"


def _union(kinds: Sequence[Any]) -> Converter:
    there = [kind for kind in kinds if kind is not NoneType]
    converters = [converter_of(kind) for kind in there]
    exact = {kind: _PLAIN[kind] for kind in there if kind in _EXACT}
    takes_none = len(there) < len(kinds)

    def one_of(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        if value is None and takes_none:
            return None
        if type(value) in exact:  # 1 is a number where true or a number may be
            return value
        tried: list[list[Mistake]] = []
        for converter in converters:
            wrong: list[Mistake] = []
            made = converter(value, place, wrong)
            if not wrong:
                return made
            tried.append(wrong)
        of_value = [wrong for wrong in tried if not all(one.by_type for one in wrong)]
        if of_value or len(tried) == 1:
            mistakes += (of_value or tried)[0]
        else:
            phrases = dict.fromkeys(one.what.removeprefix("expected ") for wrong in tried for one in wrong)
            mistakes.append(Mistake(place, f"expected {', or '.join(phrases)}", value, by_type=True))
        return None

    return one_of


def _literal(choices: tuple[Any, ...]) -> Converter:
    shown = [repr(choice) for choice in choices]
    expected = f"expected {' or '.join(filter(None, [', '.join(shown[:-1]), shown[-1]]))}"

    def chosen(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        for choice in choices:
            if type(value) is type(choice) and value == choice:
                return value
        mistakes.append(Mistake(place, expected, value, by_type=not isinstance(value, type(choices[0]))))
        return None

    return chosen


def _list(kind: type, entry: Any) -> Converter:
    of_entry = converter_of(entry)

    def several(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        if not isinstance(value, list | tuple | set | frozenset):
            mistakes.append(Mistake(place, "expected a list", value, by_type=True))
            return None
        before = len(mistakes)
        entries = [of_entry(one, (*place, number), mistakes) for number, one in enumerate(value)]
        return None if len(mistakes) > before else kind(entries)

    return several


def _row(kinds: tuple[Any, ...]) -> Converter:
    converters = [converter_of(kind) for kind in kinds]

    def row(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        if not isinstance(value, list | tuple) or len(value) != len(converters):
            mistakes.append(Mistake(place, f"expected a list of {len(converters)}", value, by_type=True))
            return None
        pairs = enumerate(zip(converters, value, strict=True))
        return tuple(converter(one, (*place, number), mistakes) for number, (converter, one) in pairs)

    return row


def _dict(kind: Any) -> Converter:
    of_value = converter_of(kind)

    def named(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        if not isinstance(value, Mapping):
            mistakes.append(Mistake(place, "expected a table", value, by_type=True))
            return None
        return {key: of_value(one, (*place, key), mistakes) for key, one in value.items()}

    return named


def _anything(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
    return value


def _plain(kind: type, expected: str, made_of: Callable[[Any], object] | None, *others: type) -> Converter:
    """made_of: makes a value of one that is of another of these types."""

    def plain(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        if type(value) is kind or (isinstance(value, kind) and not isinstance(value, bool)):
            return value
        if made_of is not None and isinstance(value, others) and not isinstance(value, bool):
            try:
                return made_of(value)
            except (ValueError, OverflowError, ZeroDivisionError):
                pass
        mistakes.append(Mistake(place, f"expected {expected}", value, by_type=True))
        return None

    return plain


def _whole(value: str | float | Fraction) -> int:
    """Of a text, too: `--set` says numbers with underscores as texts."""
    if isinstance(value, str):
        return int(value)
    if value != int(value):
        raise ValueError
    return int(value)


def _exact(value: str | float) -> Fraction:
    return Fraction(str(value))


_EXACT = (bool, int, float, str)
_PLAIN: dict[Any, Converter] = {
    bool: _plain(bool, "true or false", None),
    int: _plain(int, "a whole number", _whole, str, float, Fraction),
    float: _plain(float, "a number", float, int, str, Fraction),
    str: _plain(str, "a text", None),
    bytes: _plain(bytes, "bytes", str.encode, str),
    Fraction: _plain(Fraction, "a number", _exact, int, float, str),
    Path: _plain(Path, "a path", Path, str),
    tuple: _list(tuple, Any),
    list: _list(list, Any),
    dict: _dict(Any),
}


def _other(kind: Any) -> Converter:
    """A type of which only its own module knows, or one that msgspec knows."""
    if hasattr(kind, "__get_pydantic_core_schema__"):
        return _by_pydantic(kind)

    def other(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        if isinstance(kind, type) and isinstance(value, kind):
            return value
        try:
            return msgspec.convert(value, kind, strict=False)
        except (ValueError, TypeError) as error:  # TypeError: of a type that msgspec does not know
            what = str(error) if isinstance(error, ValueError) else f"expected a {getattr(kind, '__name__', kind)}"
            mistakes.append(Mistake(place, f"{what[0].lower()}{what[1:]}", value, by_type=True))
            return None

    return other


def _by_pydantic(annotation: Any) -> Converter:
    """A type that was annotated for pydantic, which whoever did so has imported."""
    from pydantic import TypeAdapter, ValidationError

    adapter: TypeAdapter[Any] = TypeAdapter(annotation)

    def validated(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        try:
            return adapter.validate_python(value)
        except ValidationError as error:
            for one in error.errors():
                inside = tuple(part for part in one["loc"] if isinstance(part, int) or not part.startswith("function-"))
                what = one["msg"].removeprefix("Value error, ")
                mistakes.append(Mistake((*place, *inside), f"{what[0].lower()}{what[1:]}", one["input"]))
            return None

    return validated
