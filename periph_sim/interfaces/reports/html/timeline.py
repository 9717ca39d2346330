"""A timeline for the script of the page: lanes with events in ticks, as compact JSON.

Times are ticks from `origin` on. In JSON, each is the distance from the one before, so most are short numbers. A lane
is `chosen` if the explanation is about it; only these lanes are drawn at first. Texts of events are indices into
`says`, because many events share a text.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

from .protocol import Row

Ticks = list[int]


class Texts(dict[str, int]):
    """Texts with their indices; each text is stored once. The first line of a text is its title."""

    def place(self, text: str) -> int:
        return self.setdefault(text, len(self))


@dataclass
class Lane:
    """A lane of events. at: the ticks of the events. says: for each event, the index of its text."""

    name: str
    unit: str
    at: Ticks = field(default_factory=list)
    says: list[int] = field(default_factory=list)
    chosen: bool = False

    def json(self) -> dict[str, Any]:
        return {"name": self.name, "unit": self.unit} | ({"chosen": 1} if self.chosen else {})


@dataclass
class Wave(Lane):
    """A binary signal, whose events are edges. initial: the level before the first edge."""

    initial: int = 0

    def json(self) -> dict[str, Any]:
        own = {"kind": "wave", "initial": self.initial, "at": _steps(self.at), "says": self.says}
        return super().json() | own


@dataclass
class Boxes(Lane):
    """Time ranges with labels, in the order in which they begin."""

    end: Ticks = field(default_factory=list)
    labels: list[int] = field(default_factory=list)

    def add(self, begin: int, end: int, label: int, says: int) -> None:
        self.at.append(begin)
        self.end.append(max(end, begin))
        self.labels.append(label)
        self.says.append(says)

    def json(self) -> dict[str, Any]:
        long = [end - at for at, end in zip(self.at, self.end, strict=True)]
        own = {"kind": "boxes", "at": _steps(self.at), "long": long, "labels": self.labels, "says": self.says}
        return super().json() | own


@dataclass
class Marks(Lane):
    """Instants with labels.

    strong: True for each instant that is drawn as more important, such as a write among reads.
    places: the location of each in the firmware; empty if unknown.
    """

    labels: list[int] = field(default_factory=list)
    strong: list[int] = field(default_factory=list)
    places: list[int] = field(default_factory=list)

    def json(self) -> dict[str, Any]:
        own = {"kind": "marks", "at": _steps(self.at), "labels": self.labels, "says": self.says, "strong": self.strong}
        return super().json() | own | ({"places": self.places} if self.places else {})


@dataclass(frozen=True)
class Timeline:
    """The timeline around one worst occurrence.

    origin: the tick of time 0, counted from the start of the run. All other ticks are relative to it.
    begin, end: the begin and the end of the occurrence.
    per_second: ticks per second.
    cycles: ticks per SYSCLKOUT cycle, by unit. Lanes without a unit use those of the first unit.
    shown: the range that is visible at first.
    kept: the available ranges, one or two.
    groups: name and lanes of each group.
    says: the texts that lanes refer to by index.
    rows: the rows of the protocol table, in time order.
    """

    origin: int
    begin: int
    end: int
    per_second: int
    cycles: dict[str, float]
    shown: tuple[int, int]
    kept: tuple[tuple[int, int], ...]
    groups: tuple[tuple[str, tuple[Lane, ...]], ...]
    says: tuple[str, ...]
    rows: tuple[Row, ...] = ()

    def json(self) -> dict[str, Any]:
        return {
            "origin": str(self.origin),  # as text, since it may exceed the integers that a double represents
            "begin": self.begin,
            "end": self.end,
            "perSecond": self.per_second,
            "cycles": self.cycles,
            "shown": self.shown,
            "kept": self.kept,
            "groups": [{"name": name, "lanes": [lane.json() for lane in lanes]} for name, lanes in self.groups],
            "says": self.says,
            "rows": [row.json() for row in self.rows],
        }


def only_chosen(timeline: Timeline) -> Timeline:
    """Return the timeline with only the chosen lanes and their texts."""
    says = Texts()

    def again(lane: Lane) -> Lane:
        moved: dict[str, Any] = {}
        for key in ("labels", "says", "places"):
            if hasattr(lane, key):
                moved[key] = [says.place(timeline.says[n]) for n in getattr(lane, key)]
        return replace(lane, **moved)

    groups = tuple((name, tuple(again(lane) for lane in lanes if lane.chosen)) for name, lanes in timeline.groups)
    return replace(timeline, groups=tuple(one for one in groups if one[1]), says=tuple(says))


def _steps(at: Iterable[int]) -> list[int]:
    """Return each tick as its distance from the previous one, and the first as its distance from 0."""
    return [tick - before for before, tick in pairwise([0, *at])]
