"""Conversion of the values in a file to Python types. The result is an object, or a list of all mistakes.

    3, "250 us", {...}, [...] --converter_of(annotation)--> int, Fraction, a Table, a tuple ...

msgspec checks plain values. Tables are checked here, key by key, so that every mistake is reported with its place. A
table is a class whose fields are the keys: a `Table`, another subclass of `msgspec.Struct`, a dataclass or a TypedDict.
`Annotated` adds limits (`msgspec.Meta`), and functions that run before and after the check (`Before`, `After`).
"""

from __future__ import annotations

import dataclasses
import re
import sys
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cached_property, lru_cache
from pathlib import Path
from types import NoneType, SimpleNamespace
from typing import (
    Annotated,
    Any,
    Literal,
    NotRequired,
    Required,
    TypeVar,
    get_args,
    get_origin,
    get_type_hints,
    is_typeddict,
)

import msgspec

from .expected_value import UNIONS, expected, limits_of

LIST_OF_TABLES = "expected a list of tables"
T = TypeVar("T")
Place = tuple[str | int, ...]  # keys and indices that lead to a value, from the outermost table
NOTHING: Any = msgspec.UNSET  # marks a message that quotes no value, and a key that has no default


class Before(msgspec.Struct, frozen=True):
    """A conversion that is made before the type of the value is checked.

    function: returns the new value, or raises ValueError with a description.
    said: the type of the value in the file, for the JSON schema; None if it is the annotated type.
    """

    function: Callable[[Any], object]
    said: Any = None


class After(msgspec.Struct, frozen=True):
    """A conversion that is made after the type of the value was checked.

    function: returns the new value, or raises ValueError with a description.
    """

    function: Callable[[Any], object]


class Mistake(msgspec.Struct, frozen=True):
    """One mistake and its place.

    what: a description; "" for a missing or an unknown key.
    found: the invalid value; NOTHING if no value is quoted.
    error: the exception that a conversion or a check raised; None if none raised one.
    known: the valid keys of the table, if the mistake is an unknown key; otherwise None.
    """

    place: Place
    what: str = ""
    found: Any = NOTHING
    error: ValueError | None = None
    is_missing: bool = False
    known: tuple[str, ...] | None = None


class BadTable(ValueError):
    """A table that does not match its class. mistakes: all mistakes that were found, at least one."""

    def __init__(self, mistakes: list[Mistake]) -> None:
        shown = []
        for one in mistakes:
            what = one.what or ("it is missing" if one.is_missing else "there is no such key")
            shown.append(": ".join(filter(None, [".".join(map(str, one.place)), what])))
        super().__init__("; ".join(shown))
        self.mistakes = mistakes

    @property
    def first(self) -> Mistake:
        """The mistake to report first: an unknown key if any, because it is often a misspelled required key."""
        return next((one for one in self.mistakes if one.known is not None), self.mistakes[0])


# A `Converter` converts a value at a place and appends mistakes to a list. If it appends any, its result is not valid.
Converter = Callable[[Any, Place, list[Mistake]], Any]


def convert(kind: type[T], tree: object) -> T:
    """Return an object of the class `kind`, made from the keys in a file. Raise BadTable if they do not match it."""
    mistakes: list[Mistake] = []
    made: T = converter_of(kind)(tree, (), mistakes)
    if mistakes:
        raise BadTable(mistakes)
    return made


@dataclasses.dataclass
class Key:
    """A key of a table.

    name: the name of the field that gets the key's value.
    default: the default of the field; NOTHING for a required key.
    said: the annotation of the field, which may be text.
    names: the names of the module of the class that has the annotation.
    """

    name: str
    default: Any
    said: Any
    names: dict[str, Any]

    @property
    def is_required(self) -> bool:
        return self.default is NOTHING

    @cached_property
    def annotation(self) -> Any:
        """The annotation of the field. Names are looked up at the first use, because a file may not use the key."""
        alone: Any = SimpleNamespace(__annotations__={self.name: self.said})
        return get_type_hints(alone, self.names, include_extras=True)[self.name]

    @cached_property
    def convert(self) -> Converter:
        """The function that converts the key's value. It is made at the first use."""
        return converter_of(self.annotation)


