"""Explanations of measures of the host's frames: age and values of data, words in the FIFO, characters lost.

Evidence --> Chain
"""

from __future__ import annotations

from ..core.records import Kind
from ..records.record_text import bus_byte
from .chain import Chain, Step, parts_of
from .evidence import SMALL, Evidence, in_order

SCI = "SCI-A"
FIFO = ("SCIFFRX.RXFFINT", "SCIFFRX.RXFFOVF", "SCIRXST.OE")  # flags that request a read, or show that it is late
WORDS = "SCIFFRX.RXFFST"


def age(evidence: Evidence) -> Chain:
    """Explain the age of data, from the end of a host frame to its read: into the FIFO, a model, onto the bus."""
    begin, end = evidence.window.begin, evidence.window.end
    steps = [evidence.say(begin, "the host's frame is over"), *_flags(evidence, begin, end)[:1]]
    busy = [one for one in evidence.episodes(begin, end) if one.doing in ("interrupt", "span")]
    routines = [one for one in busy if one.doing == "interrupt"]
    busy = [one for one in busy if one not in routines[1:] or (one.end or end) - one.begin > (end - begin) * SMALL]
    steps += [evidence.episode_step(one, end) for one in busy]
    read = next((p for p in evidence.phases if p.begin == end), None)
    steps.append(evidence.say(end, f"START, {read}" if read is not None else "the read that carries it begins"))
    return evidence.chain(in_order(steps, _rounds(evidence, begin, end)), parts_of(evidence.timeline(begin, end)))


def value(evidence: Evidence) -> Chain:
    """Explain a read's value by the firmware's activity in the round before, and the bytes of the read."""
    at = evidence.window.begin
    busy = [one for one in evidence.episodes(evidence.window.kept[0].begin, at) if one.doing in ("interrupt", "span")]
    steps = [evidence.episode_step(one, at) for one in busy]
    read = next((p for p in evidence.phases if p.begin == at), None)
    if read is not None:
        carried = " ".join(f"0x{data.value:02X}" for byte in read.data if (data := bus_byte(byte)))
        steps.append(evidence.say(at, f"{read}: {carried}", read.end - at))
    return evidence.chain(in_order(steps), (), evidence.blame_at(at))


def _rounds(evidence: Evidence, begin: int, end: int) -> list[Step]:
    """Return steps of reads of the same chip in between, with older data."""
    carrier = next((p for p in evidence.phases if p.begin == end), None)
    if carrier is None:
        return []
    older = [p for p in evidence.phases if p.begin < end and p.end > begin and p.read and p.address == carrier.address]
    return [evidence.say(p.begin, f"{p}, with older data", p.end - p.begin) for p in older]


def fifo(evidence: Evidence) -> Chain:
    """Explain the words in the FIFO: since when the firmware did not read, and its activity meanwhile."""
    at = evidence.window.begin
    reads = evidence.accesses(0, at, "R", SCI, "SCIRXBUF")
    empty = [r.tick for r in evidence.flags(evidence.window.kept[0].begin, at, SCI, WORDS) if not r.value]
    since = max([*empty, evidence.window.kept[0].begin])
    frames = [r for r in evidence.window.between(since, at, Kind.FRAME) if r.what == "byte"]
    steps: list[Step] = []
    if reads:
        last = max(reads, key=lambda r: r.tick)
        steps.append(evidence.step(last, f"SCIRXBUF read for the last time, {evidence.span(at - last.tick)} before"))
    if frames:
        text = f"the host begins its first character of {len(frames)}"
        steps.append(evidence.say(frames[0].tick, text, at - frames[0].tick))
        since = frames[0].tick
    steps += _flags(evidence, since, at)
    words = evidence.flags(at, at, SCI, WORDS)
    steps.append(evidence.say(at, f"{words[-1].value} words in the FIFO" if words else "it happens"))
    steps.append(evidence.say(at, f"{evidence.unit}: {evidence.doing_at(at)}", None, evidence.place_at(at)))
    later = evidence.accesses(at, evidence.window.kept[-1].end, "R", SCI, "SCIRXBUF")
    if later:
        steps.append(evidence.step(later[0], f"SCIRXBUF read, {evidence.span(later[0].tick - at)} later"))
    busy = [one for one in evidence.episodes(since, at) if one.doing in ("interrupt", "span")]
    return evidence.chain(in_order(steps, [evidence.episode_step(one, at) for one in busy]), (), evidence.blame_at(at))


def _flags(evidence: Evidence, begin: int, end: int) -> list[Step]:
    return [evidence.step(flag) for flag in evidence.flags(begin, end, SCI, *FIFO) if flag.value]
