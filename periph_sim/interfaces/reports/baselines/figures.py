"""The figures of a case that a baseline keeps: exact integers, so two runs can be compared for equality.

    a run's measures --> Baseline <--> timing/baselines/NAME.json

Times are ticks; `ticks_per_cycle` of them are one cycle of SYSCLKOUT (of the case's first
unit). Instants are counted from the begin of the run.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Literal

from ....core.table import Table

SCHEMA: Literal[1] = 1  # version of the file format; other versions are refused


class Figures(Table, frozen=True, kw_only=True):
    """Figures of one budget. unit: "time" (ticks) or what is counted. None: not measured, or no instant.

    chain: the worst occurrence, one event per line: "TICKS EVENT", TICKS from its begin (see `chain`).
    """

    measure: str
    unit: str
    count: int
    worst: int | None
    worst_at: int | None
    least: int | None
    least_at: int | None
    chain_of: Literal["worst", "least"]
    chain: list[str]


class Baseline(Table, frozen=True, kw_only=True):
    """The baseline of one case. counts: all other counts of a run.

    digest: of the times of all chain events (see `event_digest`); "" in files of an earlier version.
    bus_bytes: digests of the values of all bytes on the I2C bus (see `bus_bytes`); none in files of an earlier version.
    """

    schema_version: Literal[1] = SCHEMA
    case: str
    simulated: int
    ticks_per_second: int
    ticks_per_cycle: int
    events: int
    counts: dict[str, int]
    budgets: dict[str, Figures]
    digest: str = ""
    bus_bytes: list[str] = []

    def with_chains(self, lines: Mapping[str, list[str]]) -> Baseline:
        """Return the same figures with these chains, by budget."""
        budgets = {n: f.model_copy(update={"chain": lines.get(n, f.chain)}) for n, f in self.budgets.items()}
        return self.model_copy(update={"budgets": budgets})

    def chains_of(self, other: Baseline) -> dict[str, list[str]] | None:
        """Return the other's chains if this run's must equal them: equal figures, and equal times of all events.

        Return None if a run is needed to find the chains.
        """
        chains = {name: one.chain for name, one in other.budgets.items()}
        same = self.digest and self.digest == other.digest and self.with_chains(chains).budgets == other.budgets
        return chains if same else None

    def cycles(self, ticks: int) -> str:
        """Format ticks as cycles: exact if whole, else rounded to hundredths."""
        value = Fraction(ticks, self.ticks_per_cycle)
        return f"{value.numerator}" if value.denominator == 1 else f"{float(value):.2f}"
