"""Who watches a wire and knows which edges must come: settings go in; deviations and what is missing come out.

One file of this folder that has KIND is one kind of watcher, found by being there. It defines

    KIND                      what `kind` is in [watch.NAME]
    Settings                  a `Table` of the keys that are its own there
    build(settings, place)    the watcher

It is told of every edge and of the run's end. What it takes is compared with the table's `tolerance`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any, Protocol, cast

from ...core.discover import modules_with
from ...core.table import Table

EDGE_NAMES = ("fall", "rise")  # by the level that comes


@dataclass(frozen=True)
class WatchContext:
    """What a watcher is built with. ticks: of seconds. start: the tick at which the run begins. tolerance: ticks.

    take: a deviation, and the tick at which it was. refute: why nothing can make the run good, and since when.
    """

    wire: str
    ticks: Callable[[Fraction], int]
    start: int
    tolerance: int
    take: Callable[[int, int], None]
    refute: Callable[[str, int], None]

    def at(self, tick: int) -> str:
        """When that is, in words: seconds from the run's begin."""
        return f"{(tick - self.start) / self.ticks(Fraction(1)):.6f} s"


class WireWatcher(Protocol):
    """What judges the edges of a wire."""

    def edge(self, now: int, level: int) -> None:
        """The wire has this level from now on."""

    def finish(self, now: int) -> None:
        """The run is over."""

    def missing(self) -> str:
        """Why nothing was taken, where that is so."""


class Family(Protocol):
    """What every file of watchers has."""

    KIND: str
    Settings: type[Table]

    def build(self, settings: Any, place: WatchContext) -> WireWatcher: ...


@cache
def watchers() -> Mapping[str, Family]:
    """The files of this folder by their kind."""
    return {module.KIND: cast(Family, module) for module in modules_with("KIND", __name__, __path__).values()}
