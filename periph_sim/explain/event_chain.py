"""Why two events lay so far apart: both with their causes, and what the firmware did in between.

Evidence, events --> ChainBuilder
"""

from __future__ import annotations

from fractions import Fraction

from ..core.records import Kind, Record
from ..records.cause_trace.causes import walk_back
from ..records.record_text import happened
from ..records.run import Run
from ..timing.language.events import Matcher
from ..timing.measures.race import Watched
from ..traces.formats.record_table import Columns
from .bus_chain import ChainBuilder, nack
from .chain import Part, Step, parts_of
from .evidence import Evidence, in_order

WRITES = 6  # told of those in between
BACK = 2  # causes told of each end
PROMPT = Fraction(1, 10**6)  # seconds: an interrupt that is taken as soon as this had nothing in its way


def between(look: Evidence, begin: Matcher | None, end: Matcher | None) -> ChainBuilder:
    """From one event to another. A matcher of None, or an event that is not among the records kept, is not told."""
    window = look.window
    first = find(look, begin, window.begin)
    second = find(look, end, window.end)
    look = look.of(unit_of(look, second) or unit_of(look, first) or look.unit)
    steps: list[Step] = []
    story = look.story(window.begin, window.end)
    for record in (first, second):
        if record is not None:
            own = look.step(record)
            told = record.value == 1 and any((one.at, one.place) == (own.at, own.place) for one in story)
            came = [step for step in causes(look, record) if step.at not in {earlier.at for earlier in steps}]
            steps += came if told else [*came, own]
    return ChainBuilder(
        in_order(steps, story, writes(look, window.begin, window.end)),
        parts_of(look.timeline(window.begin, window.end)),
    )


def latency(look: Evidence, asked: Matcher, entered: Matcher | None) -> ChainBuilder:
    """From an interrupt's request in the PIE to its service routine, and whether another routine was in its way."""
    story = between(look, asked, entered)
    window = look.window
    if window.end - window.begin < window.timebase.ticks(PROMPT, "nearest") or any(
        part.doing == "interrupt" for part in story.parts
    ):
        return story
    off = look.say(window.begin, "the CPU does not take it, and no other routine is served: interrupts are off")
    return story._replace(steps=in_order(story.steps, [off]))


def once(look: Evidence, event: Matcher | None = None) -> ChainBuilder:
    """One event with its causes, and what the firmware did then."""
    at = look.window.begin
    record = find(look, event, at)
    if record is not None and (record.kind, record.what) == (Kind.BUS, "NACK"):
        return nack(look)
    look = look.of(unit_of(look, record) or look.unit)
    now = look.say(at, f"{look.unit}: {look.doing_at(at)}", None, look.place_at(at))
    if record is None:
        return ChainBuilder((now,), (), look.blame_at(at))
    told = look.step(record)
    blame = look.blame_at(at) if told.place is None else Part("code", told.what, 0, 1, told.place)
    return ChainBuilder(in_order(causes(look, record), [told, now]), (), blame)


def two_periods(look: Evidence, event: Matcher) -> ChainBuilder:
    """The period before an event and the one behind it, which differ so much."""
    at = look.window.begin
    ticks = [r.tick for r in look.window.records if event.fits(r)]
    before = max((tick for tick in ticks if tick < at), default=at)
    behind = min((tick for tick in ticks if tick > at), default=at)
    record = find(look, event, at)
    look = look.of(unit_of(look, record) or look.unit)
    steps = [look.say(before, f"{event.text}: a period of", at - before), look.say(at, "then one of", behind - at)]
    return ChainBuilder(in_order(steps, look.story(before, behind)), (), look.blame_at(at))


def whole(look: Evidence) -> ChainBuilder:
    """What the firmware did in the last part of the run: of a load, which is of all of it."""
    span = look.window.kept[-1]
    parts = parts_of(look.timeline(span.begin, span.end - 1))
    told = f"the last {look.span(span.end - 1 - span.begin)} of the run: " + ", ".join(
        f"{part} {look.span(part.length)}" for part in parts
    )
    blame = next((part for part in parts if part.doing in ("interrupt", "span")), None)
    return ChainBuilder((look.say(span.begin, told, span.end - 1 - span.begin),), (), blame)


def around(look: Evidence, watched: Watched) -> ChainBuilder:
    """Reads, writes and changes of a register around an instant: who came close to whom."""
    at, near = look.window.begin, look.window.timebase.ticks(PROMPT, "nearest")
    found = [r for r in look.window.records if abs(r.tick - at) <= near and watched.shows(r)]
    look = look.of(unit_of(look, next(iter(found), None)) or look.unit)
    return ChainBuilder(tuple(look.step(r) for r in found), (), look.blame_at(at))


def one_of(look: Evidence, events: list[Matcher], at: int) -> Matcher | None:
    """The event that happened at a tick; None if none of them did."""
    return next((event for event in events if find(look, event, at) is not None), None)


def find(look: Evidence, event: Matcher | None, at: int) -> Record | None:
    """The record of an event that is nearest to a tick, within what rounding to 0.1 ns may have cost."""
    if event is None:
        return None
    slip = look.window.timebase.per_second // 10**10 + 1
    near = [r for r in look.window.records if abs(r.tick - at) <= slip and event.fits(r)]
    return min(near, key=lambda r: abs(r.tick - at), default=None)


def unit_of(look: Evidence, record: Record | None) -> str:
    """The unit that an event happened in; "" if it is one of a wire, the bus or the host."""
    if record is None:
        return ""
    unit = record.where.partition(".")[0]
    return unit if unit in look.case.unit else ""


def writes(look: Evidence, begin: int, end: int) -> list[Step]:
    """The first accesses in between that write."""
    found = [r for r in look.window.between(begin, end - 1, Kind.ACCESS) if r.where == look.unit and r.what[0] == "W"]
    return [look.step(r) for r in found[:WRITES]]


def causes(look: Evidence, record: Record) -> list[Step]:
    """What made it happen, as far as the records tell (see `records.why.causes`)."""
    window = look.window
    columns = Columns()
    rows: dict[int, int] = {}
    for one in sorted({*window.before, *window.records}, key=lambda r: r.number):
        rows[one.number] = len(columns)
        columns.add(one)
    modules = {name: unit.modules for name, unit in look.case.unit.items()}
    per_second = Fraction(window.timebase.per_second)
    run = Run(columns.table(per_second, window.kept[-1].end, modules), look.case.name)
    kept = {one.number: one for one in (*window.before, *window.records)}
    told = []
    for step in list(walk_back(run, rows[record.number], BACK))[1:]:
        cause = kept[step.record.number]  # with its place in the firmware, which a table does not keep
        told.append(look.step(cause, f"{happened(cause)} ({step.because.partition(';')[0]})"))
    return told
