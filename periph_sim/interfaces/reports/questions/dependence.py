"""The verdict of each budget in all runs: whether the budget holds, and the answers under which its verdict differs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ....scene.result import Result
from ....timing.verdict import PROVEN, SEEN, Verdict, figure
from ..sweep.runs import Row
from .explore import Exploration, is_stuck

RUN = "(the run)"  # the `name` of a Dependence about runs that are stuck or cannot be made, and not about a budget
NOT_MADE, STUCK = "cannot be made", "stuck"


class Departure(NamedTuple):
    """A run in which the verdict of a budget differs from that of the case as it is.

    number: the index of the run in `Exploration.attempts`.
    word: the verdict of the budget in this run (`Verdict.word`). In the Dependence
        named RUN, which is not about a budget: "stuck", "cannot be made", or "seen" for all other runs.
    found: the worst value of the budget, or the reason why the run is stuck or cannot be made.
    """

    number: int
    word: str
    found: str


@dataclass(frozen=True)
class Dependence:
    """The verdicts of a budget in all runs.

    word: the verdict in the run of the case as it is (see `Departure.word`).
    worst: the verdict with the least margin of all runs; None for RUN.
    departures: the runs in which the verdict differs, in the order of the runs.
    """

    name: str
    word: str
    worst: Verdict | None
    departures: tuple[Departure, ...]

    @property
    def holds(self) -> bool:
        """True if the budget passes in every run."""
        return self.word in (SEEN, PROVEN) and not self.departures


def dependences(explored: Exploration) -> list[Dependence]:
    """Return a Dependence for each budget of the case.

    If a run is stuck or cannot be made, a Dependence with the name RUN comes before those of the budgets.
    """
    default, attempts = explored.default, explored.attempts
    found = [_of_budget(number, explored) for number in range(len(default.budgets))]
    words = [(number, *_of_run(attempt.row)) for number, attempt in enumerate(attempts)]
    own = _of_run(default)[0]
    if {own, *(word for _, word, _ in words)} != {SEEN}:
        departures = (Departure(*one) for one in words if one[1] != own)
        found.insert(0, Dependence(RUN, own, None, tuple(departures)))
    return found


def _of_budget(number: int, explored: Exploration) -> Dependence:
    own = explored.default.budgets[number]
    rows = enumerate(attempt.row for attempt in explored.attempts)
    made = [(run, row.budgets[number]) for run, row in rows if isinstance(row, Result)]
    measured = [verdict for verdict in (own, *(verdict for _, verdict in made)) if verdict.margin is not None]
    departures = (
        Departure(run, verdict.word, figure(verdict.worst, verdict.unit))
        for run, verdict in made
        if verdict.word != own.word
    )
    worst = min(measured, key=lambda verdict: verdict.margin or 0, default=own)
    return Dependence(own.name, own.word, worst, tuple(departures))


def _of_run(row: Row) -> tuple[str, str]:
    if isinstance(row, str):
        return NOT_MADE, row
    return (STUCK, row.stuck[0]) if is_stuck(row) else (SEEN, "")
