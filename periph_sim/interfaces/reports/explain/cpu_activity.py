"""Activities of a CPU from its records: the time is divided into stretches by the innermost activity.

    SPAN, IRQ, WAIT start and end --> a stack --> Stretch, Stretch, ...     model |SCIRXINTA| model | wait for AAS

The top of the stack is the activity at an instant: for example a service routine within a span, or a wait within the
routine. If the stack is empty, the firmware executes other code.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from ....core.records import Kind, Record
from ....records.record_text import GAVE_UP, IN_FIRMWARE, has_timed_out
from .window import Window

Doing = Literal["interrupt", "span", "wait", "code", "bus", "hardware", "unknown"]
CODE: Doing = "code"
UNKNOWN: Doing = "unknown"
NOT_KEPT = "the middle, for which no records were kept"
DOING: dict[Kind, Doing] = {Kind.IRQ: "interrupt", Kind.SPAN: "span", Kind.WAIT: "wait"}


@dataclass(frozen=True)
class Stretch:
    """A time from tick `begin` to tick `end` with one activity.

    The activity is a service routine, a span, a wait, other code, traffic on the bus, or the work of hardware. A
    Stretch is either a whole activity, or a part of an activity during which no nested activity is in progress.

    doing, what: the kind and the name of the activity. The name of a wait that timed out ends with GAVE_UP.
    end: the end of the window if the activity has not ended.
    where: the place in the firmware; "" if unknown.
    since: the tick at which the activity began, which is `begin` or an earlier tick.
    within: for a whole activity, the records at which its enclosing activities began, outermost first.
    """

    begin: int
    end: int
    doing: Doing
    what: str
    where: str
    since: int
    within: tuple[Record, ...] = ()

    @property
    def length(self) -> int:
        return self.end - self.begin

    def __str__(self) -> str:
        return phrase(self.doing, self.what)


def phrase(doing: Doing, what: str) -> str:
    """Format an activity as a phrase."""
    if doing == "wait" and what in ("IDLE", "endless loop"):
        return what
    if doing == "wait":
        return f"wait for {polled(what)}"
    return {"span": f"span {what}", "code": what or "other code", "unknown": NOT_KEPT}.get(doing, what)


def polled(what: str) -> str:
    """Format the fields that a wait polls. A change of any of these fields ends the wait.

    "I2C-A.I2CSTR.XRDY and I2C-A.I2CSTR.SCD" becomes "I2C-A.I2CSTR.XRDY or SCD".
    """
    first, *others = what.split(" and ")
    register = first.rpartition(".")[0]
    return " or ".join([first, *(other.removeprefix(f"{register}.") for other in others)])


def timeline(window: Window, unit: str, begin: int, end: int, kinds: Collection[Kind] = tuple(DOING)) -> list[Stretch]:
    """Return the activities of a unit's CPU between two ticks of the window, without gaps.

    The middle of a long occurrence, for which no records were kept, has the activity UNKNOWN.

    kinds: the kinds of records that begin an activity. The remaining time is other code.
    """
    moves = [r for r in _up_to(window, unit, end) if r.tick < end and r.kind in kinds]
    stack: list[Record] = []
    found: list[Stretch] = []
    at = min([begin, *(r.tick for r in moves)])
    hole, bottom = window.hole, CODE
    for record in moves:
        if hole is not None and record.tick >= hole.end:
            found.append(_top(stack, at, hole.begin, CODE))
            stack, at, hole, bottom = [], hole.begin, None, UNKNOWN
        found.append(_top(stack, at, record.tick, bottom))
        if record.value and record.kind is not Kind.IRQ and not stack:
            # The record begins a span or wait that no other activity encloses. When this span or wait has ended, the
            # firmware executes other code.
            bottom = CODE
        at = max(at, record.tick)
        _move(stack, record)
    found.append(_top(stack, at, end, bottom))
    return [replace(one, begin=max(one.begin, begin)) for one in found if one.end > max(one.begin, begin)]


def units(window: Window) -> list[str]:
    """Return the names of the units with firmware activity in or before the window, sorted."""
    return sorted({r.where for r in window.all_records if r.kind in IN_FIRMWARE})


def _up_to(window: Window, unit: str, end: int) -> list[Record]:
    """Return the records of a unit's activities. Names of waits that timed out up to tick `end` end with GAVE_UP."""
    open_before = [r for r in window.before if r.value]
    found = [r for r in (*open_before, *window.records) if r.where == unit and r.kind in DOING]
    begins: dict[str, int] = {}  # maps the name of a wait to the index of its last start
    for index, record in enumerate(found):
        if record.kind is Kind.WAIT and record.value:
            begins[record.what] = index
        elif has_timed_out(record) and record.tick <= end and record.what in begins:
            for place in (begins[record.what], index):
                found[place] = found[place]._replace(what=f"{record.what} {GAVE_UP}")
    return found


def _move(stack: list[Record], record: Record) -> list[Record]:
    """Begin or end an activity on the stack. Return the activities that have ended.

    These are the activity that the record ends and all activities above it on the stack.
    """
    if record.value:
        stack.append(record)
        return []
    alike = (place for place, one in enumerate(stack) if one.kind is record.kind and one.what == record.what)
    place = max(alike, default=len(stack))
    ended = stack[place:]
    del stack[place:]
    return ended


def _top(stack: Sequence[Record], begin: int, end: int, bottom: Doing) -> Stretch:
    if not stack:
        return Stretch(begin, end, bottom, "", "", begin)
    top = stack[-1]
    return Stretch(begin, end, DOING[top.kind], top.what, top.text, top.tick)


def all_episodes(window: Window, unit: str, begin: int, end: int) -> list[Stretch]:
    """Return the service routines, spans and waits of a unit that overlap the time between two ticks.

    They are in the order in which they begin, outer ones before inner ones. `Stretch.within` of each contains the
    activities around it. If one record ends several nested activities, `within` of all of them contains only the
    activities around the outermost one. For example, the service routine of an image and the function that implements
    it end together.
    """
    stack: list[Record] = []
    over: list[tuple[Record, Sequence[Record], int]] = []
    for record in _up_to(window, unit, end):
        over += [(ended, tuple(stack), record.tick) for ended in _move(stack, record)]
    over += [(one, stack[:place], window.kept[-1].end) for place, one in enumerate(stack)]
    found = [Stretch(r.tick, to, DOING[r.kind], r.what, r.text, r.tick, tuple(within)) for r, within, to in over]
    there = (one for one in found if one.begin < end and one.end > begin)
    return sorted(there, key=lambda one: (one.begin, len(one.within)))


def episodes(window: Window, unit: str, begin: int, end: int) -> list[Stretch]:
    """Return the service routines, spans and waits that an explanation names, in the order in which they begin.

    Of the spans in progress at the first tick, only the innermost is returned, because each function of an image is a
    span, including `main`. A span that begins with a service routine at the same place is left out.
    """
    met = all_episodes(window, unit, begin, end)
    under_way = [one for one in met if one.doing == "span" and one.begin < begin]
    around = {id(one) for one in under_way[:-1]}
    routines = {(one.begin, one.where) for one in met if one.doing == "interrupt"}
    return [
        one for one in met if id(one) not in around and not (one.doing == "span" and (one.begin, one.where) in routines)
    ]
