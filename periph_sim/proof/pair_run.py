"""Runs of groups, in this process or in others. The glossary in `periph_sim.proof` has the terms.

    tasks --PairRun--> runs of scenes --> Done: the runs of the groups, new orbits, outcomes

A run of a scene makes many groups, one after the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from functools import partial
from operator import eq
from pathlib import Path
from typing import NamedTuple

from msgspec import Struct

from ..core.records import Kind
from .cover import case_of
from .free_run import NotClosed
from .measures_at_rest import MeasuresAtRest
from .orbit_ways import first_step
from .pair_budgets import within_round
from .pair_groups import Cells, Group, GroupRun, GroupRunner, Orbit, Orbits, Sleep
from .stretch import CoveredCase, Job, Outcome

STARTS = ("rounds", "frames")
MOST_TRIES = 100  # maximum number of groups and new scenes, in total, that are tried to reach an orbit
CHUNK = 256  # number of groups in one call of `run_tasks`, and about as many in one scene


class Task(NamedTuple):
    """A group to run.

    orbit: the number of the orbit from which it starts.
    offset: the start of the frame, counted in ticks from the beginning of its cell of frames.
    sleep: the wait in which the service routine must come, and which must then go on; None to check nothing.
    """

    orbit: int
    group: Group
    offset: int
    sleep: Sleep | None


class Known(NamedTuple):
    """The findings of earlier runs of the table that a run of groups needs.

    orbits: the orbits.
    cells: the cells of frames; None while they are not known.
    ways: `ways[orbit][after]` is a group that leads from `orbit` to `after`.
    """

    orbits: Orbits
    cells: Cells | None
    ways: dict[int, dict[int, Group]]


class Done(Struct):
    """The outcome of a call that runs groups.

    before: the number of orbits that were known before the call.
    runs: the runs of the groups, in the order of the tasks.
    orbits: the orbits that the call found. Their numbers begin with `before`.
    outcomes: the outcomes of the runs of scenes.
    frames, rounds: for each run of a scene, the ticks of the starts of its frames and of its rounds.
    first_rest: the tick of the first rest, counted from the start of a run.
    spanning, lacking, empty: the budgets with these properties, as in `MeasuresAtRest`.
    unknowns: the names of the options whose answers the runs have used.
    data_use: the first use of the data of a frame that decides what the firmware does, as text; "" for none.
    """

    before: int
    runs: list[GroupRun]
    orbits: list[Orbit]
    outcomes: list[Outcome]
    frames: list[list[int]]
    rounds: list[list[int]]
    first_rest: int
    spanning: set[str]
    lacking: set[str]
    empty: set[tuple[str, str]]
    unknowns: set[str]
    data_use: str = ""


class PairRun:
    """Runs groups, in as many runs of scenes as necessary. done: the outcome of the scenes that have ended."""

    def __init__(self, covered: CoveredCase, ignored: Sequence[str], known: Known) -> None:
        self._covered, self._ignored, self._known = covered, ignored, known
        self._last: Group | None = None  # the group that was run last
        self.done = Done(len(known.orbits.known), [], [], [], [], [], 0, set(), set(), set(), set())
        self._begin()

    def run_all(self, tasks: Sequence[Task]) -> list[GroupRun]:
        """Run the groups of these tasks, and return their runs in the order of `tasks`.

        They are run in another order: groups that start from the present orbit come first, because it takes further
        groups to reach another orbit. Raise NotClosed if an orbit cannot be reached.
        """
        left: dict[int, list[int]] = {}  # for each orbit, the indices of its tasks that are left, last one first
        for index in reversed(range(len(tasks))):
            left.setdefault(tasks[index].orbit, []).append(index)
        runs: dict[int, GroupRun] = {}
        while left:
            here = self.runner.at[0]
            orbit = here if here in left else max(left, key=lambda one: len(left[one]))
            index = left[orbit].pop()
            if not left[orbit]:
                del left[orbit]
            runs[index] = self.run(tasks[index])
        return [runs[index] for index in range(len(tasks))]

    def run(self, task: Task) -> GroupRun:
        """Go to the orbit of a task, and run its group. Raise NotClosed if the orbit cannot be reached."""
        if len(self.runner.run.frames) + len(self.runner.run.rounds) > 2 * CHUNK:
            self.end()
            self._begin()
        self.reach(task.orbit)
        return self._group(task.group, task.offset, task.sleep)

    def reach(self, orbit: int) -> None:
        """Run groups until the scene rests in orbit `orbit`. Raise NotClosed if it cannot be reached.

        If no way to it is known, two steps are tried in turn: a group that is similar to the last one, and a new scene.
        """
        for tries in range(MOST_TRIES):
            if self.runner.at[0] == orbit:
                return
            step = first_step(self._known.ways, self.runner.at[0], partial(eq, orbit))
            if step is not None:
                self._group(step)
            elif self._last is not None and tries % 2 == 0:
                self._group(self.runner.like(self._last))
            else:
                self.end()
                self._begin()
        raise NotClosed("a state of rest is not reached again")

    def end(self) -> None:
        """End the present run of a scene, and add its outcome to `done`."""
        run, done = self.runner.run, self.done
        done.outcomes.append(self._covered.finish(run.scene))
        done.frames.append(run.frames)
        done.rounds.append(run.rounds)
        self._measures.finish(done.outcomes[-1].verdicts)
        done.spanning |= self._measures.spanning
        done.lacking |= self._measures.lacking
        done.empty |= self._measures.empty
        done.unknowns |= self._covered.unknowns
        done.data_use = done.data_use or run.data_use
        done.orbits = self._known.orbits.known[done.before :]

    def _begin(self) -> None:
        """Begin a new run of a scene, and advance to its first rest."""
        self.runner = GroupRunner(self._covered, self._ignored, self._known.orbits, self._known.cells)
        self._measures = MeasuresAtRest(self.runner.run.scene.limits, [Kind.BUS])
        self._measures.rest(self.runner.run.now, STARTS)
        self.done.first_rest = self.runner.run.now - self.runner.run.scene.start

    def _group(self, group: Group, offset: int = 0, sleep: Sleep | None = None) -> GroupRun:
        """Run a group from the present orbit, note to which orbit it leads, and return its run."""
        orbit = self.runner.at[0]
        found = self.runner.run_group(group, offset, sleep)
        self._known.ways.setdefault(orbit, {}).setdefault(found.after, group)
        self._last = group
        starts = zip(STARTS, (group.round, group.frame), strict=True)
        self._measures.rest(self.runner.run.now, [start for start, at in starts if at is not None])
        return found


def alone(orbits: Orbits, number: int, cells: Cells | None, cycle: int, rounds: Sequence[int]) -> list[Group]:
    """Return the rounds alone and the frames alone that start from orbit `number`.

    cells: the cells of frames; None for no frames.
    cycle: the number of ticks of a cycle.
    rounds: the ticks of the orbit at which rounds start.
    """
    orbit, groups = orbits.known[number], [Group(at, None) for at in rounds]
    if cells is not None:
        first = (cells.first - orbit.origin) % cells.period
        groups += [Group(None, tick) for tick in range(first, orbit.cycles * cycle, cells.period)]
    return groups


def run_tasks(job: Job, ignored: Sequence[str], known: Known, tasks: Sequence[Task]) -> Done:
    """Run groups in new scenes, and return the outcome. Worker processes call this.

    job: the case. ignored: the ignored attributes. known: what earlier runs have found.

    The outcome depends on the arguments only.
    """
    pair = PairRun(within_round(case_of(job, Path.cwd())), ignored, deepcopy(known))
    pair.done.runs += pair.run_all(tasks)
    pair.end()
    return pair.done
