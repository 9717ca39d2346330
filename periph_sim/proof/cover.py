"""Coverage of a list of phases: long runs, and short runs around each failure.

    phases 0, 1, ... 511 --one run, a new phase in each period--> it holds: all 512 phases hold
                           '--it fails--> runs with fewer phases find the phase at which it begins to fail;
                                          runs with one phase alone find the end of the window

Within a window, only one of APART given phases is run. The first and the last phase of the window, and the neighbours
outside, are always run. The glossary in `periph_sim.proof` has the terms.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from itertools import groupby
from pathlib import Path

from msgspec import Struct

from ..timing.verdict import Verdict
from .stretch import CoveredCase, Job, Outcome

APART = 16  # within a window, one of APART given phases is run
REPORTED = 3  # the shortest run that fails is assumed to fail because of one of its last REPORTED phases


class Worst(Struct, frozen=True):
    """The worst value of a budget, and the run that had it.

    verdict: the verdict of the budget in this run.
    phases: the phases of this run, in order. seed: its seed.
    """

    verdict: Verdict
    phases: tuple[int, ...]
    seed: int


class Drifting(Struct, frozen=True):
    """A failure in a run whose phase increases from `first` to `last`, which no run with one phase alone repeats.

    Each of the last REPORTED phases of this run was also run alone, and held.

    names: the names of the broken budgets and other failures.
    """

    names: frozenset[str]
    first: int
    last: int


class Covered(Struct):
    """The results of the runs of some phases.

    held: the phases that held, in a run of several phases or in a run with this phase alone.
    failed: for each phase that was run alone, the names of its failures, such as {100: {"response"}, 101: set()}.
    drifting: the failures that only runs with increasing phases have, in the order of the phases.
    worst: the worst value of each budget, by its name.
    judged: the number of runs that judged each budget, by its name.
    reasons: a sentence about each failure that is no broken budget, by its name.
    runs: the number of runs.
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
        """Keep a value of a budget if it is worse than the value that was kept before (see `rank`).

        Of two equally bad values, that of the run with fewer phases is kept.
        """
        old = self.worst.get(new.verdict.name)
        if old is None or (rank(new.verdict), len(new.phases)) < (rank(old.verdict), len(old.phases)):
            self.worst[new.verdict.name] = new


def rank(verdict: Verdict) -> tuple[bool, bool, float]:
    """Return a key that sorts verdicts, the worst one first.

    First come broken verdicts, then the others; of each kind, the smaller the margin to the limit, the earlier, and
    verdicts without a margin are last.
    """
    return not verdict.broken, verdict.margin is None, verdict.margin or 0


def nothing() -> Covered:
    """Return empty results."""
    return Covered([], {}, [], {}, {}, {})


