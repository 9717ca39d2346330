"""Causes of a wrong byte, a NACK or a hang: Steps with the write or read that caused it.

byte on the bus --> the write of I2CDXR it came from, possibly for another read; FF --> why SDA is not driven
NACK of an address --> the write of I2COAR, the IRS = 0, or the missing write; of a byte --> the NACKMOD = 1
wait ended in a transfer by a flag from before it --> the flag's rise
RSFULL --> I2CDRR that was not read
"""

from __future__ import annotations

from collections.abc import Iterator

from ....core.records import Kind, Record
from ....f28335.gpio.register_map import control_register
from ....f28335.i2c.descriptor import I2C_A
from ....records.record_text import bus_byte, happened
from .chain import Step
from .cpu_activity import phrase
from .evidence import Evidence, RecordedPhase, in_time

I2C = I2C_A.name
ONES = 0xFF  # read when no party drives SDA
LETS_GO = "the module releases SDA"
NEEDED = (  # fields that must be 1 for the module to answer, and the effect of 0
    ("SYS", f"PCLKCR0.{I2C_A.gate}", "the module has no clock"),
    (I2C, "I2CMDR.IRS", LETS_GO),
    *(
        ("GPIO", f"{control_register('MUX', pin)}.GPIO{pin}", f"the module is not connected to {wire}")
        for wire, pin in ((wire, I2C_A.pins[signal]) for wire, signal in I2C_A.wires.items())
    ),
)
WAITED = ("SCD", "RRDY", "NACK")  # flags that firmware waits for and that remain set until cleared


def bytes_sent(evidence: Evidence, phase: RecordedPhase) -> Iterator[tuple[Record, Record | None, str]]:
    """Yield each byte of a read with the write that it came from, if known, and a description."""
    writes = evidence.accesses(0, phase.end, "W", I2C, "I2CDXR")
    before = phase.begin if phase.answered is None else phase.answered
    for number, byte in enumerate(phase.data, 1):
        carried = bus_byte(byte)
        value = 0 if carried is None else carried.value
        begins, before = _first_rise(evidence, before, byte.tick), byte.tick
        write = next((w for w in reversed(writes) if w.tick < begins and w.value & 0xFF == value), None)
        said = f"byte {number}: {carried}"
        if write is None:
            yield byte, None, f"{said}, which was not written to I2CDXR within the records kept"
            continue
        early = f", written to I2CDXR {evidence.span(byte.tick - write.tick)} before its end"
        other = next((p for p in evidence.phases if p.begin <= write.tick <= p.end and p.begin < phase.begin), None)
        where = "" if write.tick >= phase.begin else f", for {other}" if other else ", before the read's START"
        yield byte, write, f"{said}{early}{where}"


def _first_rise(evidence: Evidence, after: int, before: int) -> int:
    """Return when SCL rises for the first bit of a byte, which must be driven by then."""
    scl = evidence.channel("SCL")
    if scl is None:
        return before
    rises = scl.edges[(scl.levels == 1) & (scl.edges > after) & (scl.edges < before)]
    return int(rises[0]) if len(rises) else before


def missing_condition(evidence: Evidence, tick: int) -> list[Step]:
    """Return a step of the first condition for receiving that the module lacks at a tick: cleared by a write, or
    never set."""
    unit = evidence.case.unit.get(evidence.unit)
    there = ("SYS", *(unit.modules if unit is not None else ()))
    for module, field, so in NEEDED:
        if module not in there:
            continue
        last = last_change(evidence, field, tick, module)
        if last is None:
            return [evidence.say(tick, f"{field} = 0, so {so}: the firmware has never set it")]
        if not last.value:
            return [_taken(evidence, last, so, tick)]
    return []


def _taken(evidence: Evidence, cleared: Record, so: str, tick: int) -> Step:
    by = maker(evidence, cleared)
    text = f"{cleared.what} cleared, so {so}, {evidence.span(tick - cleared.tick)} before"
    return evidence.step(cleared if by is None else by, text)


def own_address(evidence: Evidence, tick: int, address: int) -> tuple[list[Step], Step | None]:
    """Return writes of the own address around a tick at which another one was requested; and the cause, if any."""
    writes = evidence.accesses(0, evidence.window.kept[-1].end, "W", I2C, "I2COAR")
    last = max((r for r in writes if r.tick <= tick), key=lambda r: r.tick, default=None)
    right = min((r for r in writes if r.tick > tick and r.value == address), key=lambda r: r.tick, default=None)
    steps = []
    if last is None:
        steps.append(evidence.say(tick, "I2COAR = 0x00: the firmware has never written it"))
    else:
        before = evidence.span(tick - last.tick)
        steps.append(evidence.step(last, f"I2COAR = 0x{last.value:02X} written, {before} before the NACK"))
    if last is not None and last.value == address:
        return steps, None
    if right is not None:
        steps.append(
            evidence.step(right, f"I2COAR = 0x{address:02X} written, {evidence.span(right.tick - tick)} too late")
        )
    return steps, steps[-1]


