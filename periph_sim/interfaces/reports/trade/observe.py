"""Observation of a run for `periph-sim trade`, and comparison of two observed runs.

The comparison covers the verdicts and the occurrences of budgets, and the data that the controller reads on the I2C
bus.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from math import inf, isinf
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....bus.i2c.transfer import Transfer
from ....records.recording import recording
from ....scene.case.model import Case
from ....scene.plugins import sensors_of
from ....scene.scene import Scene
from ....timing.budget_schema import Budget
from ....timing.verdict import NOT_JUDGED
from ..case_text import can_be_built

SAMPLE = 6  # number of bytes of a sample; a read of this length contains one sample
UNITS = ("s", 1), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)
DIGITS = 13  # number of decimals of a difference, in seconds or LSB; further decimals are rounding errors


@dataclass(frozen=True, eq=False)
class Observed:
    """The results of one run that are compared with another run.

    verdicts: for each budget that this run can measure, its verdict.
    times: for each budget that limits a time, its occurrences in seconds.
    samples: for each chip that the controller reads, its samples: codes as int64[n, 3].
    others: for each I2C address, the bytes of all reads that are no samples.
    """

    verdicts: dict[str, str]
    times: dict[str, NDArray[np.float64]]
    samples: dict[str, NDArray[np.int64]]
    others: dict[str, NDArray[np.int64]]

    @property
    def is_empty(self) -> bool:
        """True if this run has no verdict, occurrence or data that can be compared with another run."""
        occurred = [*self.times.values(), *self.samples.values(), *self.others.values()]
        return not any(map(len, occurred)) and set(self.verdicts.values()) <= {NOT_JUDGED}


@dataclass(frozen=True, order=True)
class Error:
    """The largest of several differences.

    amount: the difference; infinite if the two runs have different numbers of values to compare.
    place: the budget, chip or address with this difference.
    """

    amount: float
    unit: str
    place: str = ""

    @property
    def text(self) -> str:
        """The error as text: `none`, `12.3 us`, `2 LSB`, or `other count` if the numbers of values differ."""
        if not self.amount:
            return "none"
        if isinf(self.amount):
            return "other count"
        if self.unit != "s":
            return f"{self.amount:g} {self.unit}"
        unit, per_second = next(one for one in UNITS if one[1] * self.amount >= 1 or one is UNITS[-1])
        return f"{float(f'{self.amount * per_second:.3g}'):g} {unit}"


@dataclass(frozen=True)
class Errors:
    """The errors of a run in comparison with the reference run.

    judged: the number of budgets that the reference run judges.
    differ: the names of the budgets that the reference run judges, and that have another verdict in the run.
    time: the largest error of an occurrence of a budget that limits a time.
    value: the largest error of the chips' samples in LSB. If all samples are equal, the largest number of bytes in
        which the other reads of an address differ.
    """

    judged: int
    differ: tuple[str, ...]
    time: Error
    value: Error

    @property
    def cells(self) -> tuple[str, str, str]:
        """The cells of a table row: the equal verdicts as `20 of 21`, the error of times and the error of values."""
        return f"{self.judged - len(self.differ)} of {self.judged}", self.time.text, self.value.text


@contextmanager
def built(case: Case, record: str = "", *, keep_values: bool = False) -> Iterator[Scene]:
    """Yield a new scene of the case. At the end of the context, the recording is completed and its file is deleted.

    record: the suffix of the temporary file to which the run is recorded; "" for no recording.
    """
    with TemporaryDirectory() as folder:
        path = Path(folder, f"run{record}") if record else None
        with recording(path, case.recorded_modules) as (subscribe, ended_at):
            scene = Scene(case, subscribe, keep_values=keep_values)
            yield scene
            ended_at(scene.kernel.now, scene.clocks())


def observe(case: Case, length: Fraction, record: str = "") -> Observed:
    """Run a case for `length` seconds. Raise one of the errors in REFUSED if the case cannot be run."""
    order = () if case.controller is None else case.controller.order
    sensors = sensors_of(case, order)
    chips = {sensors[name].address: name for name in order}
    samples: dict[str, list[Sequence[int]]] = {}
    others: dict[str, list[int]] = {}

    def keep(transfer: Transfer) -> None:
        for phase in transfer.phases:
            name = chips.get(phase.address, "")
            if phase.read and name and len(phase.got) == SAMPLE:
                samples.setdefault(name, []).append(sensors[name].values(bytes(phase.got)))
            elif phase.read:
                others.setdefault(f"0x{phase.address:02x}", []).extend(phase.got)

    with built(_measurable(case), record, keep_values=True) as scene:
        scene.on_transfer(keep)
        result = scene.run(length)
    kept = {limit.budget.name: limit.measure.kept for limit in scene.limits if limit.measure.unit == "time"}
    return Observed(
        {verdict.name: verdict.verdict for verdict in result.budgets},
        {name: values[0] / scene.timebase.per_second for name, values in kept.items() if values is not None},
        {name: np.array(codes, np.int64) for name, codes in samples.items()},
        {name: np.array(data, np.int64) for name, data in others.items()},
    )


def compare(reference: Observed, run: Observed) -> Errors:
    """Compare a run with the reference.

    The n-th occurrence of each budget, the n-th sample of each chip and the n-th byte from each other address are
    compared with the n-th occurrence, sample and byte of the reference.
    """
    judged = {name: verdict for name, verdict in reference.verdicts.items() if verdict != NOT_JUDGED}
    differ = tuple(name for name, verdict in judged.items() if run.verdicts.get(name) != verdict)
    measured = {name: times for name, times in reference.times.items() if name in run.times}
    value = _largest(reference.samples, run.samples, "LSB", _distance)
    if not value.amount:
        value = _largest(
            reference.others, run.others, "bytes", lambda one, other: float(np.count_nonzero(one != other))
        )
    return Errors(len(judged), differ, _largest(measured, run.times, "s", _distance), value)


def _distance(one: NDArray[Any], other: NDArray[Any]) -> float:
    return round(float(np.abs(one - other).max(initial=0)), DIGITS)


def _largest(
    reference: Mapping[str, NDArray[Any]],
    run: Mapping[str, NDArray[Any]],
    unit: str,
    distance: Callable[[NDArray[Any], NDArray[Any]], float],
) -> Error:
    errors = [
        Error(distance(one, run[name]) if len(run.get(name, ())) == len(one) else inf, unit, name)
        for name, one in reference.items()
    ]
    return max((error for error in errors if error.amount), default=Error(0.0, unit))


def _measurable(case: Case) -> Case:
    """Return the case without the budgets that its units cannot measure.

    If a row takes its units from another case, budgets about the original firmware may not fit these units.
    """

    def with_budgets(*budgets: Budget) -> Case:
        return case.model_copy(update={"budget": budgets, "breaks": ()})

    if can_be_built(lambda: case):
        return case
    return with_budgets(*(budget for budget in case.budget if can_be_built(with_budgets, budget)))
