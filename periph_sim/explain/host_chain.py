"""Why a measure of the host's frames came out as it did: age and values of data, words in the FIFO, characters lost.

Evidence --> ChainBuilder
"""

from __future__ import annotations

from ..core.records import Kind
from ..records.record_text import bus_byte
from .bus_chain import ChainBuilder
from .chain import Step, parts_of
from .evidence import SMALL, Evidence, in_order

SCI = "SCI-A"
FIFO = ("SCIFFRX.RXFFINT", "SCIFFRX.RXFFOVF", "SCIRXST.OE")  # flags that tell the firmware to read, or that it is late
WORDS = "SCIFFRX.RXFFST"


def age(look: Evidence) -> ChainBuilder:
    """From the end of a host frame to the read that carries it: into the FIFO, a model, onto the bus."""
    begin, end = look.window.begin, look.window.end
    steps = [look.say(begin, "the host's frame is over"), *_flags(look, begin, end)[:1]]
    busy = [one for one in look.episodes(begin, end) if one.doing in ("interrupt", "span")]
    routines = [one for one in busy if one.doing == "interrupt"]
    busy = [one for one in busy if one not in routines[1:] or (one.end or end) - one.begin > (end - begin) * SMALL]
    steps += [look.told(one, end) for one in busy]
    read = next((p for p in look.phases if p.begin == end), None)
    steps.append(look.say(end, f"START, {read}" if read is not None else "the read that carries it begins"))
    return ChainBuilder(in_order(steps, _rounds(look, begin, end)), parts_of(look.timeline(begin, end)))


def value(look: Evidence) -> ChainBuilder:
    """What a read carried: what the firmware took in and worked on in the round before, and the bytes of the read."""
    at = look.window.begin
    busy = [one for one in look.episodes(look.window.kept[0].begin, at) if one.doing in ("interrupt", "span")]
    steps = [look.told(one, at) for one in busy]
    read = next((p for p in look.phases if p.begin == at), None)
    if read is not None:
        carried = " ".join(f"0x{data.value:02X}" for byte in read.data if (data := bus_byte(byte)))
        steps.append(look.say(at, f"{read}: {carried}", read.end - at))
    return ChainBuilder(in_order(steps), (), look.blame_at(at))


def _rounds(look: Evidence, begin: int, end: int) -> list[Step]:
    """Reads of the same chip in between, which carried older data."""
    carrier = next((p for p in look.phases if p.begin == end), None)
    if carrier is None:
        return []
    older = [p for p in look.phases if p.begin < end and p.end > begin and p.read and p.address == carrier.address]
    return [look.say(p.begin, f"{p}, with older data", p.end - p.begin) for p in older]


def fifo(look: Evidence) -> ChainBuilder:
    """How so many words came together: since when the firmware did not read, and what it did instead."""
    at = look.window.begin
    reads = look.accesses(0, at, "R", SCI, "SCIRXBUF")
    empty = [r.tick for r in look.flags(look.window.kept[0].begin, at, SCI, WORDS) if not r.value]
    since = max([*empty, look.window.kept[0].begin])
    frames = [r for r in look.window.between(since, at, Kind.FRAME) if r.what == "byte"]
    steps: list[Step] = []
    if reads:
        last = max(reads, key=lambda r: r.tick)
        steps.append(look.step(last, f"SCIRXBUF read for the last time, {look.span(at - last.tick)} before"))
    if frames:
        told = f"the host begins its first character of {len(frames)}"
        steps.append(look.say(frames[0].tick, told, at - frames[0].tick))
        since = frames[0].tick
    steps += _flags(look, since, at)
    words = look.flags(at, at, SCI, WORDS)
    steps.append(look.say(at, f"{words[-1].value} words in the FIFO" if words else "it happens"))
    steps.append(look.say(at, f"{look.unit}: {look.doing_at(at)}", None, look.place_at(at)))
    later = look.accesses(at, look.window.kept[-1].end, "R", SCI, "SCIRXBUF")
    if later:
        steps.append(look.step(later[0], f"SCIRXBUF read, {look.span(later[0].tick - at)} later"))
    busy = [one for one in look.episodes(since, at) if one.doing in ("interrupt", "span")]
    return ChainBuilder(in_order(steps, [look.told(one, at) for one in busy]), (), look.blame_at(at))


def _flags(look: Evidence, begin: int, end: int) -> list[Step]:
    return [look.step(flag) for flag in look.flags(begin, end, SCI, *FIFO) if flag.value]
