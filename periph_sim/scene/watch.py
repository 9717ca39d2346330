"""Watchers of wires, built from [watch.NAME] tables.

A watcher compares the edges of its wire with expected times, and passes the deviations to a measure:

Wire --edges--> Edges | Blink | ... --deviations--> WatchedWire, a measure
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ..core.phrases import did_you_mean
from ..core.sampler import watch
from ..core.time import Timebase
from ..core.wire import Wire
from ..devices.watchers import WatchContext, WireWatcher, watchers
from ..timing.language.scope import BadEvent
from ..timing.measures.expectations import WatchedWire
from . import plugins
from .case.error_text import own_settings
from .case.model import Case


def watcher_of(
    case: Case, wires: Mapping[str, Wire], timebase: Timebase, start: int, measure: WatchedWire
) -> WireWatcher:
    """Return a measure's watcher, connected to its wire.

    Raise BadEvent if there is no [watch.NAME] with the name of the measure, and BadCase if the table is invalid.
    """
    name = measure.name
    if name not in case.watch:
        raise BadEvent(f"there is no [watch.{name}]; {did_you_mean(name, case.watch)}")
    table = case.watch[name]
    kinds = plugins.known(case.folder, "KIND", watchers(), [table.kind])
    if table.kind not in kinds:
        raise case.unknown("kind of watcher", table.kind, kinds, "watch", name, "kind")
    if table.wire not in wires:
        raise case.unknown("wire", table.wire, wires, "watch", name, "wire")
    family = kinds[table.kind]
    settings = own_settings(case, family.Settings, table, f"a watcher of kind {table.kind!r}", "watch", name)

    def ticks(length: Fraction) -> int:
        return timebase.ticks(length, "nearest")

    context = WatchContext(table.wire, ticks, start, ticks(table.tolerance), measure.take, measure.refute)
    watcher = family.build(settings, context)
    watch([wires[table.wire]], watcher.edge)
    return watcher
