"""The time of an occurrence by place: the bus, a party that holds SCL, a module, or the firmware of a unit.

both ends on the bus       bits of each transfer | SCL held low by a party | bus free
else, from the end back    module or line | the firmware, from the access that caused it to the begin

The firmware's part is divided by its activity (`cpu_activity`): spans, service routines, waits, other code.
"""

from __future__ import annotations

from ....core.records import Record
from ....records.record_text import happened
from .cpu_activity import Stretch
from .ends import Ends
from .evidence import IN_FIRMWARE, Evidence
from .fault_evidence import is_master


def places(evidence: Evidence, ends: Ends) -> list[Stretch]:
    """Return the stretches of an occurrence, which add up to its length."""
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
    """Return the first record of the firmware, or at or before the begin, among a record and its causes.

    None if the causes lead to neither.
    """
    for cause, link in evidence.walk(record):
        if not link.aside and (cause.kind in IN_FIRMWARE or cause.tick <= evidence.window.begin):
            return cause
    return None


def _of_bus(evidence: Evidence, begin: int, end: int) -> list[Stretch]:
    """Divide a time of the bus into bits of each transfer, holds of SCL, and the times between transfers."""
    found: list[Stretch] = []
    at = begin
    for phase in evidence.phases:
        since, until = max(phase.begin, at), min(phase.end, end)
        if until <= since:
            continue
        found += _free(evidence, at, since, "bus free between two transfers" if at > begin else "START held up")
        at = since
        for let_go, rise in evidence.stretches(since, until):
            found += _stretch(at, let_go, f"bits of {phase.name or phase}", phase.begin)
            found += _held(evidence, let_go, rise)
            at = rise
        found += _stretch(at, until, f"bits of {phase.name or phase}", phase.begin)
        at = until
    return [*found, *_free(evidence, at, end, "bus free")]


def _stretch(begin: int, end: int, what: str, since: int) -> list[Stretch]:
    return [Stretch(begin, end, "bus", what, "", since)] if begin < end else []


def _held(evidence: Evidence, begin: int, end: int) -> list[Stretch]:
    """Return the activity of the unit that holds SCL low, or the device that does."""
    holder = evidence.holder_at(end - 1)
    if holder in evidence.case.unit:
        return evidence.for_unit(holder).timeline(begin, end)
    return _stretch(begin, end, f"SCL held low by {holder}", begin)


def _free(evidence: Evidence, begin: int, end: int, what: str) -> list[Stretch]:
    """Return the time of a free bus: the activity of the unit that is its master, if one is."""
    if begin < end and is_master(evidence, end):
        return evidence.timeline(begin, end)
    return _stretch(begin, end, what, begin)
