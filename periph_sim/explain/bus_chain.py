"""Explanations of measures of the bus: answers, stretches, rounds, addresses that were not acknowledged.

Evidence --> Chain: steps, parts, the cause
"""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby

from ..records.record_text import on_the_bus
from .chain import Chain, Part, Step, parts_of
from .cpu_activity import Stretch
from .device_evidence import answering, bytes_of_device, note_of_device, sender
from .evidence import Evidence, RecordedPhase, in_order
from .fault_evidence import (
    ONES,
    bytes_sent,
    is_master,
    missing_condition,
    own_address,
    refusing,
    released,
    stale,
    unread,
)

I2C = "I2C-A"
ASKS = ("I2CSTR.SDIR", "I2CSTR.XRDY", "I2CSTR.RRDY")  # flags that ask the firmware for something


def response(evidence: Evidence) -> Chain:
    """Explain a response, from the read address's ACK to the first data bit: who held SCL low."""
    begin, end = evidence.window.begin, evidence.window.end
    free = min(begin + evidence.low, end)
    own = [Stretch(begin, free, "bus", "SCL low by the controller", "", begin)]
    return evidence.chain(_answer(evidence, free), parts_of([*own, *_held(evidence, free, end)]))


def stretch(evidence: Evidence) -> Chain:
    """Explain a stretch, from the controller's release of SCL to its rise."""
    begin, end = evidence.window.begin, evidence.window.end
    if begin == end:
        prompt = evidence.say(begin, "SCL rises as soon as the controller releases it, everywhere in this phase")
        return evidence.chain(in_order(_asked(evidence, begin), [prompt]))
    return evidence.chain(_answer(evidence, begin), parts_of(_held(evidence, begin, end)))


def _held(evidence: Evidence, begin: int, end: int) -> list[Stretch]:
    """Return what the unit did while it held SCL, or the device that held it."""
    holder = evidence.holder_at(begin)
    if holder == evidence.unit:
        return evidence.timeline(begin, end)
    return [Stretch(begin, end, "bus", f"SCL held low by {holder}", "", begin)] if begin < end else []


def _answer(evidence: Evidence, free: int) -> tuple[Step, ...]:
    """Return the steps to a rise of SCL that waited for a slave's data; the controller held SCL up to `free`."""
    end = evidence.window.end
    asked = _asked(evidence, end)
    phase = evidence.phase_at(free)
    since = phase.begin if phase is not None else evidence.window.begin
    first = _first_needed(evidence, since, end)
    steps = [*asked, *_flags(evidence, since, end)]
    answer = [*evidence.accesses(since, end, "W", I2C, "I2CDXR"), *evidence.accesses(since, end, "R", I2C, "I2CDRR")]
    last = max(answer, key=lambda r: r.tick, default=None)
    if last is not None:
        access = "I2CDXR written" if last.what.startswith("W") else "I2CDRR read"
        early = f"{evidence.span(free - last.tick)} before SCL is released"
        steps.append(evidence.step(last, f"{access}, {early if last.tick <= free else 'for which SCL was held'}"))
    episodes = [one for one in evidence.episodes(first, end) if one.doing != "wait"]
    over = end if last is None else last.tick
    waits = [one for one in evidence.episodes(first, end) if one.doing == "wait" and one.meets(over - 1, over)]
    steps += [evidence.episode_step(one, end) for one in (*episodes, *waits)]
    if end > free:
        holder = evidence.holder_at(free)
        steps.append(evidence.say(free, f"the controller releases SCL; {holder} holds it low", end - free))
        steps.append(evidence.say(end, "SCL rises" if evidence.scl_moves(end) else "SCL is still low: the run ends"))
    else:
        steps.append(evidence.say(end, "SCL rises as soon as the controller releases it"))
    return in_order(steps)


def _holder(evidence: Evidence, tick: int) -> str:
    """Return the party that holds SCL low, and for a unit its activity."""
    holder = evidence.holder_at(tick)
    return f"{holder}: {evidence.doing_at(tick)}" if holder == evidence.unit else holder


def _asked(evidence: Evidence, tick: int) -> list[Step]:
    """Return steps of the controller's request at a tick, and the bytes up to then."""
    phase = evidence.phase_at(tick)
    if phase is None:
        return []
    start = "repeated START" if phase.repeated else "START"
    steps = [evidence.say(phase.begin, f"{start}, {phase}")]
    if phase.answered is not None:
        steps.append(evidence.say(phase.answered, f"address {'' if phase.acked else 'not '}acknowledged"))
    return steps + [
        evidence.step(byte, f"byte {n}: {on_the_bus(byte)}")
        for n, byte in enumerate(phase.data, 1)
        if byte.tick <= tick
    ]


def _first_needed(evidence: Evidence, since: int, end: int) -> int:
    """Return the tick from which firmware determines the answer: the last flag that requested it, or `since`."""
    flags = [r.tick for r in evidence.flags(since, end, I2C, *ASKS) if r.value]
    return max(flags, default=since)


