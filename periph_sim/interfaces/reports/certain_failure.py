"""The instant at which a failure becomes certain, at the first and the last phase of a window.

    runs with one phase alone, near an end of the window --> the accesses and interrupts of their firmware, in order

    the failing run at the end   R1   W2  IRQ   R3   R4 ...
    runs that begin like this    16   16    9    4    4
    those of them that fail       8    8    5    4    4       the failure is certain from R3 on

At most NEAREST failing runs and NEAREST runs that held are compared, those whose phases are nearest to the end. What
is certain is so among these runs only. Times are not compared, nor are the values of registers that yield data or a
count of time (`Yields`). Reads of a register that follow each other, yield the same and have no effect are compared as
one read, because the number of passes of a waiting loop depends on the phase.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from typing import NamedTuple

from ...core.records import Kind, Record
from ...core.registers import Yields
from ...proof.cover import Window
from ...records.record_text import happened_where
from ...records.register_maps import reads_take, register_of
from .coverage import Coverage
from .questions.first_difference import Event

KINDS = (Kind.ACCESS, Kind.IRQ)
NEAREST = 8
MOST_ENDS = 16  # maximum number of ends of windows that are examined, because each takes up to 2 * NEAREST runs

# What is compared of a record: its `what`, such as "R I2C-A.I2CSTR", its `value`, and its `field`. The value is None
# for registers whose values are not compared.
Content = tuple[str, int | None, str]


class Step(NamedTuple):
    """An access, or an entry into or exit from a service routine. content: what is compared."""

    content: Content
    record: Record


Steps = Mapping[str, Sequence[Step]]  # the steps of each unit, in order


class Share(NamedTuple):
    """From `at_s` on, `runs` of the compared runs have begun like the failing run; `failing` of them fail."""

    at_s: float
    failing: int
    runs: int


class CertainFailure(NamedTuple):
    """The event from which on all compared runs fail that have begun in the same way.

    name: the name of what fails.
    phase: the first or the last phase of its window.
    event: the event in the run with this phase. None if it does not occur before the failure: until then, all events
        of this run are also those of a run that held.
    held: the phase of a run that held and was equal up to this event; the nearest one if there are several.
    instead: the event of that run in the place of `event`, or its first further event; None if it has none.
    shares: the shares of the compared runs that fail, as the failing run proceeds.
    """

    name: str
    phase: int
    event: Event | None
    held: int
    instead: Event | None
    shares: tuple[Share, ...]


def certain_failures(coverage: Coverage) -> list[CertainFailure]:
    """Return the event that makes the failure certain, for the first and the last phase of each window.

    A window is a range of phases that fail in the same way. Phases that `_ends` does not yield are left out, and so are
    all phases after the first MOST_ENDS.
    """
    runs = _Runs(coverage)
    ends = [(window.name, phase) for window in coverage.windows for phase in _ends(window, coverage)]
    return [_certain(name, phase, runs) for name, phase in ends[:MOST_ENDS]]


def _ends(window: Window, coverage: Coverage) -> Iterator[int]:
    """Yield the first and the last phase of a window, each only if its neighbour outside was run alone and held."""
    count = coverage.case.phases.count
    for phase, beside in ((window.first, window.first - 1), (window.last, window.last + 1)):
        beside = beside % count if coverage.is_whole else beside
        if window.name not in coverage.found.failed.get(beside, {window.name}):
            yield phase


class _Runs:
    """Runs with one phase alone, and their steps. Each run is made once."""

    def __init__(self, coverage: Coverage) -> None:
        self._coverage = coverage
        self._steps: dict[int, Steps] = {}

    def near(self, name: str, phase: int) -> tuple[dict[int, Steps], set[int]]:
        """Return the steps of the runs to compare, by phase, and the phases of those that fail with `name`."""
        failed = self._coverage.found.failed
        nearest = sorted(failed, key=lambda other: (abs(other - phase), other))
        failing = [other for other in nearest if name in failed[other]][:NEAREST]
        held = [other for other in nearest if name not in failed[other]][:NEAREST]
        return {other: self._of(other) for other in failing + held}, set(failing)

    def _of(self, phase: int) -> Steps:
        if phase not in self._steps:
            records: list[Record] = []
            case = self._coverage.case
            case.run([phase], case.case.seed, lambda recorder, _: recorder.subscribe(KINDS, records.append))
            self._steps[phase] = steps_of(records)
        return self._steps[phase]

    def fails_before(self, name: str, phase: int, step: Step) -> bool:
        """Return True if a run with this phase that ends before a step of it fails with `name`."""
        case = self._coverage.case
        return name in case.run([phase], case.case.seed, before=step.record.tick).failures

    def event(self, step: Step) -> Event:
        return Event(*self._coverage.case.time(step.record.tick), happened_where(step.record))


def steps_of(records: Sequence[Record]) -> Steps:
    """Return the steps of each unit from the records of its accesses and interrupts."""
    found: dict[str, list[Step]] = {}
    for record in records:
        content = (record.what, record.value if _is_compared(record.what) else None, record.field)
        steps = found.setdefault(record.where, [])
        way, _, name = record.what.partition(" ")
        is_again = bool(steps) and steps[-1].content == content and way == "R" and not reads_take(name)
        if not is_again:
            steps.append(Step(content, record))
    return found


@cache
def _is_compared(what: str) -> bool:
    """Return True if the values of an access are compared: if its register yields neither data nor a count of time.

    what: the access, such as "R I2C-A.I2CSTR".
    """
    module, _, name = what.partition(" ")[2].partition(".")
    register = register_of(module, name)
    return register is None or register.yields is Yields.STATE


def alike_after(runs: Mapping[int, Steps], phase: int) -> Iterator[tuple[str, int, set[int]]]:
    """Yield each step of the run with this phase, as unit and index, in the order of time.

    With each step, yield the phases of the runs that have begun like this run, up to and including this step.
    """
    own, alike = runs[phase], set(runs)
    order = ((step.record.number, unit, index) for unit, steps in own.items() for index, step in enumerate(steps))
    for _, unit, index in sorted(order):
        content = own[unit][index].content
        alike = {one for one in alike if (step := _step(runs[one], unit, index)) and step.content == content}
        yield unit, index, alike


def _step(steps: Steps, unit: str, index: int) -> Step | None:
    there = steps.get(unit, ())
    return there[index] if index < len(there) else None


def _certain(name: str, phase: int, runs: _Runs) -> CertainFailure:
    near, fails = runs.near(name, phase)
    alike, shares = set(near), [Share(0.0, len(fails), len(near))]
    for unit, index, left in alike_after(near, phase):
        if len(left) == len(alike):
            continue
        step = near[phase][unit][index]
        shares.append(Share(runs.event(step).at_s, len(left & fails), len(left)))
        if left <= fails:
            held = _nearest(alike - fails, phase)
            if runs.fails_before(name, phase, step):
                return CertainFailure(name, phase, None, held, None, tuple(shares[:-1]))
            there = _step(near[held], unit, index)
            instead = None if there is None else runs.event(there)
            return CertainFailure(name, phase, runs.event(step), held, instead, tuple(shares))
        alike = left
    held = _nearest(alike - fails, phase)
    further = [_step(near[held], unit, len(near[phase].get(unit, ()))) for unit in near[held]]
    first = min(filter(None, further), key=lambda step: step.record.number, default=None)
    return CertainFailure(name, phase, None, held, None if first is None else runs.event(first), tuple(shares))


def _nearest(phases: Iterable[int], phase: int) -> int:
    return min(phases, key=lambda other: (abs(other - phase), other))
