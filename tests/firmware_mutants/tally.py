"""Count trials: mutants that break a budget, end the run, change a figure, are argued to have no effect, or survive."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from .argued import argument_of
from .survivors import KNOWN
from .trials import BROKEN, ENDED, MOVED, MOVED_IN_TIME, Trial

ENOUGH = 95  # percent
ARGUED, SURVIVED = "argued", "survived"
WAYS = (BROKEN, ENDED, MOVED, MOVED_IN_TIME, ARGUED, SURVIVED)


class Tally:
    """The counts of some trials.

    refuted: mutants that are argued to have no effect, but caught.
    unknown: survivors that are not listed in survivors.py.
    """

    def __init__(self, trials: Sequence[Trial]) -> None:
        self.ways = Counter(way(trial) for trial in trials)
        self.survivors = [trial for trial in trials if way(trial) == SURVIVED]
        self.unknown = [trial for trial in self.survivors if trial.mutant.text not in KNOWN]
        self.refuted = [trial for trial in trials if trial.how and argument_of(trial.mutant)]
        self.total = len(trials)

    @property
    def holds(self) -> bool:
        """True if enough mutants are caught, no argument is refuted, and all survivors are known."""
        return self.share >= ENOUGH and not self.refuted and not self.unknown

    @property
    def share(self) -> float:
        """Percentage of caught mutants among those that are not argued to have no effect."""
        counted = self.total - self.ways[ARGUED]
        return 100 * (counted - self.ways[SURVIVED]) / counted if counted else 100.0

    def __str__(self) -> str:
        counts = ", ".join(f"{self.ways[each]} {each}" for each in WAYS)
        return f"{self.total} mutants: {counts}; {self.share:.1f} % of those not argued are caught"


def way(trial: Trial) -> str:
    """Return one of WAYS."""
    return trial.how or (ARGUED if argument_of(trial.mutant) else SURVIVED)
