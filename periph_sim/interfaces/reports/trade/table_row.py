"""The closed table of a case as a row of a comparison: exact values for many seeds at once, but not of all budgets.

table --starts of SEEDS seeds--> values, CPU time per simulated second
      --starts of one seed--> values, compared with those of a run with this seed
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from time import process_time

import numpy as np
from numpy.typing import NDArray

from ....proof.scenarios import Scenarios, worst_in_rounds
from ....scene.case.model import BadCase, Case
from ....scene.scene import Scene
from .cost import Cost, cost_of
from .observe import Error

SEEDS = 1000
ROUNDS = 50  # maximum number of rounds, or frames, for each seed
RUNS = 5


@dataclass(frozen=True)
class Tabulated:
    """The cost and the error of a closed table.

    made_s: the CPU time in which the table was made, in seconds.
    moved: what starts, "rounds" or "frames".
    rounds: the number of starts for each seed.
    cost: the CPU time of drawing and looking up the values of SEEDS seeds, for each simulated second of each seed.
    error: the largest difference of a value of a time from the one in a run, in seconds.
    budgets: the names of the budgets that have values.
    left_out: for each budget without values, the reason.
    """

    made_s: float
    moved: str
    rounds: int
    cost: Cost
    error: Error
    budgets: tuple[str, ...]
    left_out: dict[str, str]

    @property
    def sentences(self) -> list[str]:
        """Sentences that say what the table gives and what it leaves out."""
        made = f"table: made in {self.made_s:.1f} s of CPU"
        gives = (
            f"it gives the worst values in {self.rounds} {self.moved} of {SEEDS} seeds, but no data, counts and wires"
        )
        return [f"{made}; {gives}", *(f"table leaves out {name}: {reason}" for name, reason in self.left_out.items())]


def tabulated(
    file: Path, changes: Sequence[str], case: Case, on_progress: Callable[[float], None] | None = None
) -> Tabulated:
    """Make the closed table of a case, and return its cost and its error.

    file, changes: the path of the case and the changes of its keys, as "key=value".
    case: the changed case.
    on_progress: called with the fraction of the work that is done, 0 to 1.

    Raise BadCase if the case has no closed table, or no budget has values.
    """
    began = process_time()
    scenarios = Scenarios(file, changes, on_progress)
    made_s = process_time() - began
    if not scenarios.budgets:
        what = "; ".join(f"{name}: {reason}" for name, reason in scenarios.left_out.items())
        raise BadCase(f"no budget has values: {what}")
    rounds = min(ROUNDS, scenarios.most or ROUNDS)
    seconds = []
    for _ in range(RUNS):
        began = process_time()
        starts = scenarios.starts(range(SEEDS), rounds)
        scenarios.values(starts)
        simulated = float(starts[:, -1].sum()) / scenarios.ticks_per_second
        seconds.append((process_time() - began) / simulated)
    error = _error(scenarios, case, scenarios.starts([case.seed], rounds))
    return Tabulated(made_s, scenarios.moved, rounds, cost_of(seconds), error, scenarios.budgets, scenarios.left_out)


def _error(scenarios: Scenarios, case: Case, starts: NDArray[np.int64]) -> Error:
    """Return the largest difference of times in a run of the case, which has these starts, from those of the table."""
    values = scenarios.values(starts)
    scene = Scene(case, keep_values=True)
    scene.run(Fraction(int(starts[0, -1]) + scenarios.apart - 1, scenarios.ticks_per_second))
    errors = [Error(0.0, "s")]
    for limit in scene.limits:
        kept, name = limit.values(scene.start), limit.budget.name
        if name in values and kept is not None and kept.unit == "time":
            for number, value in worst_in_rounds(kept, starts[0]):
                difference = abs(float(limit.show(value)) - values[name][0, number])
                errors.append(Error(float(difference) / 10**6, "s", name))
    return max(errors)
