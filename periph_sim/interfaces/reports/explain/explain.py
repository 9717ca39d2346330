"""Explanation of the worst occurrence of each budget: a Chain is made from the Window of the occurrence.

case, verdicts, typical occurrences --> windows --> a Chain for each, with the difference from the typical occurrence

A Chain follows from the records of a window and not from the kind of the budget:

steps of an interval    the causes of the record at its end, back to the record at its start
parts of an interval    begin |-- firmware --|-- SCL held --|-- hardware --| end; the whole interval is divided
steps of an instant     findings from the records around the instant (`findings`)

If both ends are on the bus, the parts are the bits of each transfer, the intervals in which a party holds SCL low, and
the intervals in which the bus is free. Otherwise, the parts are the firmware up to the access that caused the end, and
the module or the line after this access.

The firmware's part is divided by its activity (`cpu_activity`): spans, service routines, waits, other code.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from ....core.records import Kind, Record
from ....records.record_text import IN_FIRMWARE, happened
from ....scene.case.model import Case
from ....scene.firmware_loader import Firmware
from ....timing.budget_schema import REPLY
from ....timing.measures.expectations import WatchedWire
from ....timing.verdict import Verdict
from ....traces.capture.capture import Span
from ....traces.drawing.capture_lanes import bit_of
from .chain import Chain, Part, Step, difference, in_order, parts_of
from .cpu_activity import Stretch
from .evidence import ON_WIRES, Evidence
from .fault_evidence import is_master, waited_for
from .findings import DERIVED_FROM, FINDINGS, PROMPT, Ends, answered, asked, awaited, held, transfers
from .occurrence import is_late
from .reply_evidence import request_of, unanswered, wrong_characters
from .window import BIT, Window, windows


def places(evidence: Evidence, ends: Ends) -> list[Stretch]:
    """Divide an occurrence into stretches. The lengths of the stretches add up to the length of the occurrence."""
    begin, end = evidence.window.begin, evidence.window.end
    if ends.on_the_bus:
        return _of_bus(evidence, begin, end)
    cause = None if ends.end is None else reached(evidence, ends.end)
    if cause is None:
        return evidence.timeline(begin, end)
    since = max(begin, min(cause.tick, end))
    what = f"hardware, after {happened(cause).partition(',')[0]}"
    place = cause.text if cause.kind in IN_FIRMWARE else ""
    hardware = [Stretch(since, end, "hardware", what, place, since)] if since < end else []
    return [*evidence.timeline(begin, since), *hardware]


def reached(evidence: Evidence, record: Record) -> Record | None:
    """Follow the causes of a record back in time. Return the record at which the search ends.

    The search ends at an action of the firmware, or at a record that is not later than the start of the occurrence.
    Return None if there is no such record.
    """
    begin = evidence.window.begin
    causes = (cause for cause, link in evidence.walk(record) if not link.aside)
    return next((cause for cause in causes if cause.kind in IN_FIRMWARE or cause.tick <= begin), None)


def _of_bus(evidence: Evidence, begin: int, end: int) -> list[Stretch]:
    """Divide an interval on the bus into the bits of each transfer, holds of SCL, and the intervals between transfers.

    While the bus is free and the unit is the master, the stretches are the activities of the unit's firmware.
    """
    found: list[Stretch] = []
    at = begin
    for phase in evidence.phases:
        since, until = max(phase.begin, at), min(phase.end, end)
        if until <= since:
            continue
        free = "bus free between two transfers" if at > begin else "START held up"
        found += _activities(evidence, evidence.unit if is_master(evidence, since) else "", at, since, free)
        at, bits = since, f"bits of {phase.name or phase}"
        for let_go, rise in evidence.stretches(since, until):
            found.append(Stretch(at, let_go, "bus", bits, "", phase.begin))
            holder = evidence.holder_at(rise - 1)
            found += _activities(evidence, holder, let_go, rise, f"SCL held low by {holder}")
            at = rise
        found.append(Stretch(at, until, "bus", bits, "", phase.begin))
        at = until
    found += _activities(evidence, evidence.unit if is_master(evidence, end) else "", at, end, "bus free")
    return [one for one in found if one.length > 0]


def _activities(evidence: Evidence, party: str, begin: int, end: int, what: str) -> list[Stretch]:
    """Return stretches for a time in which the bus waits for a party.

    For a unit, these are the activities of its firmware. For another party, return one stretch with the text `what`.
    """
    return (
        evidence.for_unit(party).timeline(begin, end)
        if party in evidence.case.unit
        else [Stretch(begin, end, "bus", what, "", begin)]
    )


WRITES = 6  # maximum number of writes between both ends that are listed


def chain_of(case: Case, window: Window) -> Chain:
    """Return the explanation of the occurrence in a window."""
    evidence = Evidence(window, case)
    ends = Ends.of(evidence)
    places_of_ends = (record.where.partition(".")[0] for record in (ends.end, ends.begin) if record is not None)
    evidence = evidence.for_unit(next((unit for unit in places_of_ends if unit in case.unit), evidence.unit))
    if window.verdict.unit == "%":
        return _share(evidence)
    if window.begin == window.end or isinstance(ends.measure, WatchedWire):
        return _instant(evidence, ends)
    steps = _on_the_bus(evidence, ends) if ends.on_the_bus else _between(evidence, ends)
    wrong = [write for _, write, _ in wrong_characters(evidence)]
    blame = Part("code", wrong[0].what, 0, 1, wrong[0].place) if wrong else None
    again = {(step.at, step.place) for step in wrong}
    steps = [step for step in steps if (step.at, step.place) not in again]
    stretches = [] if _between_rounds(evidence, ends) else places(evidence, ends)
    return evidence.chain(
        in_order(request_of(evidence), steps, wrong, unanswered(evidence)), parts_of(stretches), blame
    )


def _between(evidence: Evidence, ends: Ends) -> list[Step]:
    """Return steps for both ends with their causes, and for the firmware's activities between the ends.

    If `reached` finds no cause of the end, writes and waits of the firmware are left out.
    """
    begin, end = evidence.window.begin, evidence.window.end
    if ends.end is not None and reached(evidence, ends.end) is None:
        unknown = evidence.say(end, f"{evidence.named(ends.end)}, whose cause is not recorded")
        ours = [evidence.step(ends.begin)] if ends.begin is not None else []
        return [*ours, unknown, *_older(evidence, ends), *evidence.story(begin, end, waits=False)]
    story = evidence.story(begin, end)
    steps: list[Step] = []
    for record in (ends.begin, ends.end):
        if record is not None:
            own = evidence.step(record)
            listed = record.value == 1 and any((one.at, one.place) == (own.at, own.place) for one in story)
            came = [step for step in evidence.causes(record, begin) if step.at not in {early.at for early in steps}]
            steps += came if listed else [*came, own]
    accesses = evidence.window.between(begin, end - 1, Kind.ACCESS)
    writes = [evidence.step(r) for r in accesses if r.where == evidence.unit and r.what[0] == "W"][:WRITES]
    return [*steps, *_older(evidence, ends), *story, *writes, *_blocked(evidence, ends)]


def _older(evidence: Evidence, ends: Ends) -> list[Step]:
    """Return steps for reads that returned older data, if the occurrence is the age of a device's data.

    The age ends with a read of the device. The steps are earlier reads of the same device during the age.
    """
    begin, end = evidence.window.begin, evidence.window.end
    read = next((p for p in evidence.phases if p.begin == end), None)
    if read is None or Kind.DATA not in ends.measure.kinds:
        return []
    older = [p for p in evidence.phases if p.begin < end and p.end > begin and p.read and p.address == read.address]
    return [evidence.say(p.begin, f"{p}, with older data", p.end - p.begin) for p in older]


def _blocked(evidence: Evidence, ends: Ends) -> list[Step]:
    """Return a step for an interrupt that was not served at once, although no other service routine was running."""
    begin, end = evidence.window.begin, evidence.window.end
    kinds = [None if record is None else record.kind for record in (ends.begin, ends.end)]
    prompt = end - begin < evidence.window.timebase.ticks(PROMPT, "nearest")
    served = any(one.doing == "interrupt" for one in evidence.timeline(begin, end))
    if kinds != [Kind.FLAG, Kind.IRQ] or prompt or served:
        return []
    return [evidence.say(begin, "the CPU does not take it, and no other routine is served: interrupts are off")]


def _on_the_bus(evidence: Evidence, ends: Ends) -> list[Step]:
    """Return steps for an occurrence on the bus.

    These are the transfers, the intervals in which SCL was held low, and the access that made SCL rise at the end. If
    the occurrence is an interval between two rounds that is too short, the steps describe the first of these rounds.
    """
    begin, end = evidence.window.begin, evidence.window.end
    between = _between_rounds(evidence, ends)
    since, until = (evidence.due_before(end), begin) if between else (begin, end)
    made = [] if between or ends.end is None else _of_firmware(evidence, ends.end, begin)
    phase = evidence.phase_at(begin)
    if phase is None or between or phase.end < end:
        steps = transfers(evidence, since, until)
    else:
        steps = [*asked(evidence, phase, end), *(made or answered(evidence, phase, end))]
    if Kind.ROUND in ends.measure.kinds and not any(p.begin == since for p in evidence.phases):
        steps.append(evidence.say(since, "a round is due"))
    if between:
        steps.append(evidence.say(end, "the next round is due"))
    steps += [*held(evidence, since, until), *evidence.story(since, until, waits=False)]
    if ends.begin is not None:
        steps += _of_firmware(evidence, ends.begin, begin)
        steps += [evidence.step(ends.begin)] if ends.begin.kind is Kind.EDGE else []
    last = ends.begin if between else ends.end
    if last is not None:
        steps += [*made, evidence.step(last)]
    elif evidence.low_since("SCL", end) is not None:
        steps += [*_stopped(evidence, end), evidence.say(end, "SCL is still low: the run ends")]
    return steps


def _stopped(evidence: Evidence, end: int) -> list[Step]:
    """Return steps for a wait that does not end, for the last access before the wait, and for causes of this access."""
    wait = waited_for(evidence, end)
    since = evidence.window.at + wait[0].at if wait else end
    accesses = [r for r in evidence.window.records if r.kind is Kind.ACCESS and r.where == evidence.unit]
    last = next((r for r in reversed(accesses) if r.tick < since), None)
    return wait if last is None else [*wait, *evidence.causes(last, since), evidence.step(last)]


def _between_rounds(evidence: Evidence, ends: Ends) -> bool:
    return Kind.ROUND in ends.measure.kinds and evidence.window.verdict.too_little


def _of_firmware(evidence: Evidence, record: Record, since: int) -> list[Step]:
    """Return steps for the causes of a record of the bus; an empty list if no access of the firmware caused the record.

    The causes go back to the start of the phase in progress at tick `since`. If SCL was held low until the record, the
    step for the access states the time for which SCL was held low.
    """
    made_by = next((cause for cause, _ in evidence.walk(record) if cause.kind not in ON_WIRES), None)
    if made_by is None or made_by.kind is not Kind.ACCESS:
        return []
    phase = evidence.phase_at(since)
    first = since if phase is None else phase.begin
    steps = evidence.causes(record, first)
    for let_go, rise in evidence.stretches(first, record.tick):
        if let_go < made_by.tick <= rise == record.tick:
            own = awaited(evidence, made_by, let_go)
            steps = [own if (step.at, step.place) == (own.at, own.place) else step for step in steps]
    return steps


def _instant(evidence: Evidence, ends: Ends) -> Chain:
    """Explain an instant by findings from the records around it, by its causes, and by the firmware's activity."""
    at = evidence.window.begin
    found = [finding(evidence, ends) for finding in FINDINGS]
    now = evidence.doing_step(at)
    own: Part | None = None
    steps = [step for some, _ in found for step in some]
    if (
        ends.begin is not None
        and not ends.measure.kinds & DERIVED_FROM.keys()
        and not (steps and ends.begin.kind is Kind.BUS)
    ):
        step = evidence.step(ends.begin)
        own = None if step.place is None else Part("code", step.what, 0, 1, step.place)
        now = step if ends.begin.kind is Kind.SPAN and ends.begin.value else now
        steps += [*evidence.causes(ends.begin, at), step]
    of_phase = bool(ends.measure.kinds & DERIVED_FROM.keys()) and any(phase.begin == at for phase in evidence.phases)
    if not of_phase and not any(step.what.startswith(f"{evidence.unit}: ") for step in steps):
        steps.append(now)
    blame = next((cause for _, cause in found if cause is not None), None)
    return evidence.chain(in_order(steps), (), own or blame or (None if of_phase else evidence.blame_at(at)))


