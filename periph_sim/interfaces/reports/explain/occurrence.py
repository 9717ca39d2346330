"""The worst occurrence of a verdict: its ticks, and the event with which it ends."""

from __future__ import annotations

from ....core.records import Kind
from ....core.time import Timebase
from ....timing.budget_schema import REPLY
from ....timing.language.events import Event
from ....timing.language.language import measure_of
from ....timing.measures.expectations import WRONG
from ....timing.measures.registry import MEASURES
from ....timing.verdict import Verdict

LATE = ("missed", "stuck")  # events whose instant is the end of a wait that is too long


def occurrence(verdict: Verdict, timebase: Timebase, start: int) -> tuple[int, int]:
    """Return the first and the last tick of the worst occurrence of a verdict.

    verdict: a verdict whose `at_s` is not None.
    start: the tick at which the run began.
    """
    per_second = timebase.per_second
    at = start + round((verdict.at_s or 0) * per_second)
    length = round((verdict.worst or 0) * per_second / 1_000_000) if is_interval(verdict) else 0
    if verdict.until_s is not None:
        length = round(verdict.until_s * per_second) - (at - start)
    event = event_of(verdict)  # the instant of an age is the read at which the age ends
    of_data = event is not None and event.name == Kind.DATA.value
    begin, end = sorted((at - length, at) if of_data else (at, at + length))
    return begin, end


def is_interval(verdict: Verdict) -> bool:
    """Return True if the worst occurrence of a verdict has a length, which is its worst value."""
    return verdict.unit == "us" and not verdict.measure.startswith(("jitter of", "time in"))


def event_of(verdict: Verdict) -> Event | None:
    """Return the last event that the text of a verdict's measure names; None if MEASURES has no such measure."""
    sentence = MEASURES.get(verdict.measure.partition(" of ")[0])
    return None if sentence is None else measure_of(sentence.text.format(of="")).events[-1]


def is_late(verdict: Verdict) -> bool:
    """Return True if the instant of a verdict is the end of a wait that is too long."""
    event = event_of(verdict)
    return event is not None and event.how in LATE


def never_came(verdict: Verdict) -> bool:
    """Return True if a verdict is about a reply that did not come, and not about a wrong or late reply."""
    return verdict.measure.startswith(REPLY) and verdict.until_s is not None and WRONG not in verdict.found
