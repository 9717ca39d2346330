"""The first difference between two runs of a case: the first edge, access, flag or interrupt that is not in both.

Both runs are repeated side by side, a slice at a time. Until they differ, their records are equal, so only the records
of the present slice are kept. From the first records that are not equal, the n-th record with the same `kind`,
`where` and `what` is compared with the n-th such record of the other run. So an event that comes later is described as
later, and not as missing.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

from ....core.records import Kind, Record
from ....processor.user_code import output_muted
from ....records.record_text import happened_where
from ....scene.prepared import PreparedScene
from ....scene.scene import Scene
from .. import REFUSED
from ..baselines.event_chain import numbered
from .covered_rows import CoveredResult
from .dependence import Dependence
from .explore import Attempt

KINDS = (Kind.EDGE, Kind.ACCESS, Kind.FLAG, Kind.IRQ)
MOST_EXPLAINED = 20  # maximum number of runs whose first difference is searched
# Length of a slice in seconds. An event counts as missing if the other run has it neither in the same slice nor in the
# next slice.
SLICE = Fraction(1, 1000)
# The kind, where and what of a record, and its number, from 0, among the records with equal kind, where and what.
Occurrence = tuple[tuple[Kind, str, str], int]


class Event(NamedTuple):
    """An event of a run. at: its time from the start of the run, as text. at_s: the same in seconds."""

    at_s: float
    at: str
    text: str


class FirstDifference(NamedTuple):
    """An event that differs between two runs.

    base: the event in the run with fewer other answers, such as the case as it is; None if it does not occur there.
    other: the event in the run that has one more other answer; None if it does not occur there.
    """

    base: Event | None
    other: Event | None


class _RecordedRun:
    """A run that is made a slice at a time.

    scene: the scene of the run; None if it cannot be built. The run then has no records.
    records: the records after the last slice in which the records of both runs were equal.
    """

    def __init__(self, prepared: PreparedScene, changes: Sequence[str]) -> None:
        self.records: list[Record] = []
        self.scene: Scene | None = None
        with suppress(*REFUSED):
            self.scene = prepared.scene(changes, lambda recorder, _: recorder.subscribe(KINDS, self.records.append))
        self._ended = False

    def advance(self, seconds: Fraction) -> None:
        """Run up to a time from the start. A run whose firmware fails goes no further."""
        if self.scene is not None and not self._ended:
            try:
                self.scene.advance(self.scene.start + self.scene.timebase.ticks(seconds, "nearest"))
            except REFUSED:
                self._ended = True

    def occurrences(self, first: int) -> dict[Occurrence, tuple[int, str]]:
        """Return the tick and the text of each record from index `first` on."""
        return numbered(((r.kind, r.where, r.what), (r.tick, happened_where(r))) for r in self.records[first:])


def first_differences(
    file: Path, changes: Sequence[str], length: Fraction, attempts: Sequence[Attempt], found: Sequence[Dependence]
) -> dict[int, FirstDifference | None]:
    """Return the first difference of each run in which the verdict of a budget differs, at most MOST_EXPLAINED.

    A run with one other answer is compared with the case as it is. A run with two other answers is compared with the
    run that has only the first of them. If the row is a CoveredResult, both runs have the same starts: those of the run
    in which a budget has its worst value. This budget is the first one whose verdict differs.

    length: the duration of a run of the case as it is, in seconds.

    The keys of the result are the numbers of the runs, as in `Departure`. The value is None for a run without a
    difference.
    """
    first = {each.number: one.name for one in reversed(found) for each in reversed(one.departures)}
    prepared = PreparedScene(file, changes)
    differences: dict[int, FirstDifference | None] = {}
    for number in sorted(first)[:MOST_EXPLAINED]:
        attempt = attempts[number]
        runs = attempt.row.runs if isinstance(attempt.row, CoveredResult) else {}
        starts, seconds = runs.get(first[number], ((), length))
        answers = [*starts, *(answer.change for answer in attempt.answers)]
        differences[number] = first_difference(prepared, answers[:-1], answers, seconds)
    return differences


@output_muted()
def first_difference(
    prepared: PreparedScene, before: Sequence[str], answers: Sequence[str], length: Fraction
) -> FirstDifference | None:
    """Run a case with two lists of "key=value" texts up to the first difference; None if there is none.

    A run whose scene cannot be built has no events.

    length: the duration of the runs in seconds.
    """
    runs = base, other = _RecordedRun(prepared, before), _RecordedRun(prepared, answers)
    done = Fraction(0)
    while done < length:
        done = min(done + SLICE, length)
        for run in runs:
            run.advance(done)
        pairs = zip(base.records, other.records, strict=False)
        shorter = min(len(base.records), len(other.records))
        first = next((n for n, (one, two) in enumerate(pairs) if _content(one) != _content(two)), shorter)
        if first < max(len(base.records), len(other.records)):
            for run in runs:
                run.advance(min(done + SLICE, length))
            return _earliest(base, other, first)
        for run in runs:
            run.records.clear()
    return None


def _content(record: Record) -> tuple[object, ...]:
    return record.tick, record.kind, record.where, record.what, record.value, record.text


def _earliest(base: _RecordedRun, other: _RecordedRun, first: int) -> FirstDifference | None:
    """Return the earliest event that differs. The records are compared from index `first` on."""
    scene = other.scene if base.scene is None else base.scene
    assert scene is not None  # otherwise, there is no record that differs
    start, timebase = scene.start, scene.timebase
    one, two = base.occurrences(first), other.occurrences(first)
    apart = [key for key in {**one, **two} if one.get(key) != two.get(key)]
    if not apart:
        return None

    def at(key: Occurrence) -> int:
        return min(found[key][0] for found in (one, two) if key in found)

    def event(found: tuple[int, str] | None) -> Event | None:
        if found is None:
            return None
        tick, text = found
        return Event(float(timebase.seconds(tick - start)), timebase.show(tick - start), text)

    key = min(apart, key=at)
    return FirstDifference(event(one.get(key)), event(two.get(key)))
