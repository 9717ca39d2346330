"""Exact values of budgets for many sequences of starts at once, from a closed table, without running the sequences.

closed table: entry (orbit, tick) --> values of its round, place of the rest after it
seeds --> starts [scenario, round] --for each round, one look-up for all scenarios together--> values [scenario, round]

A scenario is a sequence of starts. Each of its rounds is like that of an entry. So its values are those that `Scene`
gives for these starts. In a case with only frames, "round" means a frame. The glossary in `periph_sim.proof` has the
terms.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from operator import index
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..scene.case.model import BadCase
from ..timing.budgets import Values
from .closed_table import Contradiction, RestPlace, TableMaker
from .free_run import FreeRun, NotClosed
from .stretch import CoveredCase, Job


class Scenarios:
    """The values of a case's budgets for any sequences of starts, from its closed table.

    budgets: the names of the budgets that have values: proven budgets with one value per occurrence.
    left_out: the reason why a budget has no values, by its name, for each other budget.
    moved: the kind of the starts: "rounds" or "frames".
    ticks_per_second: the number of ticks per second.
    first: the tick of the first start, counted from the start of the run. If the starts of the case have jitter, the
        first start is free, and this is the least tick at which it can be.
    apart: the least distance of two starts, in ticks.
    most: the greatest number of starts of the case; None if there is no limit.

    Raise BadCase if the case cannot be read, has no closed table, or fails in a run of its table.
    """

    def __init__(
        self,
        case: str | Path,
        changes: Sequence[str] = (),
        on_progress: Callable[[float], None] | None = None,
    ) -> None:
        """Make the closed table of a case.

        case: the path of the case. changes: "key=value" texts. on_progress: called with the fraction that is done.
        """
        covered = CoveredCase(Job(str(case), tuple(changes)))
        self._phases = covered.phases
        self._worst: dict[
            str, dict[RestPlace | None, float]
        ] = {}  # by budget and entry; the key of the first round is None
        self._without_values: dict[str, str] = {}
        self._differing: dict[str, str] = {}  # by budget: two values, as text, that it had in rounds of one entry
        try:
            maker = TableMaker(covered, on_progress, on_run=self._observe)
            table = maker.make()
        except NotClosed as error:
            raise BadCase(f"{covered.case.name} has no closed table: {error}") from None
        if table.has_failed:
            broken = ", ".join(sorted(table.outcomes[-1].failures))
            raise BadCase(
                f"{covered.case.name}: {broken} failed in a run of its table; `periph-sim prove --table` shows it"
            )
        self.moved = covered.phases.moved
        self.ticks_per_second = covered.phases.ticks_per_second
        self.first = table.first_rest + 1 if table.rests_first else covered.phases.first_start
        self.apart = table.apart
        self.most = covered.phases.most_starts
        self.left_out = covered.not_whole | table.not_proven(covered, table.apart) | self._without_values
        self.budgets = tuple(one.name for one in covered.case.budget if one.name not in self.left_out)
        for name in self.budgets:
            if name in self._differing:
                what = f"{covered.case.name}: {name} is {self._differing[name]} in two rounds from equal states"
                raise Contradiction(f"{what}; please report this as a defect of periph-sim")
        self._set_arrays(maker)

    def starts(self, seeds: Iterable[int], rounds: int) -> NDArray[np.int64]:
        """Return the starts that runs of the case with these seeds have, as int64[seeds, rounds].

        rounds: the number of starts. Without jitter, all seeds have the same starts.

        Raise TypeError for a seed that is not an integer. Raise ValueError if there is no seed, if the case does not
        have that many rounds, or if it has starts that are less than `apart` ticks apart.
        """
        if rounds < 1 or (self.most is not None and rounds > self.most):
            until = "or more" if self.most is None else f"to {self.most}, since the case has no more {self.moved}"
            raise ValueError(f"rounds: {rounds}; expected 1 {until}")
        delays = [self._phases.delays(index(seed), rounds) for seed in seeds]
        starts = np.array(self._phases.due_starts(rounds)) + np.array(delays, np.int64).reshape(-1, rounds)
        self._check(starts)
        return starts

    def values(self, starts: NDArray[np.int64]) -> dict[str, NDArray[np.float64]]:
        """Return the worst value of each budget in each round, by the name of the budget, as float64[n, rounds].

        Values are in the unit of `Verdict.worst`, such as microseconds.

        starts: int64[n, rounds], the starts of n scenarios in ticks from the start of the run. The first one is at
            `first`, or also later if it is free. Each further one is at least `apart` after the one before.

        Raise ValueError for other starts.
        """
        starts = np.asarray(starts)
        self._check(starts)
        entry, entries = np.array(-1), np.empty(starts.shape[::-1], np.int64)
        for number, distance in enumerate(np.diff(starts.T, axis=0, prepend=0)):
            entry = self._offsets[entry] + (self._shifts[entry] + distance) % self._periods[entry]
            entries[number] = entry
        return {name: values[entries].T for name, values in self._values.items()}

    def _check(self, starts: NDArray[np.int64]) -> None:
        """Raise ValueError if the table does not hold for these starts."""
        if starts.ndim != 2 or not starts.size or starts.dtype != np.int64:
            raise ValueError(f"starts: {starts.dtype} of shape {starts.shape}; expected int64 of shape (n, rounds)")
        is_free, earliest = self._phases.jitter > 0, starts[:, 0].min()
        if earliest < self.first or (not is_free and (starts[:, 0] != self.first).any()):
            expected = f"before tick {self.first}" if is_free else f"not at tick {self.first}"
            raise ValueError(f"starts: a first start is {expected}, where the table begins")
        close = np.argwhere(np.diff(starts, axis=1) < self.apart)
        if close.size:
            which, number = close[0]
            what = f"starts[{which}]: the starts {number} and {number + 1} are less than {self.apart} ticks apart"
            raise ValueError(f"{what}, the least distance of the table")

    def _observe(self, run: FreeRun, begun: Sequence[RestPlace]) -> None:
        """Keep the worst value of each budget in each round of a run. begun: the entries of the rounds."""
        starts = np.array(run.frames or run.rounds)
        places = begun if self._phases.jitter else [None, *begun]
        for limit in run.scene.limits:
            name = limit.budget.name
            if limit.joined or not limit.measure.series:
                why = "it has the key `and`" if limit.joined else "it has one number for the whole run"
                self._without_values[name] = why
                continue
            values, known = limit.values(run.scene.start), self._worst.setdefault(name, {})
            if self._phases.jitter and values is not None and values.at.min(initial=starts[0]) < starts[0]:
                self._without_values[name] = "it has values before the first start"
                continue
            for number, nearest in [] if values is None else worst_in_rounds(values, starts):
                value = float(limit.show(nearest))
                before = known.setdefault(places[number], value)
                if before != value:
                    self._differing.setdefault(name, f"{before} and {value}")

    def _set_arrays(self, maker: TableMaker) -> None:
        """Set arrays with an item for each entry, sorted by orbit and tick.

        If the first start is not free, a further item is for the first round, which counts as an entry here.

        If a round has entry e, and the next round starts d ticks after it, the next round has the entry

            _offsets[e] + (_shifts[e] + d) % _periods[e]

        These three arrays have one more item, which gives the entry of the first round: e is -1, and d is counted from
        the start of the run.
        """
        periods = np.array(maker.table.orbits)
        offsets = np.concatenate([[0], np.cumsum(periods)[:-1]])
        rests = [RestPlace(orbit, tick) for orbit, period in enumerate(maker.table.orbits) for tick in range(period)]
        entries = [maker.entries[rest] for rest in rests]
        places: list[RestPlace | None] = [*rests]
        begin = 0, periods[0], -maker.table.first_rest  # the first rest is tick 0 of the first orbit
        if maker.first is not None:
            begin = len(entries), 1, 0
            places.append(None)
            entries.append(maker.first)
        orbits = [entry.after.orbit for entry in entries]
        self._offsets = np.append(offsets[orbits], begin[0])
        self._periods = np.append(periods[orbits], begin[1])
        self._shifts = np.append([entry.after.tick - entry.length for entry in entries], begin[2])
        self._values = {name: np.array([self._worst[name][place] for place in places]) for name in self.budgets}


def worst_in_rounds(values: Values, starts: NDArray[np.int64]) -> list[tuple[int, int]]:
    """Return, for each round that has a value, its number and its worst value.

    starts: the starts of the rounds, in ticks from the start of the run. Earlier values count for the first round.
    """
    rounds = np.maximum(np.searchsorted(starts, values.at, "right") - 1, 0)
    slack = np.full(len(values.values), np.iinfo(np.int64).max)
    for which, limit in values.limits.items():
        distance = values.values - limit
        slack = np.minimum(slack, -distance if which == "max" else distance if which == "min" else -abs(distance))
    order = np.lexsort((slack, rounds))
    numbers, first = np.unique(rounds[order], return_index=True)
    return [(int(number), int(value)) for number, value in zip(numbers, values.values[order][first], strict=True)]