def _flags(evidence: Evidence, since: int, end: int) -> list[Step]:
    """Return steps of flags that request data, and of the firmware's reads of them."""
    steps = []
    for flag in evidence.flags(since, end, I2C, *ASKS):
        if not flag.value:
            continue
        saw = evidence.saw(flag)
        steps.append(evidence.step(flag))
        if saw is not None and saw.tick <= end:
            steps.append(
                evidence.step(saw, f"the firmware sees {flag.what}, {evidence.span(saw.tick - flag.tick)} later")
            )
    return steps


def a_round(evidence: Evidence, due: int, end: int) -> Chain:
    """Explain a round, from its due time to its last STOP: its transfers, gaps and stretches of SCL."""
    inside = [phase for phase in evidence.phases if due <= phase.begin < end]
    steps: list[Step] = [evidence.say(due, "the round is due")]
    parts: list[Stretch] = []
    at = due
    for phase in inside:
        if phase.begin > at:
            gap = "START held up" if at == due else "bus free between two transfers"
            parts.append(Stretch(at, phase.begin, "bus", gap, "", at))
        parts += _phase_parts(evidence, phase, min(phase.end, end))
        at = min(phase.end, end)
        steps += [
            evidence.say(let_go, f"SCL held low by {_holder(evidence, let_go)}", rise - let_go)
            for let_go, rise in evidence.stretches(phase.begin, at)
        ]
    for (acked, name), alike in groupby(inside, key=lambda phase: (phase.acked, str(phase))):
        phases = list(alike)
        if acked:
            steps += [evidence.say(phase.begin, str(phase), min(phase.end, end) - phase.begin) for phase in phases]
        else:
            times = f", {len(phases)} times" if len(phases) > 1 else ""
            text = f"{name}, not acknowledged{times}"
            steps.append(evidence.say(phases[0].begin, text, min(phases[-1].end, end) - phases[0].begin))
    if at < end:
        parts.append(Stretch(at, end, "bus", "no transfer of this round", "", at))
    steps += [
        evidence.episode_step(one, end) for one in evidence.episodes(due, end) if one.doing in ("interrupt", "span")
    ]
    return evidence.chain(in_order(steps, [evidence.say(end, "last STOP")]), parts_of(parts))


def _phase_parts(evidence: Evidence, phase: RecordedPhase, end: int) -> list[Stretch]:
    """Divide a phase into the times of its bits, and those for which the unit or a device held SCL low."""
    parts: list[Stretch] = []
    at = phase.begin
    for let_go, rise in evidence.stretches(phase.begin, end):
        parts.append(Stretch(at, let_go, "bus", f"bits of {phase.name or phase}", "", phase.begin))
        parts += _held(evidence, let_go, rise)
        at = rise
    parts.append(Stretch(at, end, "bus", f"bits of {phase.name or phase}", "", phase.begin))
    return parts


def round_time(evidence: Evidence) -> Chain:
    return a_round(evidence, evidence.window.begin, evidence.window.end)


def slack(evidence: Evidence) -> Chain:
    """Explain the slack of a period after a round by the round itself."""
    over = evidence.window.begin if _positive(evidence) else evidence.window.end
    due = over + _length(evidence) - evidence.period
    story = a_round(evidence, due, over)
    return replace(
        story, steps=in_order(story.steps, [evidence.say(due + evidence.period, "the next round is due")]), parts=()
    )


def _positive(evidence: Evidence) -> bool:
    return (evidence.window.verdict.worst or 0) >= 0


def _length(evidence: Evidence) -> int:
    window = evidence.window
    return (window.end - window.begin) * (1 if _positive(evidence) else -1)


def missed(evidence: Evidence) -> Chain:
    """Explain a missed round: the one before still ran, or it lacks a request, as the START at this instant shows."""
    due = evidence.window.begin
    before = max(due - evidence.period, evidence.window.kept[0].begin)
    shows = next((phase for phase in evidence.phases if phase.begin == due), None)
    if shows is not None:
        round_so_far = [phase for phase in evidence.phases if before <= phase.begin < due]
        made = (evidence.say(phase.begin, str(phase), phase.end - phase.begin) for phase in round_so_far)
        return evidence.chain((*made, evidence.say(due, f"{shows} begins, and the request before it was not made")))
    running = a_round(evidence, before, due)
    steps = [
        evidence.say(due, f"a round is due, but the one before still runs: {evidence.unit} in {evidence.doing_at(due)}")
    ]
    round_steps = [step for step in running.steps if step.what not in ("last STOP", "the round is due")]
    old = [step for phase in evidence.phases if before <= phase.begin < due for step in stale(evidence, phase)][-1:]
    return evidence.chain(
        in_order(round_steps, old, evidence.waited_for(due), unread(evidence, due), steps), (), evidence.blame_at(due)
    )