def own_annotations(kind: type) -> Mapping[str, Any]:
    """Return the annotations of a class without those of its bases; types may still be text.

    In Python 3.14, a class stores a function that returns its annotations, instead of the annotations themselves.
    """
    if sys.version_info >= (3, 14):
        from annotationlib import Format, get_annotations

        return get_annotations(kind, format=Format.FORWARDREF)
    found: Mapping[str, Any] = vars(kind).get("__annotations__", {})
    return found


def _key(kind: Any, name: str, default: object) -> Key:
    owner = next(base for base in kind.__mro__ if name in own_annotations(base))
    module = sys.modules.get(owner.__module__)
    return Key(name, default, own_annotations(owner)[name], {} if module is None else vars(module))


@lru_cache(maxsize=256)  # bounded, because a firmware file that is loaded again has new classes
def keys_of(kind: Any) -> dict[str, Key]:
    """Return the keys of a table by their names in files, in the order of the fields."""
    if is_typeddict(kind):
        hints = get_type_hints(kind, include_extras=True)
        # If annotations are strings, `__required_keys__` also contains keys that are NotRequired.
        required = {name for name in kind.__required_keys__ if get_origin(hints[name]) is not NotRequired}
        return {name: _key(kind, name, NOTHING if name in required else None) for name in hints}
    found = {}
    if dataclasses.is_dataclass(kind):
        for field in dataclasses.fields(kind):
            if field.init:
                has_none = field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
                found[field.name] = _key(kind, field.name, NOTHING if has_none else field.default)
        return found
    names, defaults = kind.__struct_fields__, kind.__struct_defaults__
    padded = (msgspec.NODEFAULT,) * (len(names) - len(defaults)) + defaults
    for name, said, default in zip(names, kind.__struct_encode_fields__, padded, strict=True):
        if not name.startswith("_") and name != getattr(kind, "OTHERS", ""):
            # msgspec stores the defaults {} and [] as factories.
            value = default.factory() if hasattr(default, "factory") else default
            found[said] = _key(kind, name, NOTHING if value is msgspec.NODEFAULT else value)
    return found


def is_table(kind: object) -> bool:
    """Return True for a `Table`, another Struct, a dataclass or a TypedDict, whose values are tables in a file."""
    is_class = isinstance(kind, type) and (issubclass(kind, msgspec.Struct) or dataclasses.is_dataclass(kind))
    return is_class or is_typeddict(kind)


