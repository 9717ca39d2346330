"""The records at the two ends of an occurrence, found by what its measure looks at.

measure of events --> the record that it takes there
others            --> the record of the bus, a line or a module that the measured one is derived from
"""

from __future__ import annotations

from dataclasses import dataclass

from ....core.records import UNWANTED, Kind, Record
from ....scene.case.model import Case
from ....scene.scope import scope_of_case
from ....timing.measures.event import Jitter
from ....timing.measures.event_pairing import EventMeasure
from ....timing.measures.factory import measure_named
from ....timing.measures.measure import Measure
from ....timing.measures.watched_wire import WatchedWire
from .evidence import Evidence

DERIVED_FROM = {
    Kind.TRANSFER: (Kind.BUS, Kind.EDGE),
    Kind.ROUND: (Kind.BUS,),
    Kind.RECEIVER: (Kind.FLAG, Kind.FRAME),
    Kind.DATA: (Kind.FRAME, Kind.BUS),
}
ON_THE_BUS = frozenset({Kind.TRANSFER, Kind.ROUND})


@dataclass(frozen=True)
class Ends:
    """begin, end: the records there; None if there is none, as at the end of the run.

    kinds: of the records that the measure looks at. thing: the name of those that it takes, "" for events.
    jitter: the value is the difference between two values of the measure.
    """

    begin: Record | None
    end: Record | None
    kinds: frozenset[Kind]
    thing: str
    measure: Measure
    jitter: bool

    @classmethod
    def of(cls, evidence: Evidence) -> Ends:
        window, case = evidence.window, evidence.case
        measure = judged = measure_named(window.verdict.measure, scope_of_case(case))
        while isinstance(measure, Jitter):
            measure = measure.of
        begin, end = (_at(evidence, measure, tick) for tick in (window.begin, window.end))
        last = measure.matchers[-1] if isinstance(measure, EventMeasure) else None
        thing = last.what if last is not None and last.thing is not None else ""
        return cls(begin, end, measure.kinds, thing, measure, isinstance(judged, Jitter))

    @property
    def on_the_bus(self) -> bool:
        """True if the time between them is one of the bus alone."""
        there = [r for r in (self.begin, self.end) if r is not None]
        of_bus = [r for r in there if r.kind is Kind.BUS or (r.kind is Kind.EDGE and r.where in ("SCL", "SDA"))]
        return bool(self.kinds & ON_THE_BUS) or len(of_bus) == 2

    def unit(self, case: Case) -> str:
        """Return the unit of the end, or of the begin; "" if both are of a wire, the bus or the host."""
        units = (r.where.partition(".")[0] for r in (self.end, self.begin) if r is not None)
        return next((unit for unit in units if unit in case.unit), "")


def looks_at(measure: Measure, record: Record) -> bool:
    """Return True if a measure looks at a record."""
    if hasattr(measure, "matchers"):
        return any(matcher.fits(record) for matcher in measure.matchers)
    if hasattr(measure, "watched"):
        return bool(measure.watched.shows(record))
    return record.kind in measure.kinds and measure.tag_of(*record[2:5]) != UNWANTED


def _at(evidence: Evidence, measure: Measure, tick: int) -> Record | None:
    """Return the record of an end that is nearest to a tick, within the error of rounding to 0.1 ns."""
    window = evidence.window
    near = [r for r in window.records if abs(r.tick - tick) <= evidence.slip]
    named = [r for r in near if looks_at(measure, r)]
    if named:
        return min(named, key=lambda r: (r.what not in window.verdict.measure, abs(r.tick - tick)))
    if isinstance(measure, WatchedWire):
        wire = evidence.case.watch[measure.name].wire
        return next((r for r in near if (r.kind, r.where) == (Kind.EDGE, wire)), None)
    sources = [source for kind in measure.kinds for source in DERIVED_FROM.get(kind, ())]
    found = [r for r in near if r.kind in sources]
    return min(found, key=lambda r: (sources.index(r.kind), abs(r.tick - tick)), default=None)
