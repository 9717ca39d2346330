"""Named answers to open questions: a frozen dataclass of choices goes in, a checked table comes out.

What TI does not document is a field of such a class. The default is the first value
named in its metadata; each field carries the question, so that docs, scene files and
messages never repeat it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Hashable
from functools import cache
from typing import Any, TypeVar, cast

from .suggest import did_you_mean

T = TypeVar("T")
Value = str | int | bool


def choice(*values: Value, question: str) -> Any:
    """A field whose value is one of `values`; the first is the default."""
    return dataclasses.field(default=values[0], metadata={"values": values, "question": question})


def number(default: int, least: int, most: int, *, unit: str, question: str) -> Any:
    """A field that takes a whole number from `least` to `most`."""
    about = {"least": least, "most": most, "unit": unit, "question": question}
    return dataclasses.field(default=default, metadata=about)


class Answers:
    """One answer to each question, those of a dataclass's fields; nothing changes them.

    What a frozen dataclass would have is written here once: generating it for each class takes milliseconds at import.
    """

    def __init__(self, **given: Value) -> None:
        for name in given:
            if name not in self._names():
                raise TypeError(f"{type(self).__name__} has no option {name!r}")
        vars(self).update(given)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__}.{name} cannot be changed")

    def _names(self) -> tuple[str, ...]:
        return tuple(of.name for of in dataclasses.fields(self))  # type: ignore[arg-type]

    def _answers(self) -> tuple[Value, ...]:
        return tuple(getattr(self, name) for name in self._names())

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self._answers() == other._answers()

    def __hash__(self) -> int:
        return hash(self._answers())

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in vars(self).items())})"


def allowed(of: dataclasses.Field[Any]) -> str:
    """What a field accepts, as a phrase, the default first."""
    if "values" in of.metadata:
        return " or ".join(str(v).lower() if isinstance(v, bool) else str(v) for v in of.metadata["values"])
    return f"{of.metadata['least']} to {of.metadata['most']} {of.metadata['unit']}"


@cache  # they are frozen, so that all scenes without answers of their own share them
def _defaults(kind: Any) -> object:
    return kind()


def options_from(kind: type[T], given: dict[str, Value]) -> T:
    """An instance of `kind` with the given values. ValueError names the option and the nearest right name or value."""
    if not given:
        return cast(T, _defaults(cast(Hashable, kind)))
    known = {f.name: f for f in dataclasses.fields(kind)}  # type: ignore[arg-type]
    for name, value in given.items():
        if name not in known:
            raise ValueError(f"there is no option {name!r}; {did_you_mean(name, known)}")
        about = known[name].metadata
        if "values" in about:
            fits = any(value == v and type(value) is type(v) for v in about["values"])
        else:
            fits = type(value) is int and about["least"] <= value <= about["most"]
        if not fits:
            raise ValueError(f"option {name} is {value!r}; expected {allowed(known[name])}")
    return kind(**given)
