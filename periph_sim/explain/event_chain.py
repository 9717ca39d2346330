"""Why two events lay so far apart: both with their causes, and what the firmware did in between.

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

WRITES = 6  # told of those in between
BACK = 2  # causes told of each end
PROMPT = Fraction(1, 10**6)  # seconds: an interrupt that is taken as soon as this had nothing in its way


def between(evidence: Evidence, begin: Matcher | None, end: Matcher | None) -> Chain:
    """From one event to another. A matcher of None, or an event that is not among the records kept, is not told."""
    window = evidence.window
    first = find(evidence, begin, window.begin)
    second = find(evidence, end, window.end)
    evidence = evidence.of(unit_of(evidence, second) or unit_of(evidence, first) or evidence.unit)
    steps: list[Step] = []
    story = evidence.story(window.begin, window.end)
    for record in (first, second):
        if record is not None:
            own = evidence.step(record)
            told = record.value == 1 and any((one.at, one.place) == (own.at, own.place) for one in story)
            came = [step for step in causes(evidence, record) if step.at not in {earlier.at for earlier in steps}]
            steps += came if told else [*came, own]
    return evidence.chain(
        in_order(steps, story, writes(evidence, window.begin, window.end)),
        parts_of(evidence.timeline(window.begin, window.end)),
    )


def latency(evidence: Evidence, asked: Matcher, entered: Matcher | None) -> Chain:
    """From an interrupt's request in the PIE to its service routine, and whether another routine was in its way."""
    story = between(evidence, asked, entered)
    window = evidence.window
    if window.end - window.begin < window.timebase.ticks(PROMPT, "nearest") or any(
        part.doing == "interrupt" for part in story.parts
    ):
        return story
    off = evidence.say(window.begin, "the CPU does not take it, and no other routine is served: interrupts are off")
    return replace(story, steps=in_order(story.steps, [off]))


def once(evidence: Evidence, event: Matcher | None = None) -> Chain:
    """One event with its causes, and what the firmware did then."""
    at = evidence.window.begin
    record = find(evidence, event, at)
    if record is not None and (record.kind, record.what) == (Kind.BUS, "NACK"):
        return nack(evidence)
    evidence = evidence.of(unit_of(evidence, record) or evidence.unit)
    now = evidence.say(at, f"{evidence.unit}: {evidence.doing_at(at)}", None, evidence.place_at(at))
    if record is None:
        return evidence.chain((now,), (), evidence.blame_at(at))
    told = evidence.step(record)
    if record.kind is Kind.SPAN and record.value:
        now = told  # it has begun just now
    blame = evidence.blame_at(at) if told.place is None else Part("code", told.what, 0, 1, told.place)
    return evidence.chain(in_order(causes(evidence, record), [told, now]), (), blame)


def two_periods(evidence: Evidence, event: Matcher) -> Chain:
    """The period before an event and the one behind it, which differ so much."""
    at = evidence.window.begin
    ticks = [r.tick for r in evidence.window.records if event.fits(r)]
    before = max((tick for tick in ticks if tick < at), default=at)
    behind = min((tick for tick in ticks if tick > at), default=at)
    record = find(evidence, event, at)
    evidence = evidence.of(unit_of(evidence, record) or evidence.unit)
    steps = [
        evidence.say(before, f"{event.text}: a period of", at - before),
        evidence.say(at, "then one of", behind - at),
    ]
    return evidence.chain(in_order(steps, evidence.story(before, behind)), (), evidence.blame_at(at))


def whole(evidence: Evidence) -> Chain:
    """What the firmware did in the last part of the run: of a load, which is of all of it."""
    span = evidence.window.kept[-1]
    parts = parts_of(evidence.timeline(span.begin, span.end - 1))
    told = f"the last {evidence.span(span.end - 1 - span.begin)} of the run: " + ", ".join(
        f"{part} {evidence.span(part.length)}" for part in parts
    )
    blame = next((part for part in parts if part.doing in ("interrupt", "span")), None)
    return evidence.chain((evidence.say(span.begin, told, span.end - 1 - span.begin),), (), blame)


def around(evidence: Evidence, watched: Watched) -> Chain:
    """Reads, writes and changes of a register around an instant: who came close to whom."""
    at, near = evidence.window.begin, evidence.window.timebase.ticks(PROMPT, "nearest")
    found = [r for r in evidence.window.records if abs(r.tick - at) <= near and watched.shows(r)]
    evidence = evidence.of(unit_of(evidence, next(iter(found), None)) or evidence.unit)
    return evidence.chain(tuple(evidence.step(r) for r in found), (), evidence.blame_at(at))


def one_of(evidence: Evidence, events: list[Matcher], at: int) -> Matcher | None:
    """The event that happened at a tick; None if none of them did."""
    return next((event for event in events if find(evidence, event, at) is not None), None)


def find(evidence: Evidence, event: Matcher | None, at: int) -> Record | None:
    """The record of an event that is nearest to a tick, within what rounding to 0.1 ns may have cost."""
    if event is None:
        return None
    slip = evidence.window.timebase.per_second // 10**10 + 1
    near = [r for r in evidence.window.records if abs(r.tick - at) <= slip and event.fits(r)]
    return min(near, key=lambda r: abs(r.tick - at), default=None)


def unit_of(evidence: Evidence, record: Record | None) -> str:
    """The unit that an event happened in; "" if it is one of a wire, the bus or the host."""
    if record is None:
        return ""
    unit = record.where.partition(".")[0]
    return unit if unit in evidence.case.unit else ""


def writes(evidence: Evidence, begin: int, end: int) -> list[Step]:
    """The first accesses in between that write."""
    found = [
        r for r in evidence.window.between(begin, end - 1, Kind.ACCESS) if r.where == evidence.unit and r.what[0] == "W"
    ]
    return [evidence.step(r) for r in found[:WRITES]]


def causes(evidence: Evidence, record: Record) -> list[Step]:
    """What made it happen, as far as the records tell (see `records.why.causes`)."""
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
    told = []
    for step in list(walk_back(run, rows[record.number], BACK))[1:]:
        cause = kept[step.record.number]  # with its place in the firmware, which a table does not keep
        told.append(evidence.step(cause, f"{happened(cause)} ({step.because.partition(';')[0]})"))
    return told
