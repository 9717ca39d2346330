"""Closed table of a case in which rounds and frames start independently of each other.

    orbit --> rounds and frames alone --> waits in a round --> groups: one by one near the ends of waits,
                                                               first and last of each cell within a wait

A group (`pair_groups`) is a round, a frame, or both together. Its place in the table is the cycle at which the round
starts, and the distance of the frame's cell. A frame affects the rest of the scene only by the service routine of the
SCI, which runs at a fixed time after the frame's cell, so two groups with equal places continue equally.

If the routine runs while the firmware waits in a loop, the wait then continues as before, but its passes come later. So
all groups whose routine begins at the same tick of a pass of one wait have the same effect: they are one `Cell`, a cell
of groups. Only the first and the last group of a cell are run, and must agree. Groups that are in no cell are run one
by one. Random groups, some of them from within cells, are run again after other groups, and must agree, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import deepcopy
from itertools import count, islice, zip_longest
from math import gcd
from random import Random
from statistics import median
from time import process_time
from typing import NamedTuple

from msgspec.structs import astuple

from ..scene.controller import head_plan
from ..scene.plan import ScenePlan
from .calls import CallAll
from .closed_table import StartTable, revisits
from .frame_cells import find_cells
from .free_run import NotClosed
from .pair_budgets import within_round
from .pair_groups import Group, GroupRun, Orbits, Sleep, far_ranges
from .pair_run import CHUNK, STARTS, Done, Known, PairRun, Task, alone, run_tasks
from .stretch import CoveredCase, Job

MOST_SHRINKS = 32  # maximum number of times that the first and last group of a cell are removed because they differ
TIMED = 400  # number of random groups that are run first, to reach most orbits and to estimate the CPU time
CALLS = 64  # maximum number of calls of `run_tasks` that are made at the same time
NEAR_ENDS = 2  # one in NEAR_ENDS of the groups that are run again is a random group of a cell


class Cell(NamedTuple):
    """Groups with equal effects, which differ only in the distance of the frame: first, first + step, ... last.

    sleep: the wait that their service routines interrupt.
    """

    orbit: int
    round: int
    first: int
    last: int
    step: int
    sleep: Sleep

    @property
    def groups(self) -> int:
        return (self.last - self.first) // self.step + 1

    def shrunk(self) -> Cell:
        """Return this cell without its first and its last group."""
        return self._replace(first=self.first + self.step, last=self.last - self.step)


class KnownGroup(NamedTuple):
    """A group of the table. orbit: the number of the orbit from which it starts. run: a run with its effects."""

    orbit: int
    group: Group
    run: GroupRun


class PairMaker:
    """Makes the table of a case in which rounds and frames start independently.

    on_progress: called with the fraction of the known groups that were run, 0 to 1.
    on_estimate: called with the number of groups, and an estimate of the CPU time in seconds.
    call_all: makes the calls that run groups.
    least_again: the least number of groups that are run again.
    any_tick: True if rounds can start at any tick, False if they start with a cycle of the CPU.
    covered: the case, without the budgets that the table cannot judge.
    long: see `FreeRun`.
    runs: the runs so far, by the number of the orbit and the group.
    cells: the cells of groups so far.
    """

    def __init__(
        self,
        covered: CoveredCase,
        job: Job,
        ignored: Sequence[str],
        on_progress: Callable[[float], None],
        on_estimate: Callable[[int, float], None],
        call_all: CallAll,
        least_again: int,
        any_tick: bool,
    ) -> None:
        self.covered, self._job, self._ignored = within_round(covered), job, ignored
        self._on_progress, self._on_estimate, self._call_all = on_progress, on_estimate, call_all
        self._least_again = least_again
        self._any_tick = any_tick
        self._random = Random(1)
        self._orbits = Orbits()
        self._ways: dict[int, dict[int, Group]] = {}
        self.runs: dict[tuple[int, Group], GroupRun] = {}
        self.cells: list[Cell] = []
        self.table = StartTable([], 0, 0, 0, 0, False, [], [], set(), set())
        self._empty: set[tuple[str, str]] = set()
        self._expected = 0  # expected number of groups to run

    def make(self) -> StartTable:
        """Return the table, once it is closed or a run has failed. Call `explore` before.

        Raise NotClosed if it cannot be closed, or if two runs of a group differ.
        """
        table = self.table
        closed = 0
        while closed < len(self._orbits.known) and not table.has_failed:
            numbers = range(closed, len(self._orbits.known))
            self._close(numbers)
            closed = numbers.stop
        if not table.has_failed:
            self._again()
        table.apart += self.long  # within a cell, the rest can come later by a step of `FreeRun.settle`
        return table

    # Steps --------------------------------------------------------------------------

    def explore(self) -> PairRun:
        """Find the cells of frames, and most of the orbits. Return the last `PairRun`."""
        known = Known(self._orbits, None, self._ways)
        pair = PairRun(self.covered, self._ignored, known)
        self._frames = pair.runner.cells = find_cells(pair.runner)
        self.long = pair.runner.run.long
        self._cycle = pair.runner.cycle
        self._places = round_offsets(self.covered, self._cycle) if self._any_tick else (0,)
        pair.end()
        self._add(pair.done)
        begun = process_time()
        pair = PairRun(self.covered, self._ignored, self.known)
        self._scene_seconds = process_time() - begun  # CPU time to the first rest of a scene
        orbit = pair.runner.at[0]
        for group in self._alone(orbit):
            self._keep(orbit, group, pair.run(Task(orbit, group, 0, None)))
        tasks, _ = self.tasks(orbit, self.find_waits(pair, orbit))
        times = []
        for task in [self._random.choice(tasks) for _ in range(TIMED)]:
            begun = process_time()
            self._keep(orbit, task.group, pair.run(task))
            times.append(process_time() - begun)
        self._seconds = median(times)
        pair.end()
        self._add(pair.done)
        self._expected = len(tasks) * len(self._orbits.known)
        return pair

    def estimate(self, rates: Sequence[int] = ()) -> None:
        """Call `on_estimate`. rates: for each rate of the host that is run in addition, the number of its starts."""
        groups = self._expected + revisits(self._expected, self._least_again)
        if rates:
            groups += self._least_again + 3 * sum(rates)  # `host_rates` runs three frames for each start
        scenes = groups / CHUNK + len(rates)
        self._on_estimate(self._expected, self._seconds * groups + self._scene_seconds * scenes)

    def _close(self, numbers: Sequence[int]) -> None:
        """Run the groups from these orbits: the first and last group of each cell, and all that are in no cell."""
        pair = PairRun(self.covered, self._ignored, self.known)
        waits = {number: self.find_waits(pair, number) for number in numbers}
        pair.end()
        self._add(pair.done)
        self._run(
            [
                Task(number, group, offset, None)
                for number in numbers
                for group in self._alone(number)
                for offset in sorted({0, self._most_offset(group)})
            ]
        )
        found = [self.tasks(number, waits[number]) for number in numbers]
        # each call has groups from all these orbits (`PairRun.run_all`)
        self._run([task for some in zip_longest(*(tasks for tasks, _ in found)) for task in some if task is not None])
        cells = [cell for _, cells in found for cell in cells]
        within = [sum(cell.groups - 2 for cell in cells) for _, cells in found]  # groups that are in cells and not run
        for _ in range(MOST_SHRINKS):
            if self.table.has_failed:
                return
            self.cells += [cell for cell in cells if self._is_cell(cell)]
            cells = [cell.shrunk() for cell in cells if cell.groups > 2 and not self._is_cell(cell)]
            self._run([task for cell in cells for task in self._ends(cell)])
        if cells:
            raise NotClosed("service routines of the SCI within one wait have different effects")
        counts = zip(numbers, found, within, strict=True)
        self.table.orbits += [len(self._alone(number)) + len(tasks) + inner for number, (tasks, _), inner in counts]

    def _again(self) -> None:
        """Run random groups again, and compare them with the first runs."""
        known = list(islice(self.random_groups(), revisits(len(self.runs), self._least_again)))
        tasks = [
            Task(one.orbit, one.group, self._random.randrange(self._most_offset(one.group) + 1), None) for one in known
        ]
        runs = self._run(tasks, keep=False)
        if not self.table.has_failed:
            for one, run in zip(known, runs, strict=True):
                self._compare(one.orbit, one.group, one.run, run)
            self.table.again = len(known)

    def random_groups(self, number: int | None = None, is_alone: bool | None = None) -> Iterator[KnownGroup]:
        """Yield random groups of the table, without end: some that were run, and some from within cells.

        number: only groups from this orbit; None for all orbits.
        is_alone: True for frames alone, False for groups with a round and a frame, None for all groups.
        """

        def is_wanted(orbit: int, group: Group) -> bool:
            kind = None if group.frame is None else group.round is None
            return number in (None, orbit) and is_alone in (None, kind)

        groups = [key for key in self.runs if is_wanted(*key)]
        cells = [cell for cell in self.cells if is_wanted(cell.orbit, Group(cell.round, cell.first))]
        for turn in count():
            if not cells or turn % NEAR_ENDS:
                orbit, group = self._random.choice(groups)
                yield KnownGroup(orbit, group, self.runs[orbit, group])
            else:
                cell = self._random.choice(cells)
                group = Group(cell.round, cell.first + cell.step * self._random.randrange(cell.groups))
                yield KnownGroup(cell.orbit, group, self._of(cell, cell.first))

    # Groups -------------------------------------------------------------------------

    @property
    def known(self) -> Known:
        return Known(self._orbits, self._frames, self._ways)

    def _alone(self, number: int) -> list[Group]:
        return alone(self._orbits, number, self._frames, self._cycle, self._rounds())

    def _rounds(self) -> list[int]:
        """Return the ticks of an orbit at which rounds are started, modulo the orbit's own period."""
        return [cycle * self._cycle + place for cycle in range(self._orbits.own) for place in self._places]

    def _most_offset(self, group: Group) -> int:
        """Return the greatest number of ticks from the first start in the frame's cell to the start of the frame."""
        return 0 if group.frame is None else self._frames.period - 1

    def find_waits(self, pair: PairRun, number: int) -> dict[int, list[Sleep]]:
        """Return, for each tick of an orbit at which a round is started, the waits in this round alone."""
        waits = {}
        for tick in self._rounds():
            pair.reach(number)
            waits[tick] = pair.runner.sleeps(Group(tick, None))
        return waits

    def tasks(self, number: int, waits: Mapping[int, Sequence[Sleep]]) -> tuple[list[Task], list[Cell]]:
        """Return the groups with a round and a frame that must be run from an orbit, and the cells of the orbit.

        Of each cell, only the first and the last group are among the groups to run.
        """
        tasks: list[Task] = []
        cells: list[Cell] = []
        orbit, frames = self._orbits.known[number], self._frames
        lengths = [(group, run.length) for (_, group), run in self.runs.items()]
        least = -max(length for group, length in lengths if group.round is None) - frames.period
        most = max(length for group, length in lengths if group.frame is None)
        step = gcd(self._orbits.own * self._cycle, frames.period)
        for tick, sleeps in waits.items():
            first = least + (frames.first - orbit.origin - tick - least) % step
            distances = range(first, most + 1, step)
            near = 0  # index of the first distance that is in no task yet
            for low, high, sleep in far_ranges(sleeps, frames, self._cycle):
                apart = sleep.period * step // gcd(sleep.period, step)
                begin = max(near, -(-(low - first) // step))
                end = min(len(distances), (high - first) // step + 1)
                if end - begin <= 2 * apart // step:
                    continue
                tasks += self._near(number, tick, distances[near:begin])
                for one in distances[begin : begin + apart // step]:
                    last = one + (distances[end - 1] - one) // apart * apart
                    cells.append(Cell(number, tick, one, last, apart, sleep))
                    tasks += self._ends(cells[-1])
                near = end
            tasks += self._near(number, tick, distances[near:])
        return tasks, cells

    def _ends(self, cell: Cell) -> tuple[Task, Task]:
        """Return the first group of a cell, at the first tick of the frame's cell, and its last group, at the last."""
        first, last = (Group(cell.round, frame) for frame in (cell.first, cell.last))
        return Task(cell.orbit, first, 0, cell.sleep), Task(cell.orbit, last, self._frames.period - 1, cell.sleep)

    def _near(self, orbit: int, tick: int, distances: range) -> Iterator[Task]:
        for number, distance in enumerate(distances):
            yield Task(orbit, Group(tick, distance), self._frames.period - 1 if number % 2 else 0, None)

    def _is_cell(self, cell: Cell) -> bool:
        first, last = self._of(cell, cell.first), self._of(cell, cell.last)
        return first.within and last.within and first.is_like(last)

    def _of(self, cell: Cell, frame: int) -> GroupRun:
        return self.runs[cell.orbit, Group(cell.round, frame)]

    # Runs ---------------------------------------------------------------------------

    def _run(self, tasks: Sequence[Task], keep: bool = True) -> list[GroupRun]:
        """Run groups, and return their runs in order, up to the first failure. keep: True to add them to the table."""
        found: list[GroupRun] = []
        for done in self._outcomes(tasks):
            runs = self._add(done)
            if keep:
                for task, run in zip(tasks[len(found) : len(found) + len(runs)], runs, strict=True):
                    self._keep(task.orbit, task.group, run)
            found += runs
            self._on_progress(min(1, len(self.runs) / max(1, self._expected)))
            if self.table.has_failed:
                break
        return found

    def _outcomes(self, tasks: Sequence[Task]) -> Iterator[Done]:
        """Run groups, and yield the outcome of each CHUNK of them, in order.

        The orbits that the first CALLS calls find are known to the next ones. So the arguments of a call do not depend
        on the number of processes.
        """
        for first in range(0, len(tasks), CHUNK * CALLS):
            known, some = deepcopy(self.known), tasks[first : first + CHUNK * CALLS]
            chunks = [some[begin : begin + CHUNK] for begin in range(0, len(some), CHUNK)]
            yield from self._call_all(run_tasks, [(self._job, self._ignored, known, one) for one in chunks])

    def _add(self, done: Done) -> list[GroupRun]:
        """Add the outcome of runs to the table. Return the runs, with the numbers of orbits in the table."""
        table = self.table
        table.first_rest = done.first_rest
        table.apart = max(table.apart, done.first_rest - min(self.covered.phases.first_starts().values()) + 1)
        table.outcomes += done.outcomes
        table.starts += done.frames
        table.rounds += done.rounds
        table.spanning |= done.spanning
        self._empty |= done.empty
        rounds, frames = ({name for start, name in self._empty if start == each} for each in STARTS)
        table.lacking |= done.lacking | (rounds & frames)
        self.covered.unknowns |= done.unknowns
        table.data_use = table.data_use or done.data_use
        places: list[tuple[int, int]] = [(number, 0) for number in range(done.before)]
        for orbit in done.orbits:
            self._orbits.add(orbit)
            places.append(self._orbits.places[orbit.keys[0]])
        runs = []
        for run in done.runs:
            after, cycle = places[run.after]
            shift = (run.shift + cycle * self._cycle) % (self._orbits.known[after].cycles * self._cycle)
            runs.append(run._replace(after=after, shift=shift))
        return runs

    def _keep(self, orbit: int, group: Group, run: GroupRun) -> None:
        """Add the run of a group to the table, or compare it with the first run of the group."""
        known = self.runs.setdefault((orbit, group), run)
        self._compare(orbit, group, known, run)
        self._ways.setdefault(orbit, {}).setdefault(run.after, group)
        self.table.apart = max(self.table.apart, run.length + 1)
        self.table.entries = len(self.runs)

    def _compare(self, orbit: int, group: Group, known: GroupRun, run: GroupRun) -> None:
        if not run.is_like(known):
            what = f"{group} from orbit {orbit}: {known} and {run}"
            raise NotClosed(f"two runs of one meeting differ, so more than the service routine matters ({what})")


def round_offsets(covered: CoveredCase, cycle: int) -> tuple[int, ...]:
    """Return the ticks in a cycle at which rounds are run, so that they stand for all ticks of the cycle.

    All delays of a controller, and a cycle, are multiples of some number of ticks, the grid. The unit acts when cycles
    begin. So rounds that start between the same two multiples of the grid have all events in the same order, and the
    times between their events change linearly. The first and the last of them are run, and the multiples themselves.

    cycle: the number of ticks of a cycle.
    """
    plan = head_plan(ScenePlan(covered.case).ticks)
    grid = gcd(cycle, *astuple(plan.timing), plan.schedule.gap, plan.stuck_after, plan.clear_after)
    multiples = range(0, cycle, grid)
    return tuple(sorted({begin + place for begin in multiples for place in (0, min(1, grid - 1), grid - 1)}))
