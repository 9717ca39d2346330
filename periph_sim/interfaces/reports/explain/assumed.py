"""Undocumented behaviours that a run assumes in an occurrence or shortly before it.

Each of these behaviours has an option, and a run collects the names of all options that it has used. To find the names
for one occurrence, the run is repeated: the collection is emptied shortly before the occurrence and read at its end.
Because this takes time, it is done only for failures.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from ....core.time import Timebase
from ....processor.user_code import FirmwareError, output_muted
from ....scene.case.model import Case
from ....scene.result import Result, touched_sets, unknowns
from ....scene.scene import Scene
from ....traces.capture.capture import Span
from .occurrence import occurrence

SHORTLY = Fraction(180, 1_000_000)  # seconds before an occurrence that count as shortly before it: 18 bits at 100 kHz
LATEST = 1.0  # in seconds; `assumed_in` repeats a run only for occurrences up to this instant


def shortly_before(begin: int, end: int, timebase: Timebase) -> Span:
    """Return the ticks of an occurrence and those shortly before it."""
    return Span(begin - timebase.ticks(SHORTLY, "nearest"), end)


def advance(scene: Scene, until: int, spans: Sequence[Span | None]) -> list[tuple[str, ...]]:
    """Run a scene up to a tick. Return, for each span, the sorted names of the options that were used in this span."""
    found: list[set[str]] = [set() for _ in spans]
    since = scene.kernel.now
    for tick in sorted({tick for span in spans if span for tick in span if since < tick < until} | {until}):
        for touched in touched_sets(scene):
            touched.clear()
        scene.advance(tick)
        for names, span in zip(found, spans, strict=True):
            if span is not None and span.begin < tick and span.end > since:
                names.update(unknowns(scene))
        since = tick
    return [tuple(sorted(names)) for names in found]


def assumed_in(case: Case, result: Result, length: Fraction | None) -> dict[str, tuple[str, ...]]:
    """Repeat a failed run. Return the undocumented behaviours that the worst occurrence of each broken budget assumes.

    The result is a dictionary from the name of a budget to the names of the options for these behaviours. Budgets whose
    worst occurrence has no instant or is later than LATEST are left out, because a long second run is not worth its
    time. Return {} if the firmware fails in the second run, or if the run assumed no undocumented behaviour.

    length: the duration of the run in seconds; None for the duration that the case states.
    """
    broken = [v for v in result.budgets if v.broken and v.at_s is not None and v.at_s <= LATEST]
    if not broken or not result.unknowns:
        return {}
    with output_muted():
        scene = Scene(case)
        end = scene.start + scene.timebase.ticks(case.duration if length is None else length, "nearest")
        spans = [
            shortly_before(*occurrence(verdict, scene.timebase, scene.start), scene.timebase) for verdict in broken
        ]
        try:
            found = advance(scene, min(max(span.end for span in spans), end), spans)
        except FirmwareError:  # the firmware behaves differently in the second run
            return {}
    return {verdict.name: names for verdict, names in zip(broken, found, strict=True)}
