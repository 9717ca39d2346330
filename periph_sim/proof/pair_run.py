"""Runs of groups (`pair_groups`), in this process or in others.

    tasks: groups, all from one orbit --PairRun--> runs of scenes --> Done: the runs of the groups, new orbits, outcomes

A run of a scene has many groups, one after the other.
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
MOST_TRIES = 100  # maximum number of groups and new runs, in total, that are tried to reach an orbit
CHUNK = 256  # number of groups in one run


class Task(NamedTuple):
    """A group to run. offset, sleep: as for `GroupRunner.run_group`."""

    group: Group
    offset: int
    sleep: Sleep | None


class Known(NamedTuple):
    """The part of the table that a run of groups needs.

    ways: `ways[orbit][after]` is a group that leads from `orbit` to `after`.
    """

    orbits: Orbits
    cells: Cells | None
    ways: dict[int, dict[int, Group]]


class Done(Struct):
    """The outcome of runs of groups.

    runs: the runs of the tasks, in order.
    before: the number of orbits that were known before these runs. orbits: the orbits that these runs found.
    outcomes, frames, rounds: for each run of a scene, its outcome and its starts.
    first_rest: the tick of the first rest, from the start of the run.
    spanning, lacking, empty: see `MeasuresAtRest`. unknowns: see `CoveredCase`. data_use: see `FreeRun`.
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
    """Runs groups, in as many runs of scenes as necessary. done: the outcome of the runs that have ended."""

    def __init__(self, covered: CoveredCase, ignored: Sequence[str], known: Known) -> None:
        self._covered, self._ignored, self._known = covered, ignored, known
        self._last: Group | None = None  # the group that was run last
        self.done = Done(len(known.orbits.known), [], [], [], [], [], 0, set(), set(), set(), set())
        self._begin()

    def run(self, orbit: int, task: Task) -> GroupRun:
        """Run a group from an orbit. Raise NotClosed if the orbit cannot be reached."""
        if len(self.runner.run.frames) + len(self.runner.run.rounds) > 2 * CHUNK:
            self.end()
            self._begin()
        self.reach(orbit)
        return self._group(task)

    def reach(self, orbit: int) -> None:
        """Advance to an orbit. Raise NotClosed if it cannot be reached.

        If no way is known, two steps are tried in turn: a group like the one that was run last, and a new run of a
        scene.
        """
        for tries in range(MOST_TRIES):
            if self.runner.at[0] == orbit:
                return
            step = first_step(self._known.ways, self.runner.at[0], partial(eq, orbit))
            if step is not None:
                self._group(Task(step, 0, None))
            elif self._last is not None and tries % 2 == 0:
                self._group(Task(self.runner.like(self._last), 0, None))
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
        self.runner = GroupRunner(self._covered, self._ignored, self._known.orbits, self._known.cells)
        self._measures = MeasuresAtRest(self.runner.run.scene.limits, [Kind.BUS])
        self._measures.rest(self.runner.run.now, STARTS)
        self.done.first_rest = self.runner.run.now - self.runner.run.scene.start

    def _group(self, task: Task) -> GroupRun:
        orbit = self.runner.at[0]
        found = self.runner.run_group(*task)
        self._known.ways.setdefault(orbit, {}).setdefault(found.after, task.group)
        self._last = task.group
        starts = zip(STARTS, (task.group.round, task.group.frame), strict=True)
        self._measures.rest(self.runner.run.now, [start for start, at in starts if at is not None])
        return found


def alone(orbits: Orbits, number: int, cells: Cells | None, cycle: int) -> list[Group]:
    """Return the groups of an orbit that are a round alone or a frame alone. cycle: the number of ticks of a cycle."""
    orbit, groups = orbits.known[number], [Group(at, None) for at in range(orbits.own)]
    if cells is not None:
        first = (cells.first - orbit.origin) % cells.period
        groups += [Group(None, tick) for tick in range(first, orbit.cycles * cycle, cells.period)]
    return groups


def run_tasks(job: Job, ignored: Sequence[str], known: Known, orbit: int, tasks: Sequence[Task]) -> Done:
    """Run groups from one orbit. Another process can call this. The outcome depends on the arguments only."""
    pair = PairRun(within_round(case_of(job, Path.cwd())), ignored, deepcopy(known))
    for task in tasks:
        pair.done.runs.append(pair.run(orbit, task))
    pair.end()
    return pair.done
