"""What scenarios came to: observables by name, each with arrays of worst and least values and counts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .clock import Ints
from .extremes import NO_VALUE, Extremes

Observables = dict[str, "Observable"]


@dataclass(frozen=True)
class Observable:
    """Arrays of shape (scenarios,). unit: "ticks" or "count". worst, least: where `count` is 0, 0.

    A counter is its `worst`, and `least` is the same.
    """

    name: str
    unit: str
    worst: Ints
    least: Ints
    count: Ints

    @staticmethod
    def of(name: str, values: Extremes) -> Observable:
        none = values.worst == NO_VALUE
        worst, least = (np.where(none, 0, part) for part in (values.worst, values.least))
        return Observable(name, "ticks", worst, least, values.count)

    @staticmethod
    def counter(name: str, counted: Ints, of: Ints) -> Observable:
        """of: at how many occasions it was counted."""
        return Observable(name, "count", counted, counted, of)


@dataclass(frozen=True)
class ScheduleResult(Mapping[str, Observable]):
    """Observables by their measures' names. hung_at: the tick from which on SCL is held for ever; -1 where it is not.

    refused: scenarios whose values mean nothing, since there the module answers for firmware that is still elsewhere
    (the models outlast the requests of a whole round); a run at level "edge" tells what they come to.
    ticks_per_second: what a tick is. end: the tick at which each run ends. Ticks count from its begin.
    """

    case: str
    scenarios: int
    rounds: int
    ticks_per_second: int
    observables: Observables
    hung_at: Ints
    refused: NDArray[np.bool_]
    end: Ints

    def __getitem__(self, name: str) -> Observable:
        return self.observables[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.observables)

    def __len__(self) -> int:
        return len(self.observables)

    @property
    def hung(self) -> NDArray[np.bool_]:
        """Scenarios in which the firmware waits for ever."""
        return self.hung_at >= 0

    def seconds(self, ticks: Ints) -> NDArray[np.float64]:
        """Ticks in seconds, for people and plots."""
        return ticks / self.ticks_per_second
