"""What scenarios came to, counted: worst and least values and counts of each go in, observables come out."""

from __future__ import annotations

import numpy as np

from .extremes import Extremes
from .inputs import Inputs
from .result import Observable, Observables
from .structure import Structure

MEASURES = ("response", "round", "slack", "age", "margin of I2CDXR", "span:model", "asked", "SDIR rises")


class Tally:
    """Of all scenarios of a call: `values` by measure; held: the longest stretch; phases: that were acknowledged; over,
    due, missed, nacked_rounds: rounds; nacked: requests. hung_at, refused: as those of a `ScheduleResult`.
    """

    def __init__(self, structure: Structure, inputs: Inputs) -> None:
        self._structure, self._inputs = structure, inputs
        count = inputs.scenarios
        self.values = {name: Extremes(count) for name in MEASURES}
        self.held, self.phases = np.zeros(count, np.int64), np.zeros(count, np.int64)
        self.missed, self.nacked, self.nacked_rounds = (np.zeros(count, np.int64) for _ in range(3))
        self.over, self.due = np.zeros(count, np.int64), np.zeros(count, np.int64)
        self.hung_at = np.full(count, -1, np.int64)
        self.refused = np.zeros(count, np.bool_)

    def observables(self) -> Observables:
        found = {name: Observable.of(name, values) for name, values in self.values.items()}
        found["stretch"] = Observable("stretch", "ticks", self.held, np.zeros_like(self.held), self.phases)
        found["missed rounds"] = Observable.counter("missed rounds", self.missed, self.due)
        found["nacked rounds"] = Observable.counter("nacked rounds", self.nacked_rounds, self.over)
        chips = len(self._structure.terms.names)
        found["nacked"] = Observable.counter("nacked", self.nacked, self.due * chips)
        return found