def refusing(evidence: Evidence, tick: int) -> list[Step]:
    """Return a step of the write because of which a receiver does not acknowledge a byte at a tick."""
    last = last_change(evidence, "I2CMDR.NACKMOD", tick)
    if last is None or not last.value:
        return missing_condition(evidence, tick)
    by = maker(evidence, last)
    text = f"I2CMDR.NACKMOD set, so the module refuses the next byte, {evidence.span(tick - last.tick)} before"
    return [evidence.step(last if by is None else by, text)]


def is_master(evidence: Evidence, tick: int) -> bool:
    """True if the unit's module is the master at a tick, so that a NACK is another party's."""
    last = last_change(evidence, "I2CMDR.MST", tick)
    return last is not None and last.value == 1


def stale(evidence: Evidence, phase: RecordedPhase) -> list[Step]:
    """Return steps of reads, in a transfer, of a flag that rose before it and ended a wait at once."""
    steps = []
    for look_at in evidence.accesses(phase.begin, phase.end, "R", I2C, "I2CSTR"):
        if look_at.field not in WAITED:
            continue
        rose = last_change(evidence, f"I2CSTR.{look_at.field}", look_at.tick)
        first = next(
            (p.begin for p in reversed(evidence.phases) if p.begin <= phase.begin and p.start == "START"), phase.begin
        )
        if rose is not None and rose.value and rose.tick < first:
            early = evidence.span(first - rose.tick)
            text = f"the firmware sees I2CSTR.{look_at.field}, which rose {early} before this transfer began"
            steps.append(evidence.step(look_at, text))
    return steps[:1]


def unread(evidence: Evidence, tick: int) -> list[Step]:
    """Return steps of a receiver with an unread byte (RSFULL): since when, and when I2CDRR was read last."""
    full = last_change(evidence, "I2CSTR.RSFULL", tick)
    if full is None or not full.value:
        return []
    steps = [evidence.step(full, "I2CSTR.RSFULL set: a second byte is in, and I2CDRR is unread")]
    reads = evidence.accesses(0, tick, "R", I2C, "I2CDRR")
    if reads:
        last = max(reads, key=lambda r: r.tick)
        return [evidence.step(last, f"I2CDRR read for the last time, {evidence.span(tick - last.tick)} before"), *steps]
    waits = last_change(evidence, "I2CSTR.RRDY", tick)
    never = "I2CDRR was not read since" if waits is not None and waits.value else "I2CDRR was not read"
    return [*([evidence.step(waits, f"I2CSTR.RRDY set; {never}")] if waits is not None and waits.value else []), *steps]


def waited_for(evidence: Evidence, tick: int) -> list[Step]:
    """Return steps of a wait in progress at a tick: its place, and the last changes of the polled fields."""
    wait = next(iter(evidence.in_progress(tick)[-1:]), None)
    if wait is None or wait.kind is not Kind.WAIT:
        return []
    steps = [evidence.step(wait, f"{phrase('wait', wait.what)} begins, and goes on")]
    for field in wait.what.split(" and "):
        module, _, what = field.partition(".")
        last = last_change(evidence, what, tick, module)
        if last is not None:
            by = maker(evidence, last)
            steps.append(evidence.step(by or last, f"{happened(last)}{f' by {happened(by)}' if by else ''}"))
    return steps


def last_change(evidence: Evidence, field: str, tick: int, module: str = I2C) -> Record | None:
    """Return the last change of a field of one of the unit's modules up to a tick."""
    where = f"{evidence.unit}.{module}"
    there = (*evidence.window.before, *evidence.window.records)
    found = [r for r in there if r.kind is Kind.FLAG and (r.where, r.what) == (where, field) and r.tick <= tick]
    return max(found, key=in_time, default=None)


def maker(evidence: Evidence, change: Record) -> Record | None:
    """Return the access that made a change in its cycle."""
    there = (*evidence.window.before, *evidence.window.records)
    return next(
        (r for r in there if r.number == change.cause and r.kind is Kind.ACCESS and r.tick == change.tick), None
    )
