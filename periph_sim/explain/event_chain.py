"""Explanations of events and of the time between two events: their causes, and the firmware's activity.

Evidence, events --> Chain
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from ..core.records import Kind, Record
from ..records.cause_trace.causes import walk_back
from ..records.record_text import happened
from ..records.run import Run
from ..timing.language.events import Matcher
from ..timing.measures.watched import Watched
from ..traces.formats.record_table import Columns
from .bus_chain import nack
from .chain import Chain, Part, Step, parts_of
from .evidence import Evidence, in_order

WRITES = 6  # writes in between that are listed
BACK = 2  # causes listed for each end
PROMPT = Fraction(1, 10**6)  # seconds: an interrupt served within this was not blocked


def between(evidence: Evidence, begin: Matcher | None, end: Matcher | None) -> Chain:
    """Explain the time between two events. A matcher of None, or an event without a kept record, is omitted."""
    window = evidence.window
    first = find(evidence, begin, window.begin)
    second = find(evidence, end, window.end)
    evidence = evidence.for_unit(unit_of(evidence, second) or unit_of(evidence, first) or evidence.unit)
    steps: list[Step] = []
    story = evidence.story(window.begin, window.end)
    for record in (first, second):
        if record is not None:
            own = evidence.step(record)
            listed = record.value == 1 and any((one.at, one.place) == (own.at, own.place) for one in story)
            came = [step for step in causes(evidence, record) if step.at not in {earlier.at for earlier in steps}]
            steps += came if listed else [*came, own]
    return evidence.chain(
        in_order(steps, story, writes(evidence, window.begin, window.end)),
        parts_of(evidence.timeline(window.begin, window.end)),
    )


def latency(evidence: Evidence, asked: Matcher, entered: Matcher | None) -> Chain:
    """Explain an interrupt's latency, from its request in the PIE to its service routine, and what blocked it."""
    story = between(evidence, asked, entered)
    window = evidence.window
    if window.end - window.begin < window.timebase.ticks(PROMPT, "nearest") or any(
        part.doing == "interrupt" for part in story.parts
    ):
        return story
    off = evidence.say(window.begin, "the CPU does not take it, and no other routine is served: interrupts are off")
    return replace(story, steps=in_order(story.steps, [off]))


def once(evidence: Evidence, event: Matcher | None = None) -> Chain:
    """Explain a single event by its causes and the firmware's activity."""
    at = evidence.window.begin
    record = find(evidence, event, at)
    if record is not None and (record.kind, record.what) == (Kind.BUS, "NACK"):
        return nack(evidence)
    evidence = evidence.for_unit(unit_of(evidence, record) or evidence.unit)
    now = evidence.say(at, f"{evidence.unit}: {evidence.doing_at(at)}", None, evidence.place_at(at))
    if record is None:
        return evidence.chain((now,), (), evidence.blame_at(at))
    event_step = evidence.step(record)
    if record.kind is Kind.SPAN and record.value:
        now = event_step  # it begins at this instant
    blame = evidence.blame_at(at) if event_step.place is None else Part("code", event_step.what, 0, 1, event_step.place)
    return evidence.chain(in_order(causes(evidence, record), [event_step, now]), (), blame)


def two_periods(evidence: Evidence, event: Matcher) -> Chain:
    """Explain jitter by the periods before and after an event."""
    at = evidence.window.begin
    ticks = [r.tick for r in evidence.window.records if event.fits(r)]
    before = max((tick for tick in ticks if tick < at), default=at)
    behind = min((tick for tick in ticks if tick > at), default=at)
    record = find(evidence, event, at)
    evidence = evidence.for_unit(unit_of(evidence, record) or evidence.unit)
    steps = [
        evidence.say(before, f"{event.text}: a period of", at - before),
        evidence.say(at, "then one of", behind - at),
    ]
    return evidence.chain(in_order(steps, evidence.story(before, behind)), (), evidence.blame_at(at))


def whole(evidence: Evidence) -> Chain:
    """Explain a load, which is a property of the whole run, by the firmware's activity in its last part."""
    span = evidence.window.kept[-1]
    parts = parts_of(evidence.timeline(span.begin, span.end - 1))
    shares = f"the last {evidence.span(span.end - 1 - span.begin)} of the run: " + ", ".join(
        f"{part} {evidence.span(part.length)}" for part in parts
    )
    blame = next((part for part in parts if part.doing in ("interrupt", "span")), None)
    return evidence.chain((evidence.say(span.begin, shares, span.end - 1 - span.begin),), (), blame)


def around(evidence: Evidence, watched: Watched) -> Chain:
    """Explain a race by the reads, writes and changes of a register around an instant."""
    at, near = evidence.window.begin, evidence.window.timebase.ticks(PROMPT, "nearest")
    found = [r for r in evidence.window.records if abs(r.tick - at) <= near and watched.shows(r)]
    evidence = evidence.for_unit(unit_of(evidence, next(iter(found), None)) or evidence.unit)
    return evidence.chain(tuple(evidence.step(r) for r in found), (), evidence.blame_at(at))


def one_of(evidence: Evidence, events: list[Matcher], at: int) -> Matcher | None:
    """Return the event that happened at a tick; None if none of them did."""
    return next((event for event in events if find(evidence, event, at) is not None), None)


def find(evidence: Evidence, event: Matcher | None, at: int) -> Record | None:
    """Return the record of an event that is nearest to a tick, within the error of rounding to 0.1 ns."""
    if event is None:
        return None
    slip = evidence.window.timebase.per_second // 10**10 + 1
    near = [r for r in evidence.window.records if abs(r.tick - at) <= slip and event.fits(r)]
    return min(near, key=lambda r: abs(r.tick - at), default=None)


def unit_of(evidence: Evidence, record: Record | None) -> str:
    """Return the unit of an event; "" if it is one of a wire, the bus or the host."""
    if record is None:
        return ""
    unit = record.where.partition(".")[0]
    return unit if unit in evidence.case.unit else ""


def writes(evidence: Evidence, begin: int, end: int) -> list[Step]:
    """Return steps of the first writes between two ticks."""
    found = [
        r for r in evidence.window.between(begin, end - 1, Kind.ACCESS) if r.where == evidence.unit and r.what[0] == "W"
    ]
    return [evidence.step(r) for r in found[:WRITES]]


def causes(evidence: Evidence, record: Record) -> list[Step]:
    """Return steps of a record's causes, as far as known (see `records.why.causes`)."""
    window = evidence.window
    columns = Columns()
    rows: dict[int, int] = {}
    for one in sorted({*window.before, *window.records}, key=lambda r: r.number):
        rows[one.number] = len(columns)
        columns.add(one)
    modules = {name: unit.modules for name, unit in evidence.case.unit.items()}
    per_second = Fraction(window.timebase.per_second)
    run = Run(columns.table(per_second, window.kept[-1].end, modules), evidence.case.name)
    kept = {one.number: one for one in (*window.before, *window.records)}
    steps = []
    for step in list(walk_back(run, rows[record.number], BACK))[1:]:
        cause = kept[step.record.number]  # with its place in the firmware, which a table does not contain
        steps.append(evidence.step(cause, f"{happened(cause)} ({step.because.partition(';')[0]})"))
    return steps
