"""The events of a run in its baseline: chains of occurrences as "TICKS EVENT" lines, and digests of all events.

    case, wanted occurrences --> a short second run, recorded --> records around each --> chain
    chain of the baseline, chain of the run --> the event that moved most, and the first difference
    BUS, IRQ, SPAN and writes of registers --> "TICKS EVENT" lines --> BLAKE2b, one digest
    BUS records of addresses and bytes, with their ACKs --> BLAKE2b, one digest per PART bytes

Runs with the same digest of events have equal chains, so no second run is needed to find the chains. Each digest of
bytes covers all bytes up to its end, so the first digest that differs shows where two runs begin to differ.

Chains and the digest of events have no reads of registers, because it does not matter how often a flag is polled. They
have no values of accesses, because a worst case that moves to another round has other data.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from hashlib import blake2b
from typing import NamedTuple, TypeVar

from ....core.records import Kind, Record, Recorder
from ....core.time import Timebase
from ....processor.user_code import output_muted
from ....scene.case.model import Case
from ....scene.scene import Scene
from ..explain.chain import place_of

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")

LONGEST = 32  # maximum number of events of a chain
AROUND = Fraction(5, 1000)  # in seconds; a START is searched up to this time before an occurrence, a STOP after it
KINDS = (Kind.BUS, Kind.ACCESS, Kind.IRQ, Kind.SPAN)
# A dictionary from events to ticks. An event is given by its text and its number among the events with the same text.
Times = dict[tuple[str, int], int]
COARSE = ("START", "repeated START", "STOP")


@dataclass(frozen=True)
class Wanted:
    """An occurrence of a measure whose chain is needed.

    measure: the name of the measure.
    at: the instant of the occurrence in ticks from the start of the run.
    length: the duration of the occurrence in ticks; 0 if it is an instant.
    """

    measure: str
    at: int
    length: int


class EventLine(NamedTuple):
    """A chain of events.

    lines: a text "TICKS EVENT" for each event.
    places: the location of each event in the firmware; "" if it is unknown.
    """

    lines: list[str]
    places: list[str]


@output_muted()
def chains(case: Case, wanted: dict[str, Wanted]) -> dict[str, EventLine]:
    """Run the case again until AROUND after the last wanted occurrence. Return the chain of events of each occurrence.

    The result is a dictionary with the keys of `wanted`.
    """
    if not wanted:
        return {}
    kept: list[Record] = []

    def keep(record: Record) -> None:
        if _is_event(record):
            kept.append(record)

    scene = Scene(case, lambda recorder, _: recorder.subscribe(KINDS, keep))
    margin = scene.timebase.ticks(AROUND)
    ends = [one.at + one.length + margin for one in wanted.values()]
    longest = scene.timebase.ticks(case.duration, "nearest")
    scene.run(scene.timebase.seconds(min(max(ends), longest)))
    return {name: _chain(kept, scene.start + one.at, one, margin) for name, one in wanted.items()}


def _chain(kept: list[Record], at: int, wanted: Wanted, margin: int) -> EventLine:
    """Return the chain of an occurrence. kept: the records of the run in order of time. at: the occurrence's tick."""
    first = bisect_left(kept, at - max(wanted.length, margin), key=lambda r: r.tick)
    records = kept[first : bisect_right(kept, at + wanted.length + margin, key=lambda r: r.tick)]
    begin, end, coarse = at, at + wanted.length, False
    if wanted.measure == "response":
        starts = [r.tick for r in records if r.kind is Kind.BUS and r.what == "START" and at - margin <= r.tick <= at]
        begin = max(starts, default=at)
    elif wanted.measure in ("age", "model age"):  # an age ends at `at`, its read
        begin, end, coarse = at - wanted.length, at, True
    elif wanted.measure in ("fifo high-water", "overruns"):
        begin, end, coarse = at - margin, at, True
    elif wanted.measure == "round":
        coarse = True
    elif not wanted.measure.startswith("span:"):
        stops = [r.tick for r in records if r.kind is Kind.BUS and r.what == "STOP" and at <= r.tick <= at + margin]
        end = min(stops, default=at + margin)
    if coarse:
        records = [r for r in records if r.kind in (Kind.IRQ, Kind.SPAN) or r.what in COARSE]
    places = ["" if r.kind is Kind.BUS else str(place_of(r.text) or "") for r in records]
    found = [(r.tick, description(r), place) for r, place in zip(records, places, strict=True)]
    events = [event for event in found if begin <= event[0] <= end]
    if wanted.measure == "response":
        events = [*events[: LONGEST - 1], (end, "SCL rise of the first data bit", "")]
    shown = events[:LONGEST]
    return EventLine([f"{tick - begin} {event}" for tick, event, _ in shown], [place for _, _, place in shown])


def _is_event(record: Record) -> bool:
    return record.kind is not Kind.ACCESS or record.what.startswith("W ")


