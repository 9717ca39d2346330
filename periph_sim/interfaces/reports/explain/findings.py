"""Findings from the records at the ends of an occurrence and around an instant, for budgets of every kind.

ends of a measure of events                  --> the records of these events
ends of other measures                       --> the records of the bus, a line or a module that determine the values

an address or byte that was not acknowledged --> the write of I2COAR, IRS or NACKMOD, or the missing write
bytes of a read                              --> the write of I2CDXR for each byte, or the device's memory
a round that is due, a line held low         --> the earlier transfers, the wait that does not end, the unread byte
words in the FIFO                            --> the previous read, the next read, and the firmware between these reads
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby, pairwise

from ....core.records import UNWANTED, Kind, Record
from ....records.record_text import bus_byte, happened, on_the_bus
from ....scene.scope import scope_of_case
from ....timing.measures.event import EventMeasure
from ....timing.measures.expectations import WatchedWire
from ....timing.measures.factory import measure_named
from ....timing.measures.measure import Measure
from .chain import Part, Step
from .cpu_activity import episodes
from .evidence import I2C, SCI, Evidence, RecordedPhase, in_time
from .fault_evidence import (
    ONES,
    answering,
    bytes_of_device,
    bytes_sent,
    is_master,
    missing_condition,
    note_of_device,
    own_address,
    refusing,
    sender,
    stale,
    unread,
    waited_for,
)
from .occurrence import LATE

DERIVED_FROM = {
    Kind.TRANSFER: (Kind.BUS, Kind.EDGE),
    Kind.ROUND: (Kind.BUS,),
    Kind.RECEIVER: (Kind.FLAG, Kind.FRAME),
    Kind.DATA: (Kind.FRAME, Kind.BUS),
}
ON_THE_BUS = frozenset({Kind.TRANSFER, Kind.ROUND})


@dataclass(frozen=True)
class Ends:
    """The records at both ends of an occurrence.

    begin, end: the record at the start and at the end; None if there is no record, for example at the end of the run.
    thing: the name of the last event of the measure, such as "refused"; "" if the measure has no such name.
    """

    begin: Record | None
    end: Record | None
    thing: str
    measure: Measure

    @classmethod
    def of(cls, evidence: Evidence) -> Ends:
        window, case = evidence.window, evidence.case
        measure = measure_named(window.verdict.measure, scope_of_case(case))
        begin, end = (_at(evidence, measure, tick) for tick in (window.begin, window.end))
        last = measure.matchers[-1] if isinstance(measure, EventMeasure) else None
        thing = last.what if last is not None and last.thing is not None else ""
        return cls(begin, end, thing, measure)

    @property
    def on_the_bus(self) -> bool:
        """True if the measure is one of transfers or rounds, or if both ends are records of the I2C bus."""
        there = [r for r in (self.begin, self.end) if r is not None]
        of_bus = [r for r in there if r.kind is Kind.BUS or (r.kind is Kind.EDGE and r.where in ("SCL", "SDA"))]
        return bool(self.measure.kinds & ON_THE_BUS) or len(of_bus) == 2


def looks_at(measure: Measure, record: Record) -> bool:
    """Return True if a record is an event of a measure."""
    if hasattr(measure, "matchers"):
        return any(matcher.fits(record) for matcher in measure.matchers)
    if hasattr(measure, "watched"):
        return bool(measure.watched.is_about(record.kind, record.where, record.what))
    return record.kind in measure.kinds and measure.tag_of(*record[2:5]) != UNWANTED


def _at(evidence: Evidence, measure: Measure, tick: int) -> Record | None:
    """Return the record at an end of an occurrence, given the tick of this end; None if there is no record.

    The tick of the record may differ by the rounding error of a verdict's instant (see `Evidence.slip`).
    """
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


FIFO = ("SCIFFRX.RXFFINT", "SCIFFRX.RXFFOVF", "SCIRXST.OE")  # flags that request a read or show a late read
WORDS = "SCIFFRX.RXFFST"


PROMPT = Fraction(1, 10**6)  # in seconds; accesses and changes within this time are shown together


# A finding about an instant consists of steps in any order, and of the cause, which is None if it is unknown.
# An explanation blames this cause or, if it is unknown, the firmware's activity at the instant.
Finding = tuple[list[Step], Part | None]


def asked(evidence: Evidence, phase: RecordedPhase, until: int) -> list[Step]:
    """Return steps for the START and the address of a phase, and for its bytes up to a tick."""
    steps = [evidence.say(phase.begin, f"{phase.start}, {phase}")]
    if phase.answered is not None:
        which = "address" if phase.acked else f"address 0x{phase.address:02X} not"
        steps.append(evidence.say(phase.answered, f"{which} acknowledged"))
    return steps + [
        evidence.step(byte, f"byte {n}: {on_the_bus(byte)}")
        for n, byte in enumerate(phase.data, 1)
        if byte.tick <= until
    ]


def transfers(evidence: Evidence, begin: int, end: int) -> list[Step]:
    """Return a Step for each `RecordedPhase` that begins between two ticks.

    Consecutive phases with the same address and direction share a Step if the address was not acknowledged.
    """
    steps = []
    inside = [phase for phase in evidence.phases if begin <= phase.begin < end]
    for (acked, name), alike in groupby(inside, key=lambda phase: (phase.acked, str(phase))):
        phases = list(alike)
        for first, last in [(phase, phase) for phase in phases] if acked else [(phases[0], phases[-1])]:
            times = f", {len(phases)} times" if len(phases) > 1 else ""
            text = name if acked else f"{name}, not acknowledged{times}"
            steps.append(evidence.say(first.begin, text, min(last.end, end) - first.begin))
    return steps


def held(evidence: Evidence, begin: int, end: int) -> list[Step]:
    """Return a step for each time in which SCL was held low between two ticks.

    The step names the party that held SCL low. If this is a unit, the step also has the activity of its firmware.
    """
    steps = []
    for let_go, rise in evidence.stretches(begin, end):
        holder = evidence.holder_at(rise - 1)
        doing = f": {evidence.for_unit(holder).doing_at(let_go)[0]}" if holder in evidence.case.unit else ""
        steps.append(evidence.say(let_go, f"SCL held low by {holder}{doing}", rise - let_go))
    return steps


def answered(evidence: Evidence, phase: RecordedPhase, until: int) -> list[Step]:
    """Return a step for the last access to the data of a phase up to a tick; an empty list if there is none.

    The step states how long SCL was held low until the access, or how long before the release of SCL the access was.
    """
    free, rise = max(evidence.stretches(phase.begin, until), default=(until, until))
    accesses = (evidence.last_access(rise, f"W {I2C}.I2CDXR"), evidence.last_access(rise, f"R {I2C}.I2CDRR"))
    last = max((r for r in accesses if r is not None), key=in_time, default=None)
    if last is None or last.tick < phase.begin:
        return []
    if last.tick > free:
        return [awaited(evidence, last, free)]
    return [evidence.step(last, f"{happened(last)}, {evidence.span(free - last.tick)} before SCL is released")]


def awaited(evidence: Evidence, access: Record, let_go: int) -> Step:
    """Return a step for the access that ended the time in which SCL was held low.

    let_go: the tick at which the controller released SCL.
    """
    return evidence.step(access, f"{happened(access)}, for which SCL was held {evidence.span(access.tick - let_go)}")


def _refused(evidence: Evidence, ends: Ends) -> Finding:
    """Find the address that was not acknowledged at an instant, and the reason.

    If the measure counts refused transfers or rounds, find the first such address in a phase that ends after the
    instant.
    """
    at = evidence.window.begin
    if not ends.measure.kinds & {Kind.BUS, Kind.TRANSFER, Kind.ROUND} or ends.thing in LATE:
        return [], None
    there = (p for p in evidence.phases if not p.acked and p.answered is not None and p.end > at)
    phase = next((p for p in there if ends.thing == "refused" or p.answered == at), None)
    if phase is None or phase.answered is None:
        return [], None
    steps = [*asked(evidence, phase, phase.answered), evidence.doing_step(phase.answered)]
    if is_master(evidence, phase.answered):
        return steps, None
    lacks = missing_condition(evidence, phase.answered)
    own, wrong = own_address(evidence, phase.answered, phase.address)
    steps += [*lacks, *own, *unread(evidence, phase.answered), *stale(evidence, phase)]
    return steps, evidence.blame_at(phase.answered) or _blamed(lacks or wrong)


def _transfer(evidence: Evidence, ends: Ends) -> Finding:
    """Find the phase that begins at an instant. Refused transfers are left out, because `_refused` finds them."""
    at = evidence.window.begin
    phase = next((p for p in evidence.phases if p.begin == at), None)
    if Kind.TRANSFER not in ends.measure.kinds or phase is None or ends.thing == "refused":
        return [], None
    prompt = "SCL rises as soon as the controller releases it, everywhere in this phase"
    free = [] if evidence.stretches(phase.begin, phase.end) else [evidence.say(at, prompt)]
    return [*asked(evidence, phase, at), *free], None


def _refused_byte(evidence: Evidence, ends: Ends) -> Finding:
    """Find the reason why a data byte was not acknowledged."""
    at, record = evidence.window.begin, ends.begin
    carried = None if record is None or record.kind is not Kind.BUS or record.what == "address" else bus_byte(record)
    phase = evidence.phase_at(at)
    refused = record is not None and (record.what == "NACK" or (carried is not None and not carried.acked))
    if phase is None or phase.answered == at or not refused:
        return [], None
    to_blame = [] if is_master(evidence, at) else refusing(evidence, at)
    return [*asked(evidence, phase, at), *to_blame, *unread(evidence, at)], _blamed(to_blame)


def _blamed(steps: list[Step]) -> Part | None:
    """Return the first step with a place in the firmware as the cause; None if no step has a place."""
    step = next((step for step in steps if step.place is not None), None)
    return None if step is None else Part("code", step.what.partition(",")[0], 0, 1, step.place)


def _bytes(evidence: Evidence, ends: Ends) -> Finding:
    """Find the origin of each byte of a read.

    If a unit sent the byte, its origin is a write of I2CDXR. The firmware may have made this write before the START of
    the read, for an earlier read. If a device sent the byte, its origin is the device and, in a memory, the word.

    If the firmware wrote every byte after the START, it had calculated a wrong value before. The first write is then
    given as the cause, and the spans and service routines before the read are listed, too.
    """
    at = evidence.window.begin
    phase = next((p for p in evidence.phases if p.begin >= at), None)
    if Kind.DATA not in ends.measure.kinds or phase is None:
        return [], None
    if sender(evidence, phase):
        noted, cause = note_of_device(evidence, phase)
        return [*noted, *asked(evidence, phase, at), *bytes_of_device(evidence, phase)], cause
    evidence = answering(evidence, phase)
    steps = [*asked(evidence, phase, at), *stale(evidence, phase)]
    blame: Part | None = None
    written: Part | None = None
    for byte, write, said in bytes_sent(evidence, phase):
        if write is None:
            steps.append(evidence.say(byte.tick, said))
        else:
            early = write.tick < phase.begin
            which = ", before the read's START" if early else ""
            wrote = evidence.step(write, f"I2CDXR = 0x{write.value:02X} written{which}")
            steps += [*([wrote] if early else []), evidence.say(byte.tick, said, None, wrote.place)]
            written = written or Part("code", "I2CDXR written", 0, 1, wrote.place)
            blame = blame or (written if early else None)
        lacks = missing_condition(evidence, byte.tick) if byte.value >> 1 == ONES else []
        steps += lacks
        blame = blame or _blamed(lacks)
    if blame is None and all(write is not None for _, write, _ in bytes_sent(evidence, phase)):
        before = episodes(evidence.window, evidence.unit, evidence.window.kept[0].begin, at)
        steps += [evidence.episode_step(one, at) for one in before if one.doing in ("interrupt", "span")]
    return [*steps, *unread(evidence, phase.end)], blame or written


def _round_before(evidence: Evidence, ends: Ends) -> Finding:
    """Find the transfers in the period before a round is due.

    If a wait in one of these transfers ended at once, because a flag was still set from an earlier transfer, also find
    the read of this flag.
    """
    due = evidence.window.begin
    before = max(evidence.due_before(due), evidence.window.kept[0].begin)
    if Kind.ROUND not in ends.measure.kinds or ends.thing == "refused":
        return [], None
    steps = transfers(evidence, before, due)
    shows = next((phase for phase in evidence.phases if phase.begin == due), None)
    begins, lacks = "a round is due", "but the one before still runs"
    if shows is not None:
        begins, lacks = f"{shows} begins", "and the request before it was not made"
    else:
        old = [step for phase in evidence.phases if before <= phase.begin < due for step in stale(evidence, phase)]
        steps += [*held(evidence, before, due), *evidence.story(before, due, waits=False), *old[-1:]]
    return [*steps, evidence.say(due, f"{begins}, {lacks}" if ends.thing == "missed" else begins)], None


def _hung(evidence: Evidence, ends: Ends) -> Finding:
    """Find the lines that are low, the wait that does not end, and the byte that was not read."""
    at = evidence.window.begin
    if ends.thing not in LATE or any(phase.begin == at for phase in evidence.phases):
        return [], None
    falls = [
        evidence.say(since, f"{name} falls, and stays low", at - since)
        for name in (("SCL", "SDA") if ends.thing == "stuck" else ())
        if (since := evidence.low_since(name, at)) is not None
    ]
    return [*falls, *waited_for(evidence, at), *unread(evidence, at)], None


def _fifo(evidence: Evidence, ends: Ends) -> Finding:
    """Find the last read of the FIFO, and the firmware's activities while characters accumulated in the FIFO."""
    at = evidence.window.begin
    if Kind.RECEIVER not in ends.measure.kinds and (ends.begin is None or ends.begin.what not in (*FIFO, WORDS)):
        return [], None
    first, over = evidence.window.kept[0].begin, evidence.window.kept[-1].end
    since = max((r.tick for r in evidence.flags(first, at, WORDS) if not r.value), default=first)
    frames = [r for r in evidence.window.between(since, at, Kind.FRAME) if r.what == "byte"]
    steps: list[Step] = []
    last = evidence.last_access(at, f"R {SCI}.SCIRXBUF")
    if last is not None:
        steps.append(evidence.step(last, f"SCIRXBUF read for the last time, {evidence.span(at - last.tick)} before"))
    if frames:
        text = f"the host begins its first character of {len(frames)}"
        steps.append(evidence.say(frames[0].tick, text, at - frames[0].tick))
        since = frames[0].tick
    steps += [evidence.step(flag) for flag in evidence.flags(since, at, *FIFO) if flag.value]
    words = evidence.flags(at, at, WORDS)[-1:]
    steps += [evidence.say(at, f"{flag.value} words in the FIFO") for flag in words]
    later = evidence.accesses(at, over, f"R {SCI}.SCIRXBUF")[:1]
    steps += [evidence.step(r, f"SCIRXBUF read, {evidence.span(r.tick - at)} later") for r in later]
    return [*steps, *evidence.story(since, at, waits=False)], None


