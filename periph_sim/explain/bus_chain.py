"""Why a measure of the bus came out as it did: answers, stretches, rounds, addresses that nobody acknowledged.

Evidence --> ChainBuilder: steps, parts, what is to blame
"""

from __future__ import annotations

from typing import NamedTuple

from ..records.record_text import on_the_bus
from .chain import Part, Step, parts_of
from .cpu_activity import Stretch
from .evidence import Evidence, Phase, in_order
from .fault_evidence import ONES, bytes_sent, deaf, is_master, own_address, refusing, released, stale, unread

I2C = "I2C-A"
ASKS = ("I2CSTR.SDIR", "I2CSTR.XRDY", "I2CSTR.RRDY")  # flags that ask the firmware for something


class ChainBuilder(NamedTuple):
    """What an explanation is made of. parts: none where nothing has a length."""

    steps: tuple[Step, ...]
    parts: tuple[Part, ...] = ()
    blame: Part | None = None


def response(look: Evidence) -> ChainBuilder:
    """From the read address's ACK to the first data bit: the controller's low time, then whoever holds SCL longer."""
    begin, end = look.window.begin, look.window.end
    free = min(begin + look.low, end)
    own = [Stretch(begin, free, "bus", "SCL low by the controller", "", begin)]
    return ChainBuilder(_answer(look, free), parts_of([*own, *look.timeline(free, end)]))


def stretch(look: Evidence) -> ChainBuilder:
    """From where the controller lets go of SCL to where it rises."""
    begin, end = look.window.begin, look.window.end
    if begin == end:
        prompt = look.say(begin, "SCL rises as soon as the controller lets go of it, everywhere in this phase")
        return ChainBuilder(in_order(_asked(look, begin), [prompt]))
    return ChainBuilder(_answer(look, begin), parts_of(look.timeline(begin, end)))


def _answer(look: Evidence, free: int) -> tuple[Step, ...]:
    """Up to a rise of SCL that a slave's data had to come for; SCL is the controller's up to `free`."""
    end = look.window.end
    asked = _asked(look, end)
    phase = look.phase_at(free)
    since = phase.begin if phase is not None else look.window.begin
    first = _first_needed(look, since, end)
    steps = [*asked, *_flags(look, since, end)]
    answer = [*look.accesses(since, end, "W", I2C, "I2CDXR"), *look.accesses(since, end, "R", I2C, "I2CDRR")]
    last = max(answer, key=lambda r: r.tick, default=None)
    if last is not None:
        access = "I2CDXR written" if last.what.startswith("W") else "I2CDRR read"
        early = f"{look.span(free - last.tick)} before SCL is let go"
        steps.append(look.step(last, f"{access}, {early if last.tick <= free else 'for which SCL was held'}"))
    told = [one for one in look.episodes(first, end) if one.doing != "wait"]
    over = end if last is None else last.tick
    waits = [one for one in look.episodes(first, end) if one.doing == "wait" and one.meets(over - 1, over)]
    steps += [look.told(one, end) for one in (*told, *waits)]
    if end > free:
        steps.append(look.say(free, f"the controller lets go of SCL; {look.unit} holds it low", end - free))
        steps.append(look.say(end, "SCL rises"))
    else:
        steps.append(look.say(end, "SCL rises as soon as the controller lets go of it"))
    return in_order(steps)


def _asked(look: Evidence, tick: int) -> list[Step]:
    """What the controller asks for at a tick, and the bytes up to then."""
    phase = look.phase_at(tick)
    if phase is None:
        return []
    start = "repeated START" if phase.repeated else "START"
    told = [look.say(phase.begin, f"{start}, {phase}")]
    if phase.answered is not None:
        told.append(look.say(phase.answered, f"address {'' if phase.acked else 'not '}acknowledged"))
    return told + [
        look.step(byte, f"byte {n}: {on_the_bus(byte)}") for n, byte in enumerate(phase.data, 1) if byte.tick <= tick
    ]


def _first_needed(look: Evidence, since: int, end: int) -> int:
    """From when on the firmware's doings tell on the answer: the last flag that asked for it, or the phase."""
    flags = [r.tick for r in look.flags(since, end, I2C, *ASKS) if r.value]
    return max(flags, default=since)


