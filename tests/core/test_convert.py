"""Conversion of values of files to types: which values are accepted, and what is reported of each mistake."""

from __future__ import annotations

import gc
from collections.abc import Set
from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, Literal, NotRequired, TypedDict
from weakref import ref

import msgspec
import pytest

from periph_sim.core.convert import NOTHING, After, BadTable, Before, Mistake, convert, converter_of
from periph_sim.core.table import Duration, Table


class AfterValidator:
    """Stands for an annotation that belongs to another library."""

    def __init__(self, function: object) -> None:
        self.function = function


class Colour(Enum):
    RED = "red"


class Inner(Table, frozen=True, kw_only=True):
    length: Duration
    times: Annotated[int, msgspec.Meta(ge=1, le=5)] = 1


class Outer(Table, frozen=True, kw_only=True):
    from_: str = msgspec.field(name="from")
    inner: tuple[Inner, ...] = ()
    low: int = 0
    high: int = 9

    def check_together(self, given: Set[str]) -> None:
        if self.low > self.high:
            raise ValueError("low is above high")
        if "high" in given and "low" not in given:
            raise ValueError("high needs low")


class Open(Table, frozen=True, kw_only=True):
    OTHERS = "rest"

    name: str
    rest: dict[str, Any] = {}


@dataclass(frozen=True)
class Costs:
    edge: Duration = Fraction(0)
    byte: int = 3


@dataclass
class Settings:
    costs: Costs = field(default_factory=Costs)
    wait: int = 0

    def __post_init__(self) -> None:
        if self.wait < 0:
            raise ValueError("wait is negative")


def mistakes(kind: Any, value: object) -> list[Mistake]:
    found: list[Mistake] = []
    converter_of(kind)(value, (), found)
    return found


@pytest.mark.parametrize(
    ("kind", "value", "made"),
    [
        (int, 3, 3),
        (int, "1_000", 1000),
        (float, 2, 2.0),
        (Fraction, "1/3", Fraction(1, 3)),
        (Path, "a/b", Path("a/b")),
        (bytes, b"x", b"x"),
        (bool | int, 1, 1),
        (bool | int, True, True),
        (int | None, None, None),
        (Literal[1, 2], 2, 2),
        (list[int], (1, 2), [1, 2]),
        (tuple[int, ...], [1, 2], (1, 2)),
        (tuple[int, str], [1, "a"], (1, "a")),
        (dict[str, int], {"a": 1}, {"a": 1}),
        (Any, {"a": [1]}, {"a": [1]}),
        (Colour, "red", Colour.RED),
        (Colour, Colour.RED, Colour.RED),
        (Annotated[int, Before(len), After(lambda n: 2 * n)], "abc", 6),
        (Costs, {"edge": "5 ms"}, Costs(Fraction(5, 1000))),
        (Settings, {"costs": {"byte": 4}, "wait": 2}, Settings(Costs(byte=4), 2)),
        (Open, {"name": "a", "page": 3}, Open(name="a", rest={"page": 3})),
    ],
)
def test_valid_values_are_converted(kind: Any, value: object, made: object):
    found: list[Mistake] = []
    converted = converter_of(kind)(value, (), found)
    assert (converted, type(converted), found) == (made, type(made), [])


@pytest.mark.parametrize(
    ("kind", "value", "what"),
    [
        (int, True, "expected a whole number"),
        (int, 2.5, "expected a whole number"),
        (int, float("inf"), "expected a whole number"),
        (int, "x", "expected a whole number"),
        (float, "x", "expected a number"),
        (bool, 1, "expected true or false"),
        (str, 3, "expected a text"),
        (Fraction, "1/0", "expected a number"),
        (Literal["a", "b", "c"], "d", "expected 'a', 'b' or 'c'"),
        (Literal[1, 2], True, "expected 1 or 2"),
        (tuple[int, ...], "ab", "expected a list"),
        (tuple[int, int], [1], "expected a list of 2"),
        (dict[str, int], [1], "expected a table"),
        (Costs, 3, "expected a table"),
        (bool | str, 3, "expected true or false, or a text"),
        (bool | Annotated[int, msgspec.Meta(le=7)], 8, "expected 7 or less"),
        (Annotated[int, msgspec.Meta(ge=1)], 0, "expected 1 or more"),
        (Annotated[int, msgspec.Meta(ge=1, le=3)], 4, "expected 1 to 3"),
        (Annotated[tuple[int, ...], msgspec.Meta(min_length=2)], [1], "expected 2 or more entries"),
        (Colour, "blue", "expected 'red'"),
        (Costs | None, {"edge": "5"}, "'5' has no unit"),
        (
            Annotated[int, AfterValidator(abs)] | None,
            3,
            "annotated with AfterValidator; use Before and After",
        ),
        (int, 3.0, "expected a whole number"),
        (int | type | Enum, "x", "a file cannot contain a value of its type"),
        (tuple[tuple[int, Annotated[int, msgspec.Meta(le=7)]], ...], [[1, 8]], "expected 7 or less"),
    ],
)
def test_invalid_values_are_refused(kind: Any, value: object, what: str):
    (one,) = mistakes(kind, value)
    assert one.what.startswith(what) or what in one.what
    assert one.found in (value, NOTHING) or one.place


