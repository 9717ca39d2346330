"""Closed table of a case with rounds and frames. The glossary in `periph_sim.proof` has the terms.

    orbit --> rounds and frames alone --> waits in a round --> groups: one by one near the ends of waits,
                                                               first and last of each cell of groups

The entries of this table are groups. A frame affects the rest of the scene only by the service routine of the SCI,
which runs at a fixed time after the beginning of the cell of frames. So two runs of one group are alike.

If the routine runs in a wait, the wait then goes on as before, only with later passes. So all groups whose routine
begins at the same tick of a pass of this wait are alike: they are a cell of groups. Only its first and its last group
are run, and must be alike. Groups that are in no cell of groups are run one by one. Random groups, also from the middle
of cells of groups, are run again after other groups.
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

MOST_SHRINKS = 32  # maximum number of times that a cell of groups is made smaller because its ends are not alike
TIMED = 400  # number of random groups that are run first, to find most orbits and to estimate the CPU time
CALLS = 64  # maximum number of calls of `run_tasks` that are made at the same time
OTHER_REST = "the firmware reaches a state of rest that is not in the table"
NEAR_ENDS = 2  # of the groups to run again, one in NEAR_ENDS is any group of a cell of groups, the others were run


class Cell(NamedTuple):
    """A cell of groups.

    orbit, round: the orbit, and the tick R of the orbit, of all these groups.
    first, last, step: their distances are first, first + step, ... last, in ticks. A step is a number of passes.
    sleep: the wait in which their service routines come.
    """

    orbit: int
    round: int
    first: int
    last: int
    step: int
    sleep: Sleep

    @property
    def groups(self) -> int:
        """The number of groups."""
        return (self.last - self.first) // self.step + 1

    def shrunk(self) -> Cell:
        """Return this cell of groups without its first and its last group."""
        return self._replace(first=self.first + self.step, last=self.last - self.step)


class KnownGroup(NamedTuple):
    """A group of the table. orbit: the orbit from which it starts. run: a run of it, or of a group that is alike."""

    orbit: int
    group: Group
    run: GroupRun


class PairMaker:
    """Makes the table of a case with rounds and frames: call `explore`, `estimate` and `make`, in this order.

    job: the case, in a form that can be sent to another process.
    ignored: the ignored attributes.
    on_progress: called with the fraction of the expected groups that were run, 0 to 1.
    on_estimate: called with the expected number of groups, and the estimated CPU time in seconds.
    call_all: makes the calls that run groups, possibly in other processes.
    least_again: the least number of groups that are run again.
    any_tick: True if rounds can start at any tick, False if they start with a cycle of the CPU.
    covered: the case, without the budgets that the table cannot judge.
    long: the number of ticks after which an instant is long past.
    runs: the first run of each group, by (number of the orbit, group).
    cells: the cells of groups that were found so far.
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
        """Run groups until the table is closed or a run has failed, and return it. Call `explore` before.

        Raise NotClosed if the table cannot be closed, or if two runs of a group are not alike.
        """
        table = self.table
        closed = 0
        while closed < len(self._orbits.known) and not table.has_failed:
            numbers = range(closed, len(self._orbits.known))
            self._close(numbers)
            closed = numbers.stop
        if not table.has_failed:
            self._again()
        if not table.has_failed and len(self._orbits.known) > closed:
            raise NotClosed(OTHER_REST)
        table.apart += self.long  # in a group that is not run, the rest can come later by a step of `FreeRun.settle`
        return table

    # Steps --------------------------------------------------------------------------

    def explore(self) -> PairRun:
        """Find the cells of frames, and most of the orbits. Return the last `PairRun`, which has ended."""
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
        """Call `on_estimate`. rates: for each other rate of the host that will be run, the number of its starts."""
        groups = self._expected + revisits(self._expected, self._least_again)
        if rates:
            groups += self._least_again + 3 * sum(rates)  # `host_rates` runs three frames for each start
        scenes = groups / CHUNK + len(rates)
        self._on_estimate(self._expected, self._seconds * groups + self._scene_seconds * scenes)

    def _close(self, numbers: Sequence[int]) -> None:
        """Run groups from these orbits: all that are in no cell of groups, and the first and last one of each cell.

        If the first and the last one are not alike, both are removed from this cell, and its new ends are run.
        """
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
        # The tasks of these orbits are interleaved, so that a call of `run_tasks` gets tasks from many orbits. After
        # each group, it can then continue with a task that starts from the orbit to which this group has led.
        self._run([task for some in zip_longest(*(tasks for tasks, _ in found)) for task in some if task is not None])
        cells = [cell for _, cells in found for cell in cells]
        within = [sum(cell.groups - 2 for cell in cells) for _, cells in found]  # per orbit: groups not run
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
        """Run random groups again. Raise NotClosed if one is not like its first run."""
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
        """Yield random groups of the table, without end: in turn one that was run, and any one of a cell of groups.

        number: the number of the orbit from which they start; None for all orbits.
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
        """Return the rounds alone and frames alone that start from an orbit. number: its number."""
        return alone(self._orbits, number, self._frames, self._cycle, self._rounds())

    def _rounds(self) -> list[int]:
        """Return the ticks at which rounds are started, in one own period of an orbit."""
        return [cycle * self._cycle + place for cycle in range(self._orbits.own) for place in self._places]

    def _most_offset(self, group: Group) -> int:
        """Return the offset of the last tick in a cell of frames; 0 for a round alone."""
        return 0 if group.frame is None else self._frames.period - 1

    def find_waits(self, pair: PairRun, number: int) -> dict[int, list[Sleep]]:
        """Return the waits in each round alone from orbit `number`, by the tick at which the round starts."""
        waits = {}
        for tick in self._rounds():
            pair.reach(number)
            waits[tick] = pair.runner.sleeps(Group(tick, None))
        return waits

    def tasks(self, number: int, waits: Mapping[int, Sequence[Sleep]]) -> tuple[list[Task], list[Cell]]:
        """Return tasks for groups with a round and a frame from orbit `number`, and the cells of groups of this orbit.

        Of each cell of groups, only the first and the last group have a task. waits: as `find_waits` returns them.
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
            near = 0  # index of the first distance that has neither a task nor a cell of groups yet
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
        """Return tasks for the first of a cell of groups, with offset 0, and for the last, with the greatest offset."""
        first, last = (Group(cell.round, frame) for frame in (cell.first, cell.last))
        return Task(cell.orbit, first, 0, cell.sleep), Task(cell.orbit, last, self._frames.period - 1, cell.sleep)

    def _near(self, orbit: int, tick: int, distances: range) -> Iterator[Task]:
        """Yield tasks for groups with these distances. Their offsets alternate between 0 and the greatest offset."""
        for number, distance in enumerate(distances):
            yield Task(orbit, Group(tick, distance), self._frames.period - 1 if number % 2 else 0, None)

    def _is_cell(self, cell: Cell) -> bool:
        """Return True if the first and last group of a cell are alike, and their routines come in the cell's wait."""
        first, last = self._of(cell, cell.first), self._of(cell, cell.last)
        return first.within and last.within and first.is_like(last)

    def _of(self, cell: Cell, frame: int) -> GroupRun:
        return self.runs[cell.orbit, Group(cell.round, frame)]

    # Runs ---------------------------------------------------------------------------

    def _run(self, tasks: Sequence[Task], keep: bool = True) -> list[GroupRun]:
        """Run groups, up to the first failure, and return their runs in order. keep: True to add them to the table."""
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

        CALLS calls are made at a time, with what is known then. What they find is known to the next CALLS calls. So the
        arguments of a call do not depend on the number of processes.
        """
        for first in range(0, len(tasks), CHUNK * CALLS):
            known, some = deepcopy(self.known), tasks[first : first + CHUNK * CALLS]
            chunks = [some[begin : begin + CHUNK] for begin in range(0, len(some), CHUNK)]
            yield from self._call_all(run_tasks, [(self._job, self._ignored, known, one) for one in chunks])

    def _add(self, done: Done) -> list[GroupRun]:
        """Add the outcome of a call to the table, and return its runs of groups.

        The call has numbered the orbits that it found. The returned runs have the numbers of these orbits in the table.
        """
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
        """Add the first run of a group to the table. Raise NotClosed if a further run is not like the first one."""
        known = self.runs.setdefault((orbit, group), run)
        self._compare(orbit, group, known, run)
        self._ways.setdefault(orbit, {}).setdefault(run.after, group)
        self.table.apart = max(self.table.apart, run.length + 1)
        self.table.entries = len(self.runs)

    def _compare(self, orbit: int, group: Group, known: GroupRun, run: GroupRun) -> None:
        """Raise NotClosed if a run of a group is not like an earlier one, `known`. orbit: where the group starts."""
        if not run.is_like(known):
            what = f"{group} from orbit {orbit}: {known} and {run}"
            raise NotClosed(f"two runs of one meeting differ, so more than the service routine matters ({what})")


def round_offsets(covered: CoveredCase, cycle: int) -> tuple[int, ...]:
    """Return the ticks in a cycle at which rounds are run, which stand for all ticks of the cycle.

    For example, if a cycle has 20 ticks and all delays of the controller are multiples of 10, these are 0, 1, 9, 10, 11
    and 19. The unit acts when cycles begin. So rounds that start 1 to 9 ticks after that have all events in the same
    order, and the times between events change linearly with the start. The first and the last of them are run.

    cycle: the number of ticks of a cycle.
    """
    plan = head_plan(ScenePlan(covered.case).ticks)
    grid = gcd(cycle, *astuple(plan.timing), plan.schedule.gap, plan.stuck_after, plan.clear_after)
    return tuple(sorted({at + place for at in range(0, cycle, grid) for place in (0, min(1, grid - 1), grid - 1)}))
