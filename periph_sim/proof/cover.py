"""Coverage of a list of phases: long runs, and short runs around each failure.

    phases 0, 1, ... 511 --one run, a new phase in each round--> it holds: all 512 phases are covered
                           '--it fails--> shorter runs find the round in which it begins to fail;
                                          runs with one phase alone find the end of the window

Within a window, only every APART-th of the given phases is run. The first and the last phase of the window, and the
neighbours outside, are always run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from itertools import groupby
from pathlib import Path

from msgspec import Struct

from ..timing.verdict import Verdict
from .stretch import CoveredCase, Job, Outcome

APART = 16  # within a window, every APART-th of the given phases is run
REPORTED = 3  # a failure is assumed to begin at one of the last REPORTED phases of the shortest run that fails


class Worst(Struct, frozen=True):
    """The value of a budget that is nearest to its limit, as a verdict.

    phases: the phases of the run that had this value, in order.
    seed: the seed of this run.
    """

    verdict: Verdict
    phases: tuple[int, ...]
    seed: int


class Drifting(Struct, frozen=True):
    """Failures of a run whose phase increases from `first` to `last`.

    Each of the last REPORTED phases of this run was also run alone, and did not fail.

    names: the names of what failed.
    """

    names: frozenset[str]
    first: int
    last: int


class Covered(Struct):
    """The results of the runs of some phases.

    held: the phases at which nothing failed, either in a run of several phases or in a run with this phase alone.
    failed: for each phase that was run alone, the names of what failed in the run; an empty set if nothing failed.
    drifting: failures that occur only in runs whose phase increases, in the order of the phases.
    worst: for the name of each budget, its worst value.
    judged: for the name of each budget, the number of runs that judged it.
    reasons: for the name of each failure that is no broken budget, a sentence about it.
    runs: number of runs.
    """

    held: list[int]
    failed: dict[int, frozenset[str]]
    drifting: list[Drifting]
    worst: dict[str, Worst]
    judged: dict[str, int]
    reasons: dict[str, str]
    runs: int = 0

    def add(self, other: Covered) -> None:
        """Add the results of other phases, which must come after the phases of this object."""
        self.held += other.held
        self.failed |= other.failed
        self.drifting += other.drifting
        for worst in other.worst.values():
            self.judge(worst)
        for name, count in other.judged.items():
            self.judged[name] = self.judged.get(name, 0) + count
        self.reasons = other.reasons | self.reasons
        self.runs += other.runs

    def judge(self, new: Worst) -> None:
        """Store a new value of a budget in place of the stored one if the new value is worse.

        A value that breaks its limit is worse than one that does not. Otherwise, a smaller margin to the limit is
        worse. If the margins are equal, the value of the run with fewer phases is worse.
        """
        old = self.worst.get(new.verdict.name)
        if old is None or (rank(new.verdict), len(new.phases)) < (rank(old.verdict), len(old.phases)):
            self.worst[new.verdict.name] = new


def rank(verdict: Verdict) -> tuple[bool, bool, float]:
    """Return a key by which verdicts are sorted, the worst one first.

    A broken verdict is worse than one that is not broken. If both or neither are broken, the verdict with the smaller
    margin to its limit is worse, and a verdict with a margin is worse than a verdict without a margin.
    """
    return not verdict.broken, verdict.margin is None, verdict.margin or 0


def nothing() -> Covered:
    return Covered([], {}, [], {}, {}, {})


class Coverer:
    """Runs a case at given phases, and collects the results.

    seed: the seed of all random values of the runs.
    found: the results so far. They include the results that were passed to the constructor, if any.
    """

    def __init__(self, case: CoveredCase, seed: int, found: Covered | None = None) -> None:
        self._case = case
        self._seed = seed
        self.found = nothing() if found is None else found

    def cover(self, phases: Sequence[int]) -> Covered:
        """Run all these phases, which are in ascending order, and return the results."""
        if self._case.phases.is_one_a_run:
            self.found.held += [phase for phase in phases if not self.status(phase)]
            return self.found
        while phases and self._run(phases).failures:
            phases = phases[self._failing(phases) :]
        self.found.held += phases
        return self.found

    def _failing(self, phases: Sequence[int]) -> int:
        """Find the first failure in a run with these phases, and return how many of the phases are then covered.

        phases: the phases of a run that has failed.

        Bisection finds the smallest number of first phases with which a run fails. If one of the last REPORTED of them
        fails alone, a window begins there, and the end of the window is searched. Otherwise, the failure is added to
        `Covered.drifting`.
        """
        length = _first_true(lambda count: bool(self._run(phases[:count]).failures), 1, len(phases))
        suspects = range(max(0, length - REPORTED), length)
        begin = next((place for place in suspects if self.status(phases[place])), None)
        if begin is None:
            self.found.held += phases[: length - 1]
            outcome = self._run(phases[:length])
            self._count(outcome, phases[:length])
            self.found.drifting.append(Drifting(outcome.failures, phases[0], phases[length - 1]))
            return length
        self.found.held += phases[:begin]
        broken = begin
        while broken + APART < len(phases) and self.status(phases[broken + APART]):
            broken += APART
        limit = min(broken + APART, len(phases))
        return _first_true(lambda place: place == limit or not self.status(phases[place]), broken + 1, limit)

    def repeat(self, phase: int) -> None:
        """Run a phase alone, to find worst values that need no run of several phases.

        If a budget reaches its worst value in this run, too, this run is stored with the value instead of a run of
        several phases.
        """
        self._run([phase])

    def status(self, phase: int) -> frozenset[str]:
        """Return the names of what fails in a run with this phase alone. This run is made once; its result is kept."""
        if phase not in self.found.failed:
            self.found.failed[phase] = self._run([phase]).failures
        return self.found.failed[phase]

    def _run(self, phases: Sequence[int]) -> Outcome:
        """Make one run with these phases, and add the values of the budgets to the results.

        The values of a failing run of several phases are not added, because a failure affects the later phases, too.
        """
        outcome = self._case.run(phases, self._seed)
        self.found.runs += 1
        if len(phases) == 1 or not outcome.failures:
            self._count(outcome, phases)
        self.found.reasons = dict(outcome.reasons) | self.found.reasons
        return outcome

    def _count(self, outcome: Outcome, phases: Sequence[int]) -> None:
        for verdict in outcome.verdicts:
            self.found.judge(Worst(verdict, tuple(phases), self._seed))
            is_judged = verdict.passed or verdict.broken
            self.found.judged[verdict.name] = self.found.judged.get(verdict.name, 0) + is_judged


def _first_true(is_true: Callable[[int], bool], low: int, high: int) -> int:
    """Return the least number from `low` to `high` for which `is_true` is true, by bisection.

    `is_true` must be true for all numbers above the returned one. It is not called for `high`, where it is assumed to
    be true.
    """
    while low < high:
        middle = (low + high) // 2
        if is_true(middle):
            high = middle
        else:
            low = middle + 1
    return low


class Window(Struct, frozen=True):
    """A range of phases at which a budget is broken, or the run fails in another way.

    name: the name of the budget or of the failure.
    first, last: the first and the last phase. `first` is above `last` if the window contains the end of the period.
    run: number of phases within the window that were run alone and failed in this way.
    is_closed: True if the phase before `first` and the phase after `last` were both run alone, and neither failed in
        this way.
    """

    name: str
    first: int
    last: int
    run: int
    is_closed: bool


def windows_of(found: Covered, status: Callable[[int], frozenset[str]], bounds: tuple[int, int]) -> list[Window]:
    """Return the windows of all failures, in the order of the phases.

    found: the results of all phases.
    status: the method `Coverer.status`, which adds more results to `found.failed`.
    bounds: the first and the last phase that may be run.
    """
    windows: list[Window] = []
    for name in sorted(set[str]().union(*found.failed.values())):
        for group in _groups(name, found):
            windows.append(_window(name, group, found, status, bounds))
    return sorted(_merged(windows), key=_place)


def _place(window: Window) -> tuple[int, int, str]:
    return window.first, window.last, window.name


def _merged(windows: Iterable[Window]) -> list[Window]:
    """Return the windows after joining those that have the same name and overlap.

    Windows overlap if a phase held in a run of several phases, but fails alone. The failing phases before and after
    this phase are two separate groups at first. When each group is extended to a window, both windows contain this
    phase.
    """
    found: list[Window] = []
    for one in sorted(windows, key=lambda each: (each.name, each.first, each.last)):
        last = found[-1] if found else None
        if last is not None and last.name == one.name and one.first <= last.last:
            end = max(last, one, key=lambda each: each.last)
            closed = last.is_closed and end.is_closed
            found[-1] = Window(one.name, last.first, end.last, max(last.run, one.run), closed)
        else:
            found.append(one)
    return found


def joined_at_end(windows: Sequence[Window], count: int, status: Callable[[int], frozenset[str]]) -> list[Window]:
    """Return the windows of a whole period, joined across its end, because phase 0 follows the last phase.

    A window at the end of the period and a window of the same name at its beginning become one window. If a name has
    only one of these two windows, the phase at the other end of the period is run alone, to set `is_closed`.

    count: the number of phases of the period.
    status: the method `Coverer.status`.
    """
    at_end = [one for one in windows if (one.first == 0) != (one.last == count - 1)]
    found = [one for one in windows if one not in at_end]
    for name in sorted({one.name for one in at_end}):
        parts = sorted((one for one in at_end if one.name == name), key=lambda one: one.first, reverse=True)
        first, last = parts[0].first, parts[-1].last
        closed = name not in status((first - 1) % count) | status((last + 1) % count)
        found.append(Window(name, first, last, sum(one.run for one in parts), closed))
    return sorted(found, key=_place)


def _groups(name: str, found: Covered) -> Iterable[list[int]]:
    """Yield lists of phases at which `name` fails. Two lists are separated by phases at which it does not fail."""
    failing = {phase for phase, failures in found.failed.items() if name in failures}
    for fails, group in groupby(sorted({*found.held, *found.failed}), failing.__contains__):
        if fails:
            yield list(group)


def _window(
    name: str, group: list[int], found: Covered, status: Callable[[int], frozenset[str]], bounds: tuple[int, int]
) -> Window:
    def fails(phase: int) -> bool:
        return name in status(phase)

    known = sorted({*found.held, *found.failed})
    before = max((phase for phase in known if phase < group[0]), default=bounds[0] - 1)
    after = min((phase for phase in known if phase > group[-1]), default=bounds[1] + 1)
    first = _first_true(fails, before + 1, group[0])
    last = _first_true(lambda phase: not fails(phase), group[-1] + 1, after) - 1
    first, last = _extended(fails, first, -1, bounds[0]), _extended(fails, last, 1, bounds[1])
    run = sum(1 for phase, failures in found.failed.items() if first <= phase <= last and name in failures)
    closed = all(bounds[0] <= end <= bounds[1] and not fails(end) for end in (first - 1, last + 1))
    return Window(name, first, last, run, closed)


def _extended(fails: Callable[[int], bool], phase: int, step: int, end: int) -> int:
    """Return the last failing phase of a window in one direction, given the last one that is known, `phase`.

    The phase after `phase` may have held only in a run of several phases. If it fails alone, the window continues.
    Further phases are then run alone, in growing steps, until the next phase holds or `end` is reached.

    step: the direction: 1 for increasing phases, -1 for decreasing phases.
    end: the last phase that may be run in this direction.
    """
    width = 1
    while phase != end and fails(phase + step):
        near, limit = phase + step, min(width, abs(end - phase) - 1)
        beyond = _first_true(lambda count: count > limit or not fails(near + step * count), 1, limit + 1)  # noqa: B023
        phase, width = near + step * (beyond - 1), width * 2
    return phase


@lru_cache(maxsize=1)
def case_of(job: Job, folder: Path) -> CoveredCase:
    """Return the case of a job. The last case is kept, because a worker process runs many parts of one job.

    folder: the current folder, to which a relative path in `job` refers. It is only a part of the key of the cache.
    """
    return CoveredCase(job)


def cover_part(job: Job, phases: Sequence[int], seed: int) -> Covered:
    """Run these phases, which are in ascending order, and return the results. Worker processes call it."""
    return Coverer(case_of(job, Path.cwd()), seed).cover(phases)