def _flags(look: Evidence, since: int, end: int) -> list[Step]:
    """Flags that ask for data, and when the firmware saw them."""
    steps = []
    for flag in look.flags(since, end, I2C, *ASKS):
        if not flag.value:
            continue
        saw = look.saw(flag)
        steps.append(look.step(flag))
        if saw is not None and saw.tick <= end:
            steps.append(look.step(saw, f"the firmware sees {flag.what}, {look.span(saw.tick - flag.tick)} later"))
    return steps


def a_round(look: Evidence, due: int, end: int) -> ChainBuilder:
    """From when a round was due to its last STOP: its transfers, what lies between, and where SCL was stretched."""
    inside = [phase for phase in look.phases if due <= phase.begin < end]
    steps: list[Step] = [look.say(due, "the round is due")]
    parts: list[Stretch] = []
    at = due
    for phase in inside:
        if phase.begin > at:
            gap = "START held up" if at == due else "bus free between two transfers"
            parts.append(Stretch(at, phase.begin, "bus", gap, "", at))
        parts += _phase_parts(look, phase, min(phase.end, end))
        at = min(phase.end, end)
        steps.append(look.say(phase.begin, _phase_told(phase), at - phase.begin))
        steps += [
            look.say(let_go, f"SCL held low by {look.unit}: {look.doing_at(let_go)}", rise - let_go)
            for let_go, rise in look.stretches(phase.begin, at)
        ]
    if at < end:
        parts.append(Stretch(at, end, "bus", "no transfer of this round", "", at))
    steps += [look.told(one, end) for one in look.episodes(due, end) if one.doing in ("interrupt", "span")]
    return ChainBuilder(in_order(steps, [look.say(end, "last STOP")]), parts_of(parts))


def _phase_told(phase: Phase) -> str:
    return str(phase) if phase.acked else f"{phase}, not acknowledged"


def _phase_parts(look: Evidence, phase: Phase, end: int) -> list[Stretch]:
    """The time of a phase: the bus's own, and what the firmware did while it held SCL."""
    parts: list[Stretch] = []
    at = phase.begin
    for let_go, rise in look.stretches(phase.begin, end):
        parts.append(Stretch(at, let_go, "bus", f"bits of {phase.name}", "", phase.begin))
        parts += look.timeline(let_go, rise)
        at = rise
    parts.append(Stretch(at, end, "bus", f"bits of {phase.name}", "", phase.begin))
    return parts


def round_time(look: Evidence) -> ChainBuilder:
    return a_round(look, look.window.begin, look.window.end)


def slack(look: Evidence) -> ChainBuilder:
    """What is left of a period behind a round: the round itself is what took the rest."""
    over = look.window.begin if _positive(look) else look.window.end
    due = over + _length(look) - look.period
    story = a_round(look, due, over)
    return story._replace(steps=in_order(story.steps, [look.say(due + look.period, "the next round is due")]), parts=())


def _positive(look: Evidence) -> bool:
    return (look.window.verdict.worst or 0) >= 0


def _length(look: Evidence) -> int:
    window = look.window
    return (window.end - window.begin) * (1 if _positive(look) else -1)


def missed(look: Evidence) -> ChainBuilder:
    """A round was due, and the one before still ran."""
    due = look.window.begin
    before = max(due - look.period, look.window.kept[0].begin)
    running = a_round(look, before, due)
    steps = [look.say(due, f"a round is due, but the one before still runs: {look.unit} in {look.doing_at(due)}")]
    told = [step for step in running.steps if step.what not in ("last STOP", "the round is due")]
    old = [step for phase in look.phases if before <= phase.begin < due for step in stale(look, phase)][-1:]
    return ChainBuilder(in_order(told, old, look.waited_for(due), unread(look, due), steps), (), look.blame_at(due))


def nacked(look: Evidence) -> ChainBuilder:
    """An address that nobody acknowledged: which address the module had then, since when, and what the firmware did."""
    begin = look.window.begin
    phase = next((p for p in look.phases if p.begin >= begin and not p.acked and p.answered is not None), None)
    if phase is None:
        return ChainBuilder((look.say(begin, "no such address within the records kept"),))
    return _unanswered(look, phase)


