"""Watchers of wires: compare edges with the expected ones, and report deviations and missing edges.

Each file of this folder that defines KIND is one kind of watcher. The files are found automatically. A file defines

    KIND                      the value of `kind` in [watch.NAME]
    Settings                  a `Table` with the keys of this kind
    build(settings, place)    a function that returns the watcher

A watcher is called at every edge and at the end of the run. Its caller compares the deviations with the `tolerance` of
the table.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any, Protocol, cast

from ...core.discover import modules_with
from ...core.table import Table

EDGE_NAMES = ("fall", "rise")  # for each level after an edge, the name of the edge


@dataclass(frozen=True)
class WatchContext:
    """The environment of a new watcher.

    ticks: a function that converts seconds to ticks.
    start: the first tick of the run.
    tolerance: the tolerance in ticks.
    on_deviation: a function that is called with (deviation, tick) for each edge, period or on-time. deviation: in
        ticks, 0 or more. tick: the tick of the edge, or of the start of the period or on-time.
    refute: a function that the watcher calls to make the run fail, with the reason and the tick of the failure.
    """

    wire: str
    ticks: Callable[[Fraction], int]
    start: int
    tolerance: int
    on_deviation: Callable[[int, int], None]
    refute: Callable[[str, int], None]

    def at(self, tick: int) -> str:
        """Format a tick as a time in seconds from the start of the run."""
        return f"{(tick - self.start) / self.ticks(Fraction(1)):.6f} s"


class WireWatcher(Protocol):
    """Interface of an object that judges the edges of a wire."""

    def edge(self, now: int, level: int) -> None:
        """Handle an edge, after which the wire has this level."""

    def finish(self, now: int) -> None:
        """Handle the end of the run."""

    def missing(self) -> str:
        """Return the reason why no deviation was measured; "" if no reason is known.

        This method is called after `finish`, and only if there was no deviation.
        """


class Family(Protocol):
    """Interface of the modules that define watchers."""

    KIND: str
    Settings: type[Table]

    def build(self, settings: Any, place: WatchContext) -> WireWatcher: ...


@cache
def watchers() -> Mapping[str, Family]:
    """Return the module of this folder that defines each kind of watcher, by the name of the kind."""
    return {module.KIND: cast(Family, module) for module in modules_with("KIND", __name__, __path__).values()}