class Coverer:
    """Runs a case at given phases, and collects the results.

    seed: the seed of all random values of the runs.
    found: the results so far. The constructor can be given earlier results, to which others are added.
    """

    def __init__(self, case: CoveredCase, seed: int, found: Covered | None = None) -> None:
        self._case = case
        self._seed = seed
        self.found = nothing() if found is None else found

    def cover(self, phases: Sequence[int]) -> Covered:
        """Run these phases, given in ascending order, but only some of those in windows, and return the results."""
        if self._case.phases.is_one_a_run:
            self.found.held += [phase for phase in phases if not self.status(phase)]
            return self.found
        while phases and self._run(phases).failures:
            phases = phases[self._failing(phases) :]
        self.found.held += phases
        return self.found

    def _failing(self, phases: Sequence[int]) -> int:
        """Find the first failure among the phases of a run that has failed.

        Return the number of phases, from the first one on, whose results are then known.

        Bisection finds the least n for which a run of the first n phases fails. If one of the last REPORTED of these
        phases fails alone, a window begins there, and its end is searched. Otherwise, the failure is added to
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
        """Run a phase alone, to find its worst values in a run that is easier to examine.

        If a budget has its worst value in this run, too, `Covered.worst` then names this run instead of that of several
        phases.
        """
        self._run([phase])

    def status(self, phase: int) -> frozenset[str]:
        """Return the names of the failures of the run with this phase alone, which is made only once."""
        if phase not in self.found.failed:
            self.found.failed[phase] = self._run([phase]).failures
        return self.found.failed[phase]

    def _run(self, phases: Sequence[int]) -> Outcome:
        """Make one run with these phases, and add the values of the budgets to the results.

        If it has several phases and fails, its values are not added, because a failure affects the later phases, too.
        """
        outcome = self._case.run(phases, self._seed)
        self.found.runs += 1
        if len(phases) == 1 or not outcome.failures:
            self._count(outcome, phases)
        self.found.reasons = dict(outcome.reasons) | self.found.reasons
        return outcome

    def _count(self, outcome: Outcome, phases: Sequence[int]) -> None:
        """Add the values of a run with these phases to the results."""
        for verdict in outcome.verdicts:
            self.found.judge(Worst(verdict, tuple(phases), self._seed))
            is_judged = verdict.passed or verdict.broken
            self.found.judged[verdict.name] = self.found.judged.get(verdict.name, 0) + is_judged


def _first_true(is_true: Callable[[int], bool], low: int, high: int) -> int:
    """Return the least number from `low` to `high` for which `is_true` returns True, by bisection.

    `is_true` must return True from this number on. It is not called with `high`, for which True is assumed.
    """
    while low < high:
        middle = (low + high) // 2
        if is_true(middle):
            high = middle
        else:
            low = middle + 1
    return low


class Window(Struct, frozen=True):
    """A range of phases at which runs fail in the same way.

    name: the name of the broken budget or of another failure.
    first, last: the first and the last phase. If `first` is above `last`, the window continues from the last phase of
        the period to phase 0.
    run: the number of phases in the window that were run alone and failed in this way.
    is_closed: True if the phases before `first` and after `last` were run alone, and both did not fail in this way.
    """

    name: str
    first: int
    last: int
    run: int
    is_closed: bool


def windows_of(found: Covered, status: Callable[[int], frozenset[str]], bounds: tuple[int, int]) -> list[Window]:
    """Return the windows of all failures, in the order of the phases.

    found: the results of all phases.
    status: the method `Coverer.status`, which runs phases alone. It must add its results to `found`.
    bounds: the first and the last phase that may be run.
    """
    windows: list[Window] = []
    for name in sorted(set[str]().union(*found.failed.values())):
        for group in _groups(name, found):
            windows.append(_window(name, group, found, status, bounds))
    return sorted(_merged(windows), key=_place)


def _place(window: Window) -> tuple[int, int, str]:
    """Return a key that sorts windows in the order of the phases."""
    return window.first, window.last, window.name


def _merged(windows: Iterable[Window]) -> list[Window]:
    """Join windows that have the same name and overlap, and return all windows.

    For example, phases 1 to 3 and 5 to 7 fail, and phase 4 held in a run of several phases, so there are two lists of
    failing phases (`_groups`). If phase 4 fails when it is run alone, both lists are extended by it, and overlap.
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
    """Join windows at the end and at the beginning of a period, because phase 0 follows the last phase.

    Two such windows with the same name become one. If a name has only one of them, the phase at the other end of the
    period is run alone, to set `is_closed`.

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
    """Yield the phases at which `name` fails: [1, 2] and [5] if 1, 2, 3 and 5 were run, and it does not fail at 3."""
    failing = {phase for phase, failures in found.failed.items() if name in failures}
    for fails, group in groupby(sorted({*found.held, *found.failed}), failing.__contains__):
        if fails:
            yield list(group)


def _window(
    name: str, group: list[int], found: Covered, status: Callable[[int], frozenset[str]], bounds: tuple[int, int]
) -> Window:
    """Return the window that contains `group`, a list of failing phases that `_groups` yields.

    name: the name of the failure. found, status, bounds: as for `windows_of`.
    """

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
    """Return the last failing phase of a window in one direction. phase: the last one that is known.

    The next phase may have held only in a run of several phases. If it fails alone, the window continues. Further
    phases are then run alone, in growing steps, until the next phase holds or `end` is reached.

    step: 1 to search towards higher phases, -1 towards lower ones.
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
    """Return the case of a job, from a cache with one item, because a worker process runs many parts of one job.

    folder: the current folder, to which a relative path in `job` refers. It only serves as a key of the cache.
    """
    return CoveredCase(job)


def cover_part(job: Job, phases: Sequence[int], seed: int) -> Covered:
    """Do the same as `Coverer.cover` for a part of the phases of a job. Worker processes call this."""
    return Coverer(case_of(job, Path.cwd()), seed).cover(phases)