def nack(look: Evidence) -> ChainBuilder:
    """A NACK of an address or of a byte: the write, or the missing one, that made the module refuse it."""
    at = look.window.begin
    phase = look.phase_at(at)
    if phase is not None and phase.answered == at:
        return _unanswered(look, phase)
    to_blame = [] if is_master(look, at) else refusing(look, at)
    steps = [*_asked(look, at), *to_blame, *unread(look, at)]
    steps.append(look.say(at, f"{look.unit}: {look.doing_at(at)}", None, look.place_at(at)))
    return ChainBuilder(in_order(steps), (), _blamed(to_blame) or look.blame_at(at))


def _unanswered(look: Evidence, phase: Phase) -> ChainBuilder:
    at = phase.begin if phase.answered is None else phase.answered
    steps = [look.say(phase.begin, f"START, {phase}"), look.say(at, f"address 0x{phase.address:02X} not acknowledged")]
    steps.append(look.say(at, f"{look.unit}: {look.doing_at(at)}", None, look.place_at(at)))
    if is_master(look, at):
        return ChainBuilder(in_order(steps), (), look.blame_at(at))
    lacks = deaf(look, at)
    own, wrong = own_address(look, at, phase.address)
    steps += [*lacks, *own, *unread(look, at), *stale(look, phase)]
    return ChainBuilder(in_order(steps), (), look.blame_at(at) or _blamed(lacks or ([wrong] if wrong else [])))


def _blamed(steps: list[Step]) -> Part | None:
    """The first of the steps that has a place, as what is to blame."""
    step = next((step for step in steps if step.place is not None), None)
    return None if step is None else Part("code", step.what.partition(",")[0], 0, 1, step.place)


def wrong_bytes(look: Evidence) -> ChainBuilder:
    """The first wrong read: of each byte which write of I2CDXR it came of, when and where, maybe for another read."""
    begin = look.window.begin
    phase = next((p for p in look.phases if p.begin >= begin), None)
    if phase is None:
        return ChainBuilder((look.say(begin, "no such read within the records kept"),))
    steps = [*_asked(look, begin), *stale(look, phase)]
    blamed: Step | None = None
    for byte, write, said in bytes_sent(look, phase):
        steps.append(look.say(byte.tick, said, None, None if write is None else look.step(write).place))
        wrote = [] if write is None else [look.step(write, f"I2CDXR = 0x{write.value:02X} written")]
        if write is not None and write.tick < phase.begin:
            wrote = [look.step(write, f"I2CDXR = 0x{write.value:02X} written, before the read's START")]
            blamed = blamed or wrote[0]
        reset = released(look, byte.tick) if byte.value >> 1 == ONES else []
        blamed = blamed or next(iter(reset), None)
        steps += [*wrote, *reset]
    steps += unread(look, phase.end)
    written = next((step for step in steps if step.what.startswith("I2CDXR = ")), None)
    blamed = blamed or written
    if blamed is None:
        return ChainBuilder(in_order(steps), (), look.blame_at(begin))
    what = "I2CMDR.IRS cleared" if blamed.what.startswith("I2CMDR") else "I2CDXR written"
    return ChainBuilder(in_order(steps), (), Part("code", what, 0, 1, blamed.place))


def stuck(look: Evidence) -> ChainBuilder:
    """A line held low for too long: since when, by whom, and what the firmware waits for."""
    at = look.window.begin
    steps = []
    for name in ("SCL", "SDA"):
        channel = next((c for c in look.window.edges.channels if c.name == name), None)
        if channel is None:
            continue
        falls = channel.edges[(channel.edges <= at)].tolist()
        if falls and not channel.initial ^ (len(falls) & 1):
            steps.append(look.say(falls[-1], f"{name} falls, and stays low", at - falls[-1]))
    steps += [*look.waited_for(at), *unread(look, at)]
    steps.append(look.say(at, f"reported as stuck; {look.unit}: {look.doing_at(at)}", None, look.place_at(at)))
    return ChainBuilder(in_order(_asked(look, at)[:1], steps), (), look.blame_at(at))