def description(record: Record) -> str:
    """Return an event as a phrase."""
    if record.kind is Kind.ACCESS:
        return f"{record.what.removeprefix('W ')} written by {record.where}"
    if record.kind is Kind.IRQ:
        return f"{record.what} {'entered' if record.value else 'left'} by {record.where}"
    if record.kind is Kind.SPAN:
        return f"{record.what} {'begun' if record.value else 'ended'} by {record.where}"
    return f"{record.what} {record.text} on the bus".replace("  ", " ")


def first_divergence(before: list[str], now: list[str], cycles: Callable[[int], str]) -> str:
    """Describe the difference between two chains as a phrase; "" if the chains are equal.

    The phrase names the event that moved most. If the first event that differs is another event, the phrase names it,
    too. The first event alone is not sufficient, because it may differ only by the duration of a poll. The n-th event
    with a text is compared with the n-th event with the same text. Therefore, an event that moved past another event is
    described as later, and not as missing.

    cycles: a function that formats ticks as cycles.
    """
    then_at, now_at = _times(before), _times(now)
    apart = _apart(then_at, now_at, 0)
    if not apart:
        return ""
    first = apart[0]
    moved = [key for key in apart if key in then_at and key in now_at]
    most = max(moved, key=lambda key: abs(now_at[key] - then_at[key]), default=first)
    differences = [_moved(key[0], then_at.get(key), now_at.get(key), cycles) for key in dict.fromkeys((most, first))]
    return "; first to differ: ".join(differences)


def first_moved(before: list[str], now: EventLine, cycles: Callable[[int], str], tolerance: Fraction | int) -> str:
    """Describe the first event that moved by more than `tolerance` ticks, with its location in the firmware.

    A new or missing event counts as moved. Return "" if no event moved.
    """
    then_at, now_at = _times(before), _times(now.lines)
    far = _apart(then_at, now_at, tolerance)
    if not far:
        return ""
    first = far[0]
    place = now.places[list(now_at).index(first)] if first in now_at else ""
    return f"{_moved(first[0], then_at.get(first), now_at.get(first), cycles)}{f' [{place}]' if place else ''}"


def _apart(then_at: Times, now_at: Times, tolerance: Fraction | int) -> list[tuple[str, int]]:
    """Return the events that are missing in one of the chains, or whose times differ by more than `tolerance` ticks.

    The order of the events is that of their ticks. If the two ticks of an event differ, the earlier tick counts.
    """
    apart = [
        key
        for key in {**then_at, **now_at}
        if key not in then_at or key not in now_at or abs(now_at[key] - then_at[key]) > tolerance
    ]
    return sorted(apart, key=lambda key: min(at[key] for at in (then_at, now_at) if key in at))


def _moved(event: str, then: int | None, now: int | None, cycles: Callable[[int], str]) -> str:
    if now is None:
        return f"{event} is missing, which was after {_length(cycles(then or 0))}"
    if then is None:
        return f"{event} after {_length(cycles(now))}, which is new"
    return f"{event} {_length(cycles(abs(now - then)))} {'later' if now > then else 'earlier'}"


def _times(chain: list[str]) -> Times:
    """Parse the lines of a chain."""
    return numbered((event, int(tick)) for tick, _, event in (line.partition(" ") for line in chain))


def numbered(events: Iterable[tuple[K, V]]) -> dict[tuple[K, int], V]:
    """Return the values of events. The key of an event is extended by its number, from 0, among events with this key.

    So the n-th event with a key can be compared with the n-th event with the same key of another run.
    """
    seen: Counter[K] = Counter()
    found = {}
    for key, value in events:
        found[key, seen[key]] = value
        seen[key] += 1
    return found


def _length(cycles: str) -> str:
    return f"{cycles} cycle" if cycles == "1" else f"{cycles} cycles"


PART = 64  # number of bus bytes after which a digest is stored


class EventDigests:
    """Calculator of the digests of a run: one of all events, and digests of the bytes on the I2C bus.

    begin: the start of the run in seconds, from which the times of events are counted.
    """

    def __init__(self, begin: Fraction) -> None:
        self._begin = begin
        self._events, self._bytes = blake2b(digest_size=16), blake2b(digest_size=4)
        self._count = 0  # number of bytes on the bus
        self._parts: list[str] = []

    def subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        """Subscribe to the events of a run whose scene is being built."""
        self._start = timebase.ticks(self._begin, "nearest")
        recorder.subscribe(KINDS, self._add)

    def _add(self, record: Record) -> None:
        if _is_event(record):
            self._events.update(f"{record.tick - self._start} {description(record)}\n".encode())
        if record.kind is Kind.BUS and record.what in ("address", "byte"):
            self._bytes.update(f"{record.what} {record.value}\n".encode())
            self._count += 1
            if self._count % PART == 0:
                self._parts.append(self._bytes.hexdigest())

    @property
    def events(self) -> str:
        """The digest, in hexadecimal, of all events and their times."""
        return self._events.hexdigest()

    @property
    def bus_bytes(self) -> list[str]:
        """The digests, in hexadecimal, of the bytes without their times: one after every PART bytes and at the end."""
        return [*self._parts, self._bytes.hexdigest()] if self._count % PART else [*self._parts]