@lru_cache(maxsize=256)
def _table(kind: Any) -> Converter:
    is_class = not is_typeddict(kind)
    others = getattr(kind, "OTHERS", "")
    check = getattr(kind, "check_together", None) if hasattr(kind, "OTHERS") else None

    def made(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        if is_class and isinstance(value, kind):
            return value
        if not isinstance(value, Mapping):
            mistakes.append(Mistake(place, "expected a table", value))
            return None
        keys = keys_of(kind)
        before = len(mistakes)
        values = {}
        for name, key in keys.items():
            if name in value:
                values[key.name] = key.convert(value[name], (*place, name), mistakes)
            elif key.is_required:
                mistakes.append(Mistake((*place, name), is_missing=True))
        rest = {name: one for name, one in value.items() if name not in keys}
        if rest and others:
            values[others] = rest
        else:
            mistakes += [Mistake((*place, name), known=tuple(keys)) for name in rest]
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
    """Return the function that converts values to this type."""
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin in (Required, NotRequired):
        return converter_of(arguments[0])
    if _is_plain(annotation):
        return _by_msgspec(annotation)
    if origin is Annotated:
        return _checked(arguments[0], arguments[1:])
    if origin in UNIONS:
        return _union([converter_of(kind) for kind in arguments if kind is not NoneType], NoneType in arguments)
    if origin in (list, tuple):
        return _list(origin, arguments)
    if origin is dict:
        return _dict(converter_of(arguments[1]))
    return _table(annotation) if is_table(annotation) else lambda value, place, mistakes: value


def _is_plain(annotation: Any) -> bool:
    """Return True if msgspec alone can check the type, because it contains no table, dict, `Before` or `After`.

    Return False also for Any, for object, and for a union with Fraction or Path.
    """
    origin, arguments = get_origin(annotation), get_args(annotation)
    if origin is Literal:
        return True
    if origin is Annotated:
        return _is_plain(arguments[0]) and all(isinstance(one, msgspec.Meta) for one in arguments[1:])
    if origin in UNIONS and {Fraction, Path} & {*arguments}:
        return False  # msgspec cannot distinguish Fraction and Path from other types
    if origin in (list, tuple, *UNIONS):
        return all(kind is ... or _is_plain(kind) for kind in arguments)
    return origin is not dict and annotation not in (Any, object) and not is_table(annotation)


def _by_msgspec(annotation: Any) -> Converter:
    def plain(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        try:
            return msgspec.convert(value, annotation, dec_hook=_made)
        except msgspec.ValidationError as error:
            if isinstance(value, str):  # `--set` passes a number with underscores, such as 1_000, as a str
                try:
                    return msgspec.convert(value.replace("_", ""), annotation, strict=False, dec_hook=_made)
                except msgspec.ValidationError:
                    pass
            inside = [int(number) for number in re.findall(r"\[(\d+)\]", str(error).rpartition(" - at `$")[2])]
            kind, found = annotation, value
            for number in inside:
                kinds = get_args(kind)
                kind, found = kinds[0] if kinds[-1] is ... or len(kinds) == 1 else kinds[number], found[number]
            mistakes.append(Mistake((*place, *inside), f"expected {expected(kind, found)}", found))
        except TypeError as error:
            mistakes.append(Mistake(place, f"a file cannot contain a value of its type: {error}"))
        return None

    return plain


def _made(kind: type, value: Any) -> Any:
    """Return `value` as a Fraction or a Path, which msgspec cannot decode. Raise ValueError if that is impossible."""
    if kind not in (Fraction, Path) or isinstance(value, bool):
        raise ValueError
    try:
        return kind(value if kind is Path else str(value))
    except (TypeError, ZeroDivisionError):
        raise ValueError from None


def _keeps(limits: msgspec.Meta, value: Any) -> bool:
    """Return True if a value is within limits. msgspec does not check the results of `Before` and `After` functions."""
    if limits.min_length is not None and len(value) < limits.min_length:
        return False
    return (limits.ge is None or value >= limits.ge) and (limits.le is None or value <= limits.le)


def _checked(kind: Any, checks: tuple[Any, ...]) -> Converter:
    foreign = [check for check in checks if not isinstance(check, Before | After | msgspec.Meta)]
    of_kind = converter_of(kind)

    def checked(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        count, original = len(mistakes), value
        try:
            if foreign:
                name = type(foreign[0]).__name__
                raise ValueError(f"its type is annotated with {name}; use Before and After of periph_sim.firmware")
            for check in checks:
                if isinstance(check, Before):
                    value = check.function(value)
            value = of_kind(value, place, mistakes)
            for check in checks:
                if len(mistakes) > count:
                    return None
                if isinstance(check, After):
                    value = check.function(value)
                elif isinstance(check, msgspec.Meta) and not _keeps(check, value):
                    mistakes.append(Mistake(place, f"expected {limits_of(check)}", original))
        except ValueError as error:
            mistakes.append(Mistake(place, str(error), original, error))
        return value

    return checked


def _union(converters: list[Converter], takes_none: bool) -> Converter:
    def one_of(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        if value is None and takes_none:
            return None
        tried: list[list[Mistake]] = [[] for _ in converters]
        for converter, wrong in zip(converters, tried, strict=True):
            made = converter(value, place, wrong)
            if not wrong:
                # The lists are cleared, because tracebacks in the mistakes would keep the frames of all callers alive.
                for given_up in tried:
                    given_up.clear()
                return made
        mistakes += tried[0]
        return None

    return one_of


def _list(kind: type, entries: tuple[Any, ...]) -> Converter:
    """Return the converter of a list or tuple.

    entries: the type of all entries, followed by `...` for a tuple; or one type for each entry of a tuple.
    """
    of_entry = [converter_of(entry) for entry in entries if entry is not ...]
    places = None if kind is list or entries[-1] is ... else len(entries)
    phrase = "expected a list" if places is None else f"expected a list of {places}"
    phrase = LIST_OF_TABLES if is_table(entries[0]) else phrase

    def several(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        if not isinstance(value, list | tuple) or places not in (None, len(value)):
            mistakes.append(Mistake(place, phrase, value))
            return None
        numbered = enumerate(value)
        return kind([of_entry[n if places else 0](one, (*place, n), mistakes) for n, one in numbered])

    return several


def _dict(of_value: Converter) -> Converter:
    def named(value: Any, place: Place, mistakes: list[Mistake]) -> Any:
        if isinstance(value, Mapping):
            return {key: of_value(one, (*place, key), mistakes) for key, one in value.items()}
        mistakes.append(Mistake(place, "expected a table", value))
        return None

    return named
