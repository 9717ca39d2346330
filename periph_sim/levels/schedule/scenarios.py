"""All scenarios of a call, one after the other in a compiled loop: inputs and terms go in, a tally comes out.

`rounds` tells the same of all at once, by arrays; this is the quicker one where the core is compiled.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from .clock import Ints
from .drawn_rows import drawn_rows
from .extremes import NO_VALUE as NONE_OF_ALL
from .frames import count_of
from .inputs import Inputs
from .kept import BYTES, EDGES
from .one_scenario import (
    DUE,
    FOUND,
    GIVEN,
    HELD,
    HUNG_AT,
    MEASURES,
    MISSED,
    NACKED,
    NACKED_ROUNDS,
    OVER,
    PHASES,
    REFUSED,
    OneScenario,
)
from .structure import Structure
from .tally import Tally
from .terms import Terms
from .value_range import FAR, NO_VALUE

TOGETHER = 2048  # scenarios: their rows stay in the CPU's cache
NONE: Ints = np.zeros(0, np.int64)


def fits(terms: Terms) -> bool:
    """Whether rooms of fixed length are long enough for these reads."""
    edges = sum(len(bus.needs) + 6 for bus in terms.bus)
    return edges < EDGES and all(len(bus.needs) < BYTES for bus in terms.bus)


class Scenarios(Tally):
    def __init__(self, structure: Structure, inputs: Inputs) -> None:
        super().__init__(structure, inputs)
        self._seeds, self._place = np.unique(inputs.seeds, return_inverse=True)

    def run(self) -> None:
        structure, inputs = self._structure, self._inputs
        least, most = inputs.cost
        frames, rounds, unit = count_of(inputs), inputs.rounds, structure.unit
        wide = 0 if np.array_equal(least, most) else int(most[0] - least[0])
        costs, costs_at = self._draws(wide, rounds + 1, lambda seeds: [f"{seed} {unit} computations" for seed in seeds])
        late, late_at = self._draws(inputs.host_jitter, frames, lambda seeds: [seed + 1 for seed in seeds])
        begins, begins_at = self._draws(inputs.controller_jitter, rounds, lambda seeds: seeds)
        columns = (
            *(inputs.host_first, inputs.frame.num, inputs.frame.den),
            *(inputs.controller_first, inputs.round_.num, inputs.round_.den, inputs.clock.num, inputs.clock.den),
            *(least, costs_at, late_at, begins_at, inputs.end),
        )
        given = [np.broadcast_to(column, inputs.scenarios) for column in columns]
        one = OneScenario(structure.terms, structure.receiver, inputs.line.end, costs, late, begins)
        order, told = self._order(), np.empty((FOUND, inputs.scenarios), np.int64)
        rows, found = np.empty((TOGETHER, GIVEN), np.int64), np.empty((TOGETHER, FOUND), np.int64)
        for first in range(0, inputs.scenarios, TOGETHER):
            some = slice(first, min(first + TOGETHER, inputs.scenarios))
            places = some if order is None else order[some]
            count = some.stop - first
            for column, values in enumerate(given):
                rows[:count, column] = values[places]
            one.run(
                rows[:count].reshape(-1),
                found[:count].reshape(-1),
                rounds,
                inputs.controller_jitter,
                inputs.paced_by_pause,
                frames,
            )
            told[:, places] = found[:count].T
        self._take(told)

    def _order(self) -> NDArray[np.intp] | None:
        """Scenarios of one clock in a row, since reads and rounds are kept for one clock; None: as they are."""
        clock = self._inputs.clock
        alike = isinstance(clock.num, int) or isinstance(clock.den, int)
        return None if alike else np.lexsort(np.stack([clock.den, clock.num]))

    def _draws(
        self, most: int, count: int, keys: Callable[[list[int]], Sequence[int | str]]
    ) -> tuple[Ints, Ints | int]:
        """Numbers from 0 to `most` of all seeds, and the place of each scenario's first; none where `most` is 0."""
        if not most:
            return NONE, 0
        return drawn_rows(keys(self._seeds.tolist()), most + 1, count).reshape(-1), self._place * count

    def _take(self, found: Ints) -> None:
        """found: int64[FOUND, scenarios]."""
        for place, name in enumerate(MEASURES):
            worst, least, count = found[3 * place : 3 * place + 3]
            values = self.values[name]
            values.worst = np.where(worst == NO_VALUE, NONE_OF_ALL, worst)
            values.least, values.count = np.where(least == FAR, np.iinfo(np.int64).max, least), count
        columns = (MISSED, NACKED, NACKED_ROUNDS, OVER, DUE, HELD, PHASES, HUNG_AT)
        self.missed, self.nacked, self.nacked_rounds, self.over, self.due, self.held, self.phases, self.hung_at = (
            found[column] for column in columns
        )
        self.refused = found[REFUSED] > 0
