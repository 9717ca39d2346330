"""The figures of a sweep as arrays: one column per figure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....timing.verdict import Verdict
from .one_run import Row

Column = NDArray[Any]
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class BudgetColumns:
    """A budget's figures, one entry per run, as in a `Verdict`. If a run has none: NaN, "", and -1 for the count.

    unit: of worst, limit and margin: "us", "%", "LSB", or what is counted. verdict: "pass", "broken", "not judged".
    """

    measure: str
    unit: str
    worst: Floats
    limit: Floats
    margin: Floats
    at_s: Floats
    count: NDArray[np.int64]
    verdict: NDArray[np.str_]


@dataclass(frozen=True)
class Sweep:
    """The result of a sweep: arrays with one entry per run, in the order of the changes.

    changes: by key, the value set in each run; "" if unchanged. verdict: "pass", "fail", "not judged", or
    "error" if a run failed, with the reason in `error`.
    wire_bytes: on the I2C bus. sci_bytes: sent to SCIs of units; sci_bytes_sent: sent by them.
    budgets: by name. counts: by name, -1 in runs without it.
    """

    case: str
    changes: Mapping[str, Column]
    verdict: NDArray[np.str_]
    error: NDArray[np.str_]
    simulated_s: Floats
    wire_bytes: NDArray[np.int64]
    sci_bytes: NDArray[np.int64]
    sci_bytes_sent: NDArray[np.int64]
    events: NDArray[np.int64]
    budgets: Mapping[str, BudgetColumns]
    counts: Mapping[str, NDArray[np.int64]]

    def __len__(self) -> int:
        return len(self.verdict)

    @property
    def worst(self) -> dict[str, Floats]:
        """The worst value of each budget, by its name."""
        return {name: budget.worst for name, budget in self.budgets.items()}

    def columns(self) -> dict[str, Column]:
        """Return one table by column name, for example for pandas.DataFrame or a CSV file."""
        table: dict[str, Column] = {**self.changes, "verdict": self.verdict, "error": self.error}
        for name, budget in self.budgets.items():
            figures = {one.name: getattr(budget, one.name) for one in fields(budget)[2:]}
            table |= {f"{name}: {figure}": column for figure, column in figures.items()}
        table |= {"I2C bytes": self.wire_bytes, "SCI bytes": self.sci_bytes}
        table["SCI bytes from units"] = self.sci_bytes_sent
        return table | dict(self.counts)


def sweep_of(case: str, runs: Sequence[Mapping[str, object]], rows: Sequence[Row]) -> Sweep:
    """Build the columns from the rows of these runs."""
    keys = dict.fromkeys(key for run in runs for key in run)
    names = dict.fromkeys(verdict.name for row in rows for verdict in row.budgets)
    counts = dict.fromkeys(name for row in rows for name in row.counts)
    by_name = [{verdict.name: verdict for verdict in row.budgets} for row in rows]
    return Sweep(
        case=case,
        changes={key: _values([run.get(key, "") for run in runs]) for key in keys},
        verdict=_texts(row.verdict for row in rows),
        error=_texts(row.error for row in rows),
        simulated_s=np.array([row.simulated_s for row in rows], dtype=np.float64),
        wire_bytes=_whole(row.wire_bytes for row in rows),
        sci_bytes=_whole(row.sci_bytes for row in rows),
        sci_bytes_sent=_whole(row.sci_bytes_sent for row in rows),
        events=_whole(row.events for row in rows),
        budgets={name: _budget([verdicts.get(name) for verdicts in by_name]) for name in names},
        counts={name: _whole(row.counts.get(name, -1) for row in rows) for name in counts},
    )


def _budget(verdicts: Sequence[Verdict | None]) -> BudgetColumns:
    first = next(verdict for verdict in verdicts if verdict is not None)

    def figures(of: Callable[[Verdict], float | int | None]) -> Floats:
        found = [None if verdict is None else of(verdict) for verdict in verdicts]
        return np.array([np.nan if value is None else value for value in found], dtype=np.float64)

    return BudgetColumns(
        measure=first.measure,
        unit=first.unit,
        worst=figures(lambda verdict: verdict.worst),
        limit=figures(lambda verdict: verdict.limit),
        margin=figures(lambda verdict: verdict.margin),
        at_s=figures(lambda verdict: verdict.at_s),
        count=_whole(-1 if verdict is None else verdict.count for verdict in verdicts),
        verdict=_texts("" if verdict is None else _word(verdict) for verdict in verdicts),
    )


def _word(verdict: Verdict) -> str:
    return verdict.verdict if verdict.passed else verdict.word


def _texts(values: Any) -> NDArray[np.str_]:
    return np.array(list(values), dtype=np.str_)


def _whole(values: Any) -> NDArray[np.int64]:
    return np.array(list(values), dtype=np.int64)


def _values(values: list[object]) -> Column:
    """Return numbers if all values are numbers, else texts."""
    plain = [value.item() if hasattr(value, "item") else value for value in values]
    kinds = {type(value) for value in plain}
    if kinds <= {int, float} or kinds == {bool}:
        return np.array(plain)
    return _texts(str(value) for value in plain)