def nacked(evidence: Evidence) -> Chain:
    """Explain an unacknowledged address: the module's address then, since when, and the firmware's activity."""
    begin = evidence.window.begin
    phase = next((p for p in evidence.phases if p.begin >= begin and not p.acked and p.answered is not None), None)
    if phase is None:
        return evidence.chain((evidence.say(begin, "no such address within the records kept"),))
    return _unanswered(evidence, phase)


def nack(evidence: Evidence) -> Chain:
    """Explain a NACK of an address or of a byte by the write, or the missing write, that caused it."""
    at = evidence.window.begin
    phase = evidence.phase_at(at)
    if phase is not None and phase.answered == at:
        return _unanswered(evidence, phase)
    to_blame = [] if is_master(evidence, at) else refusing(evidence, at)
    steps = [*_asked(evidence, at), *to_blame, *unread(evidence, at)]
    steps.append(evidence.say(at, f"{evidence.unit}: {evidence.doing_at(at)}", None, evidence.place_at(at)))
    return evidence.chain(in_order(steps), (), _blamed(to_blame) or evidence.blame_at(at))


def _unanswered(evidence: Evidence, phase: RecordedPhase) -> Chain:
    at = phase.begin if phase.answered is None else phase.answered
    steps = [
        evidence.say(phase.begin, f"START, {phase}"),
        evidence.say(at, f"address 0x{phase.address:02X} not acknowledged"),
    ]
    steps.append(evidence.say(at, f"{evidence.unit}: {evidence.doing_at(at)}", None, evidence.place_at(at)))
    if is_master(evidence, at):
        return evidence.chain(in_order(steps), (), evidence.blame_at(at))
    lacks = missing_condition(evidence, at)
    own, wrong = own_address(evidence, at, phase.address)
    steps += [*lacks, *own, *unread(evidence, at), *stale(evidence, phase)]
    return evidence.chain(in_order(steps), (), evidence.blame_at(at) or _blamed(lacks or ([wrong] if wrong else [])))


def _blamed(steps: list[Step]) -> Part | None:
    """Return the first step with a place as the cause."""
    step = next((step for step in steps if step.place is not None), None)
    return None if step is None else Part("code", step.what.partition(",")[0], 0, 1, step.place)


def wrong_bytes(evidence: Evidence) -> Chain:
    """Explain the first wrong read: for each byte the write of I2CDXR it came from, possibly for another read.

    For a read of a device: the bytes it sent, and the duty that it noted as broken.
    """
    begin = evidence.window.begin
    phase = next((p for p in evidence.phases if p.begin >= begin), None)
    if phase is None:
        return evidence.chain((evidence.say(begin, "no such read within the records kept"),))
    if sender(evidence, phase):
        noted, cause = note_of_device(evidence, phase)
        address = _asked(evidence, begin if phase.answered is None else phase.answered)
        return evidence.chain(in_order(noted, address, bytes_of_device(evidence, phase)), (), cause)
    evidence = answering(evidence, phase)
    steps = [*_asked(evidence, begin), *stale(evidence, phase)]
    blamed: Step | None = None
    for byte, write, said in bytes_sent(evidence, phase):
        steps.append(evidence.say(byte.tick, said, None, None if write is None else evidence.step(write).place))
        wrote = [] if write is None else [evidence.step(write, f"I2CDXR = 0x{write.value:02X} written")]
        if write is not None and write.tick < phase.begin:
            wrote = [evidence.step(write, f"I2CDXR = 0x{write.value:02X} written, before the read's START")]
            blamed = blamed or wrote[0]
        reset = released(evidence, byte.tick) if byte.value >> 1 == ONES else []
        blamed = blamed or next(iter(reset), None)
        steps += [*wrote, *reset]
    steps += unread(evidence, phase.end)
    written = next((step for step in steps if step.what.startswith("I2CDXR = ")), None)
    blamed = blamed or written
    if blamed is None:
        return evidence.chain(in_order(steps), (), evidence.blame_at(begin))
    what = "I2CMDR.IRS cleared" if blamed.what.startswith("I2CMDR") else "I2CDXR written"
    return evidence.chain(in_order(steps), (), Part("code", what, 0, 1, blamed.place))


def stuck(evidence: Evidence) -> Chain:
    """Explain a line held low for too long: since when, by whom, and what the firmware waits for."""
    at = evidence.window.begin
    steps = []
    for name in ("SCL", "SDA"):
        channel = next((c for c in evidence.window.edges.channels if c.name == name), None)
        if channel is None:
            continue
        falls = channel.edges[(channel.edges <= at)].tolist()
        if falls and not channel.initial ^ (len(falls) & 1):
            steps.append(evidence.say(falls[-1], f"{name} falls, and stays low", at - falls[-1]))
    steps += [*evidence.waited_for(at), *unread(evidence, at)]
    steps.append(
        evidence.say(at, f"reported as stuck; {evidence.unit}: {evidence.doing_at(at)}", None, evidence.place_at(at))
    )
    return evidence.chain(in_order(_asked(evidence, at)[:1], steps), (), evidence.blame_at(at))
