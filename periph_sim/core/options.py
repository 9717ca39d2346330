"""Options: answers to open questions about the hardware. They concern behaviour that TI does not document.

    class I2cOptions(Answers):
        int_line: TextOption = choice("pulse", "level", question="...")

    options.int_line.assume(self.touched) == "level"      lists int_line as assumed
    options.int_line == "level"                           is refused by the type checker

Each option is a field of a subclass of `Answers`. Its metadata has the possible answers (the default first) or their
range, the question, and the registers that it concerns, so that docs and messages need not repeat them. A model calls
`assume` where the answer decides its behaviour. `assume` returns the answer and adds the name of the option to a set,
`touched`, so that a report can list the options on which the run depended. `unrecorded` is for calculations outside the
run, and for answers that are stored and have an effect only later; tests/options/test_unrecorded.py lists its callers.
"""

# core: compiled

from __future__ import annotations

import dataclasses
from collections.abc import Hashable
from functools import cache
from typing import Any, TypeVar, cast, final

from .phrases import did_you_mean

T = TypeVar("T")
Value = str | int | bool


def choice(*values: Value, question: str, registers: str = "") -> Any:
    """Return a field whose value is one of `values`; the first is the default.

    question: the open question, for docs and messages.
    registers: the names of the registers that the answer concerns, separated by blanks; "" if there is none.
    """
    about = {"values": values, "question": question, "registers": registers}
    return dataclasses.field(default=values[0], metadata=about)


def number(default: int, least: int, most: int, *, unit: str, question: str, registers: str = "") -> Any:
    """Return a field whose value is a whole number from `least` to `most`. unit: the unit of this number, for messages.

    question, registers: as for `choice`.
    """
    about = {"least": least, "most": most, "unit": unit, "question": question, "registers": registers}
    return dataclasses.field(default=default, metadata=about)


class Option:
    """The answer to one open question.

    `assume` returns the answer and adds the option's name to `touched`; `unrecorded` only returns the answer.
    """

    __slots__ = ("_answer", "name")

    def __init__(self, name: str, answer: Value) -> None:
        self.name = name
        self._answer: Any = answer


@final
class TextOption(Option):
    __slots__ = ()

    def assume(self, touched: set[str]) -> str:
        touched.add(self.name)
        return self.unrecorded()

    def unrecorded(self) -> str:
        answer: str = self._answer
        return answer

    def matches(self, answer: str) -> BoolOption:
        """Return a BoolOption of the same name. Its value is True if this option's value is `answer`."""
        return BoolOption(self.name, self._answer == answer)


@final
class IntOption(Option):
    __slots__ = ()

    def assume(self, touched: set[str]) -> int:
        touched.add(self.name)
        return self.unrecorded()

    def unrecorded(self) -> int:
        answer: int = self._answer
        return answer


@final
class BoolOption(Option):
    __slots__ = ()

    def assume(self, touched: set[str]) -> bool:
        touched.add(self.name)
        return self.unrecorded()

    def unrecorded(self) -> bool:
        answer: bool = self._answer
        return answer


KINDS: dict[type, type[TextOption | IntOption | BoolOption]] = {str: TextOption, int: IntOption, bool: BoolOption}


class Answers:  # core: python
    """Base of classes of immutable answers. Each field of a subclass is the answer to one question.

    Each subclass becomes a dataclass. The methods of a frozen dataclass are written here once, because generating them
    for each subclass would slow down the import.
    """

    def __init_subclass__(cls) -> None:
        dataclasses.dataclass(init=False, repr=False, eq=False)(cls)

    def __init__(self, **given: Value) -> None:
        answers: dict[str, Value] = {one.name: one.default for one in dataclasses.fields(self)}  # type: ignore
        for name in given:
            if name not in answers:
                raise TypeError(f"{type(self).__name__} has no option {name!r}")
        answers.update(given)
        vars(self).update({name: KINDS[type(answer)](name, answer) for name, answer in answers.items()})

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__}.{name} cannot be changed")

    def unrecorded(self) -> dict[str, Value]:
        """Return all answers by name. No name is added to a set `touched`."""
        return {name: option.unrecorded() for name, option in vars(self).items()}

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self.unrecorded() == other.unrecorded()

    def __hash__(self) -> int:
        return hash(tuple(self.unrecorded().items()))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in self.unrecorded().items())})"


def allowed(field: dataclasses.Field[Any]) -> str:
    """Return a phrase with the values that a field accepts, the default first, or with their range."""
    if "values" in field.metadata:
        return " or ".join(str(v).lower() if isinstance(v, bool) else str(v) for v in field.metadata["values"])
    return f"{field.metadata['least']} to {field.metadata['most']} {field.metadata['unit']}"


@cache  # answers are immutable, so all scenes that use only default answers can share one object
def _defaults(kind: Any) -> object:
    return kind()


def options_from(kind: type[T], given: dict[str, Value]) -> T:
    """Return an instance of `kind` with the given values. Raise ValueError for an unknown name or an invalid value."""
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