def test_every_mistake_of_a_table_is_reported_with_its_place():
    with pytest.raises(BadTable) as caught:
        convert(Outer, {"inner": [{"length": 3}, {"length": "1 s", "times": 6}], "lo": 1, "high": "x"})
    reported = [(one.place, one.what, one.found) for one in caught.value.mistakes[1:-1]]
    missing, *_, unknown = caught.value.mistakes
    assert (missing.place, missing.is_missing) == (("from",), True)
    assert reported == [
        (("inner", 0, "length"), '3 has no unit; write for instance "3 ms"', 3),
        (("inner", 1, "times"), "expected 1 to 5", 6),
        (("high",), "expected a whole number", "x"),
    ]
    assert (unknown.place, unknown.known) == (("lo",), ("from", "inner", "low", "high"))
    assert caught.value.first is unknown


def test_keys_that_contradict_each_other_are_a_mistake_of_the_table():
    for tree, what in (({"low": 5, "high": 4}, "low is above high"), ({"high": 4}, "high needs low")):
        with pytest.raises(BadTable) as caught:
            convert(Outer, {"from": "a", **tree})
        assert [(one.place, one.what) for one in caught.value.mistakes] == [((), what)]


@dataclass
class WithCache:
    gain: int = 1
    cache: OnlyForTypeCheckers | None = field(init=False, default=None)  # noqa: F821


def test_the_type_of_a_field_that_is_not_a_key_is_not_looked_up():
    assert convert(WithCache, {"gain": 3}) == WithCache(3)


def test_a_nested_dataclass_refuses_an_unknown_key():
    with pytest.raises(BadTable, match=r"costs\.egde: there is no such key"):
        convert(Settings, {"costs": {"egde": "5 ms"}})
    with pytest.raises(BadTable, match=r"^wait is negative$"):
        convert(Settings, {"wait": -1})


def test_a_copy_has_the_changed_values_and_leaves_the_original():
    one = Outer(from_="a", low=1)
    other = one.model_copy(update={"low": 2})
    assert (one.low, other.low, other.from_) == (1, 2, "a")
    assert msgspec.structs.asdict(other) == {"from_": "a", "inner": (), "low": 2, "high": 9}
    with pytest.raises(AttributeError, match="immutable"):
        one.low = 3  # type: ignore[misc]


class Cycles(msgspec.Struct):
    edge: int = 3
    byte: int = 5


class Limits(TypedDict):
    least: int
    most: NotRequired[Duration]


@dataclass
class Nested:
    """Settings of firmware that contain a struct, a dictionary and a typed dictionary."""

    costs: Cycles = field(default_factory=Cycles)
    named: dict[str, Cycles] = field(default_factory=dict)
    limits: Limits | None = None


def test_structs_and_typed_dictionaries_are_converted_like_tables():
    found = convert(Nested, {"costs": {"edge": 4}, "named": {"a": {"byte": 6}}, "limits": {"least": 1, "most": "2 s"}})
    assert (found.costs, found.named) == (Cycles(4, 5), {"a": Cycles(3, 6)})
    assert found.limits == {"least": 1, "most": Fraction(2)}


@pytest.mark.parametrize(
    ("tree", "mistakes"),
    [
        ({"costs": {"egde": 1}}, [Mistake(("costs", "egde"), known=("edge", "byte"))]),
        ({"named": {"a": {"egde": 1}}}, [Mistake(("named", "a", "egde"), known=("edge", "byte"))]),
        ({"limits": {"least": 1, "mots": 2}}, [Mistake(("limits", "mots"), known=("least", "most"))]),
        ({"limits": {}}, [Mistake(("limits", "least"), is_missing=True)]),
        ({"limits": 3}, [Mistake(("limits",), "expected a table", 3)]),
    ],
)
def test_a_misspelt_key_of_a_struct_or_typed_dictionary_is_a_mistake(tree: dict[str, object], mistakes: list[Mistake]):
    with pytest.raises(BadTable) as refused:
        convert(Nested, tree)
    assert refused.value.mistakes == mistakes


def test_converting_to_one_of_several_types_keeps_no_reference_to_the_caller():
    """The errors of the types that did not match have tracebacks, which refer to the frames of all callers."""

    class Caller:
        pass

    def converted() -> ref[Caller]:
        caller = Caller()
        assert convert(Duration | Literal["estimate"], "estimate") == "estimate"
        return ref(caller)

    gc.disable()
    try:
        assert converted()() is None
    finally:
        gc.enable()