def _beside(evidence: Evidence, ends: Ends) -> Finding:
    """Find the register accesses and the changes of fields that a measure uses, close to the start of the occurrence.

    Return no steps unless the measure uses both kinds of records, and no other kind.
    """
    at, near = evidence.window.begin, evidence.window.timebase.ticks(PROMPT, "nearest")
    if ends.measure.kinds != {Kind.ACCESS, Kind.FLAG}:
        return [], None
    found = [r for r in evidence.window.records if abs(r.tick - at) <= near and looks_at(ends.measure, r)]
    return [evidence.step(r) for r in found], None


def _periods(evidence: Evidence, ends: Ends) -> Finding:
    """Find the periods before and after an event whose jitter is measured."""
    at, record = evidence.window.begin, ends.begin
    if (
        record is None
        or not ends.measure.is_jitter
        or evidence.window.verdict.unit != "us"
        or not looks_at(ends.measure, record)
    ):
        return [], None
    ticks = [r.tick for r in evidence.window.records if (r[2:6]) == record[2:6]]
    around = [*[tick for tick in ticks if tick < at][-1:], at, *[tick for tick in ticks if tick > at][:1]]
    name = f"{evidence.step(record).what}: a period of"
    steps = [
        evidence.say(begin, "then one of" if number else name, end - begin)
        for number, (begin, end) in enumerate(pairwise(around))
    ]
    return [*steps, *evidence.story(around[0], around[-1])], None


FINDINGS: tuple[Callable[[Evidence, Ends], Finding], ...] = (
    _refused,
    _refused_byte,
    _transfer,
    _bytes,
    _round_before,
    _hung,
    _fifo,
    _beside,
    _periods,
)
