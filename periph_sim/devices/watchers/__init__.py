"""Watchers of wires: compare edges with the expected ones, and report deviations and missing edges.

One file of this folder that has KIND is one kind of watcher, found by its presence. It defines

    KIND                      the value of `kind` in [watch.NAME]
    Settings                  a `Table` of its own keys there
    build(settings, place)    the watcher

It receives every edge and the run's end. Its deviations are compared with the table's `tolerance`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any, Protocol, cast

from ...core.discover import modules_with
from ...core.table import Table

EDGE_NAMES = ("fall", "rise")  # by the new level


@dataclass(frozen=True)
class WatchContext:
    """The environment of a new watcher. ticks: converts seconds. start: the first tick of the run. tolerance: ticks.

    on_deviation: called with a deviation and its tick. refute: called with the reason why the run fails, and the tick.
    """

    wire: str
    ticks: Callable[[Fraction], int]
    start: int
    tolerance: int
    on_deviation: Callable[[int, int], None]
    refute: Callable[[str, int], None]

    def at(self, tick: int) -> str:
        """Format a tick as seconds from the run's begin."""
        return f"{(tick - self.start) / self.ticks(Fraction(1)):.6f} s"


class WireWatcher(Protocol):
    """The interface of a judge of a wire's edges."""

    def edge(self, now: int, level: int) -> None:
        """Handle an edge: the wire has this level from now on."""

    def finish(self, now: int) -> None:
        """Handle the end of the run."""

    def missing(self) -> str:
        """Return why there is no deviation, or ""."""


class Family(Protocol):
    """The definitions of every file of watchers."""

    KIND: str
    Settings: type[Table]

    def build(self, settings: Any, place: WatchContext) -> WireWatcher: ...


@cache
def watchers() -> Mapping[str, Family]:
    """Return the files of this folder by their kind."""
    return {module.KIND: cast(Family, module) for module in modules_with("KIND", __name__, __path__).values()}
