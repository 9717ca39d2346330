"""Dataclasses that are written when they are used: each looks and acts as the standard library's twin of it."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from collections.abc import Callable, Iterator
from dataclasses import field
from inspect import signature
from typing import Any

import pytest

from periph_sim.core.lazy_dataclass import dataclass


@dataclass(frozen=True)
class Span:
    begin: int
    end: int = 7
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Named(Span):
    end: int = 9
    name: str = field(default="a", metadata={"question": "why"})

    def __post_init__(self) -> None:
        if self.begin > self.end:
            raise ValueError("begin is behind end")


@dataclass
class Count:
    of: str
    times: int = 0


@dataclass(frozen=True, slots=True)
class Slotted:
    one: int
    other: str = field(default="b", metadata={"values": ("b", "c")})


@dataclass(frozen=True, eq=False)
class Itself:
    one: int


@dataclass(frozen=True)
class Empty:
    pass


@dataclass(frozen=True, order=True)
class Ordered:
    one: int


@dataclass(frozen=True)
class Own:
    one: int

    def __hash__(self) -> int:
        return 5

    def __repr__(self) -> str:
        return "own"


MADE: dict[str, tuple[type, dict[str, Any], tuple[Any, ...]]] = {
    "frozen": (Span, {"frozen": True}, (1, 2)),
    "a base, a method behind __init__": (Named, {"frozen": True}, (1, 2)),
    "to be changed": (Count, {}, ("a", 2)),
    "slots": (Slotted, {"frozen": True, "slots": True}, (1, "c")),
    "eq=False": (Itself, {"frozen": True, "eq": False}, (1,)),
    "no field": (Empty, {"frozen": True}, ()),
    "order": (Ordered, {"frozen": True, "order": True}, (1,)),
    "methods of its own": (Own, {"frozen": True}, (1,)),
}
TEXT = """
from __future__ import annotations
from dataclasses import field
from typing import ClassVar, Any
@decorate
class Made:
    {body}
"""


def same(ask: Callable[[Any], Any], ours: Any, theirs: Any) -> None:
    """Both give the same, or refuse it in the same words."""
    told: list[tuple[object, str]] = []
    for one in (ours, theirs):
        try:
            told.append((ask(one), ""))
        except Exception as error:
            told.append((type(error), str(error)))
    assert told[0] == told[1]


def twins(body: str, **asked: bool) -> Iterator[type]:
    """The class of a text, by this module and by the standard library."""
    for decorator in (dataclass, dataclasses.dataclass):
        known: dict[str, Any] = {"decorate": decorator(**asked), "__name__": __name__}
        exec(TEXT.format(body=body.replace("\n", "\n    ")), known)
        yield known["Made"]


BODIES = {
    "values": "a: int\nb: str = 'x'\nc: list[int] = field(default_factory=list)",
    "a class variable": "a: int\nmost: ClassVar[int] = 3",
    "not compared": "a: int\nb: int = field(default=1, compare=False)",
    "an __init__ of its own": "a: int\ndef __init__(self) -> None:\n    object.__setattr__(self, 'a', 5)",
    "an __eq__ of its own": "a: int\ndef __eq__(self, other: object) -> bool:\n    return True",
}
ASKED: tuple[dict[str, bool], ...] = (
    {},
    {"frozen": True},
    {"frozen": True, "slots": True},
    {"eq": False},
    {"frozen": True, "order": True},
)
QUESTIONS: tuple[Callable[[Any], Any], ...] = (
    lambda kind: [(f.name, f.type, f.default, f.init, f.compare) for f in dataclasses.fields(kind)],
    lambda kind: str(signature(kind)),
    lambda kind: kind.__match_args__,
    lambda kind: repr(kind(1)),
    lambda kind: repr(kind()),
    lambda kind: kind(1) == kind(1),
    lambda kind: kind(1) == kind(2),
    lambda kind: kind(1) == 1,
    lambda kind: kind(1) < kind(2),
    lambda kind: hash(kind(1)) == hash(kind(1)),
    lambda kind: kind.__hash__ is None,
    lambda kind: repr(dataclasses.replace(kind(1), a=3)),
    lambda kind: dataclasses.asdict(kind(1)),
    lambda kind: setattr(kind(1), "a", 2),
    lambda kind: delattr(kind(1), "a"),
    lambda kind: setattr(kind(1), "other", 2) if hasattr(kind(1), "__dict__") else None,
    lambda kind: dataclasses.is_dataclass(kind),
    lambda kind: repr(copy.deepcopy(kind(1))),
    lambda kind: hasattr(kind, "b"),
    lambda kind: hasattr(kind, "c"),
)


@pytest.mark.parametrize("asked", ASKED, ids=str)
@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("first", range(3))
def test_a_class_answers_as_its_twin(body: str, asked: dict[str, bool], first: int) -> None:
    ours, theirs = twins(BODIES[body], **asked)
    for ask in QUESTIONS[first * 6 :] + QUESTIONS[: first * 6]:  # whatever is asked first
        same(ask, ours, theirs)


@pytest.mark.parametrize("name", MADE)
def test_an_instance_lives_through_pickle_and_copy(name: str) -> None:
    kind, _, values = MADE[name]
    made = kind(*values)
    for again in (pickle.loads(pickle.dumps(made)), copy.deepcopy(made), dataclasses.replace(made)):
        assert type(again) is kind and repr(again) == repr(made)
        assert (again == made) is (name != "eq=False")


def test_a_class_derived_from_one_has_its_fields_and_checks() -> None:
    assert [f.name for f in dataclasses.fields(Named)] == ["begin", "end", "notes", "name"]
    assert Named(1) == Named(1, 9, [], "a") != Span(1, 9)
    with pytest.raises(ValueError, match="behind end"):
        Named(10)

    class Plain(Named):
        def __init__(self) -> None:
            super().__init__(3)

    assert repr(Plain()).endswith("Plain(begin=3, end=9, notes=[], name='a')")
    assert not signature(Plain).parameters
    assert Named(1).notes is not Named(1).notes


def test_nothing_is_written_before_it_is_used() -> None:
    (ours, _) = twins(BODIES["values"], frozen=True)
    before = {name: ours.__dict__[name] for name in ("__init__", "__eq__", "__hash__")}
    one = ours(1)
    assert ours.__dict__["__init__"] is not before["__init__"] and ours.__dict__["__eq__"] is before["__eq__"]
    assert one == ours(1)
    assert ours.__dict__["__eq__"] is not before["__eq__"] and ours.__dict__["__hash__"] is before["__hash__"]


def test_metadata_is_kept() -> None:
    assert dataclasses.fields(Slotted)[1].metadata == {"values": ("b", "c")}
    assert not hasattr(Slotted(1), "__dict__")