def _share(evidence: Evidence) -> Chain:
    """Explain a share of time by the firmware's activities in the last part of the run.

    A share is a property of the whole run, so it has no occurrence.
    """
    span = evidence.window.kept[-1]
    parts = parts_of(evidence.timeline(span.begin, span.end - 1))
    shares = f"the last {evidence.span(span.end - 1 - span.begin)} of the run: " + ", ".join(
        f"{part} {evidence.span(part.length)}" for part in parts
    )
    blame = next((part for part in parts if part.doing in ("interrupt", "span")), None)
    return evidence.chain((evidence.say(span.begin, shares, span.end - 1 - span.begin),), (), blame)


REACH = 70  # maximum width, in bits, of a picture that is extended to show evidence; its bytes are still legible


@dataclass(frozen=True, eq=False)
class Explained:
    """The explanation of a worst occurrence, and the window from which the explanation was made."""

    window: Window
    chain: Chain


def explain(
    case: Case,
    verdicts: Iterable[Verdict],
    typical: Iterable[Verdict] = (),
    length: Fraction | None = None,
    programs: Mapping[str, Firmware] | None = None,
) -> list[Explained]:
    """Return the explanation of the worst occurrence in each verdict that has an instant, in the order of the verdicts.

    Several verdicts may be of the same budget. All records come from one more run of the case.

    typical: the least critical occurrences, with which the worst occurrences of the same budgets are compared.
    length: the duration of the run in seconds; None for the duration that the case states.
    programs: a dictionary from units to firmware that is given as functions.
    """
    worst = [verdict for verdict in verdicts if verdict.at_s is not None]
    names = {verdict.name for verdict in worst}
    usual = [verdict for verdict in typical if verdict.at_s is not None and verdict.name in names]
    found = windows(case, [*worst, *usual], length, programs)
    usual_windows = {w.verdict.name: w for w in found[len(worst) :]}
    return [_explained(case, w, usual_windows.get(w.verdict.name)) for w in found[: len(worst)]]


