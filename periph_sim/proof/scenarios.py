"""Exact values of budgets for many sequences of starts at once, from a closed table, without running the sequences.

closed table: entry --> values of a round, state of rest after it
starts [scenario, round] --for each round, one look-up for all scenarios together--> values [scenario, round]

Each round of each scenario equals a round that was run for the table. So its values are those that `Scene` gives for
these starts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..scene.case.model import BadCase
from ..timing.budgets import Values
from .closed_table import Contradiction, RestPlace, TableMaker
from .free_run import FreeRun, NotClosed
from .stretch import CoveredCase, Job

FIRST = RestPlace(-1, 0)  # the key of the first round in `_worst`
NO_SERIES = "it has one number for the whole run"
JOINED = "it has the key `and`"


class Scenarios:
    """The values of a case's budgets for any sequences of starts, from its closed table.

    budgets: the names of the budgets that have values: proven budgets with one value per occurrence.
    left_out: for each other budget, the reason why it has no values.
    moved: what starts, "rounds" or "frames".
    ticks_per_second: the number of ticks per second.
    first: the tick of the first start, counted from the start of the run.
    apart: the least distance of two starts, in ticks.

    Raise BadCase if the case cannot be read, has no closed table, or fails in a run of its table.
    """

    def __init__(
        self,
        case: str | Path,
        changes: Sequence[str] = (),
        on_progress: Callable[[float], None] | None = None,
    ) -> None:
        """case: the path of the case. changes: "key=value" texts. on_progress: as for `TableMaker`."""
        covered = CoveredCase(Job(str(case), tuple(changes)))
        self._worst: dict[str, dict[RestPlace, float]] = {}
        self._without_values: dict[str, str] = {}
        self._differing: dict[str, str] = {}  # budgets with two values in rounds from equal states
        try:
            maker = TableMaker(covered, on_progress, on_run=self._observe, rests_first=False)
            table = maker.make()
        except NotClosed as error:
            raise BadCase(f"{covered.case.name} has no closed table: {error}") from None
        if table.has_failed:
            broken = ", ".join(sorted(table.outcomes[-1].failures))
            raise BadCase(
                f"{covered.case.name}: {broken} failed in a run of its table; `periph-sim prove --table` shows it"
            )
        assert maker.first is not None
        self.moved = covered.phases.moved
        self.ticks_per_second = covered.phases.ticks_per_second
        self.first = covered.phases.first_start()
        self.apart = table.apart
        self.left_out = covered.not_whole | table.not_proven(covered) | self._without_values
        self.budgets = tuple(one.name for one in covered.case.budget if one.name not in self.left_out)
        for name in self.budgets:
            if name in self._differing:
                what = f"{covered.case.name}: {name} is {self._differing[name]} in two rounds from equal states"
                raise Contradiction(f"{what}; please report this as a defect of periph-sim")
        self._set_arrays(maker)

    def values(self, starts: NDArray[np.int64]) -> dict[str, NDArray[np.float64]]:
        """Return a dictionary from each budget to its worst value in each round, float64[n, rounds].

        Values are in the unit of `Verdict.worst`, such as microseconds.

        starts: int64[n, rounds], the starts of n scenarios in ticks from the start of the run. The first start of each
            is `first`, and the others are at least `apart` after the one before.

        Raise ValueError for other starts.
        """
        self._check(starts)
        count, rounds = starts.shape
        found = {name: np.empty((count, rounds)) for name in self.budgets}
        orbit = np.full(count, self._after_first.orbit)
        tick = np.full(count, self._after_first.tick)
        rest = starts[:, 0] + self._first_length
        for number in range(rounds):
            entry = np.full(count, len(self._lengths) - 1)  # the first round is the last item of the arrays
            if number:
                tick = (tick + starts[:, number] - rest) % self._periods[orbit]
                entry = self._offsets[orbit] + tick
                rest = starts[:, number] + self._lengths[entry]
                orbit, tick = self._orbits[entry], self._ticks[entry]
            for name, values in found.items():
                values[:, number] = self._values[name][entry]
        return found

    def _check(self, starts: NDArray[np.int64]) -> None:
        if starts.ndim != 2 or not starts.size or starts.dtype != np.int64:
            raise ValueError(f"starts: {starts.dtype} of shape {starts.shape}; expected int64 of shape (n, rounds)")
        if (starts[:, 0] != self.first).any():
            raise ValueError(f"starts: a first start is not at tick {self.first}, where the table begins")
        if (np.diff(starts, axis=1) < self.apart).any():
            raise ValueError(
                f"starts: two starts are less than {self.apart} ticks apart, the least distance of the table"
            )

    def _observe(self, run: FreeRun, begun: Sequence[RestPlace]) -> None:
        """Keep the worst value of each budget in each round of a run."""
        places = [FIRST, *begun]
        starts = np.array(run.frames or run.rounds)
        for limit in run.scene.limits:
            name = limit.budget.name
            reason = JOINED if limit.joined else "" if limit.measure.series else NO_SERIES
            if reason:
                self._without_values[name] = reason
                continue
            values, known = limit.values(run.scene.start), self._worst.setdefault(name, {})
            for number, nearest in [] if values is None else _worst_in_rounds(values, starts):
                value = float(limit.show(nearest))
                before = known.setdefault(places[number], value)
                if before != value:
                    self._differing.setdefault(name, f"{before} and {value}")

    def _set_arrays(self, maker: TableMaker) -> None:
        """Set the arrays of the entries, in the order of orbits and ticks."""
        assert maker.first is not None
        self._after_first, self._first_length = maker.first.after, maker.first.length
        self._periods = np.array(maker.table.orbits)
        self._offsets = np.concatenate([[0], np.cumsum(self._periods)[:-1]])
        places = [RestPlace(orbit, tick) for orbit, period in enumerate(maker.table.orbits) for tick in range(period)]
        entries = [*(maker.entries[place] for place in places), maker.first]
        self._lengths = np.array([entry.length for entry in entries])
        self._orbits = np.array([entry.after.orbit for entry in entries])
        self._ticks = np.array([entry.after.tick for entry in entries])
        self._values = {
            name: np.array([self._worst[name][place] for place in (*places, FIRST)]) for name in self.budgets
        }


def _worst_in_rounds(values: Values, starts: NDArray[np.int64]) -> list[tuple[int, int]]:
    """Return, for each round with a value, its number and the value nearest to a limit, or farthest beyond it.

    starts: the starts of the rounds, in ticks from the start of the run. Earlier values belong to the first round.
    """
    rounds = np.maximum(np.searchsorted(starts, values.at, "right") - 1, 0)
    slack = np.full(len(values.values), np.iinfo(np.int64).max)
    for which, limit in values.limits.items():
        distance = values.values - limit
        slack = np.minimum(slack, -distance if which == "max" else distance if which == "min" else -abs(distance))
    order = np.lexsort((slack, rounds))
    numbers, first = np.unique(rounds[order], return_index=True)
    return [(int(number), int(value)) for number, value in zip(numbers, values.values[order][first], strict=True)]