def _explained(case: Case, window: Window, usual: Window | None) -> Explained:
    chain = chain_of(case, window)
    if usual is not None and (usual.begin, usual.end) != (window.begin, window.end):
        there = chain_of(case, usual)
        more = difference(chain.parts, there.parts) if chain.parts and (there.parts or not there.length) else ()
        chain = replace(chain, typical=there.length, typical_holds=usual.verdict.within, more=more)
    characters = {
        (frame.where, frame.tick, 0): wanted
        for frame, _, wanted in wrong_characters(Evidence(window, case))
        if wanted is not None
    }
    return Explained(_reaching(replace(window, expected={**window.expected, **characters}), chain), chain)


def _reaching(window: Window, chain: Chain) -> Window:
    """Return the window with the texts of the steps in `chain`, and with a picture that is extended to these steps.

    If the window is about a reply, the picture is extended back to the first step. If the window is about an instant,
    the picture is extended to the steps around the instant, the nearest first, up to a width of REACH bits. If the
    instant is the end of a wait that is too long, the picture is not extended; nor is it for any other window.
    """
    begin, end = window.drawn
    if window.verdict.measure.startswith(REPLY) and chain.steps:
        begin = min(begin, window.at + chain.steps[0].at)
    elif window.begin == window.end and not is_late(window.verdict):
        bit = bit_of(window.edges, window.timebase.ticks(BIT, "nearest"))
        for step in sorted(chain.steps, key=lambda step: abs(step.at)):
            first, last = (window.at + step.at + room for room in (-bit, bit))
            if max(end, last) - min(begin, first) <= REACH * bit:
                begin, end = min(begin, first), max(end, last)
    drawn = Span(max(begin, window.kept[0].begin), min(end, window.kept[-1].end))
    return replace(window, chain_texts=tuple(step.what for step in chain.steps), drawn=drawn)
