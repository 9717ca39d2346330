"""Observation of one run: the instants of everything that happened, and the values of all measures.

    case + budgets on OBSERVED --> scene --> moments by label, data by place, values by measure

Measures that the case does not name are taken besides, as far as its scene can have them. Moments count from the run's
begin, in ticks.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ...core.records import Recorder
from ...core.time import Timebase
from ...processor.user_code import output_muted
from ...scene.case.model import BadCase, Case
from ...scene.scene import Scene
from ...timing.budget_schema import Budget
from ...timing.budgets import BudgetJudge
from ...timing.measures.measure import MILLIONTHS, Measure
from .errors import CYCLES, Errors, errors_of
from .moments import Ints, Label, Met, MomentListener
from .pairing import Paired, pair, pair_moments

OBSERVED: dict[str, str | int] = {  # beside a case's own budgets; with a limit, as every budget must have one
    "response": "1 s",
    "stretch": "1 s",
    "round": "1 s",
    "slack": "1 s",
    "age": "1 s",
    "margin of I2CDXR": "1 s",
    "value error": "1 LSB",
    "missed rounds": 0,
    "nacked": 0,
    "wrong bytes": 0,
    "lost flags": 0,
    "overruns": 0,
}
DIFFER = "differ"
NOMINAL = 150_000_000  # SYSCLKOUT in Hz, where a scene has no unit


@dataclass(frozen=True, eq=False)
class Observed:
    """Result of a run. values: by measure, its unit and int64[n] in their order. cycle: ticks of a SYSCLKOUT cycle of
    the case's first unit. per_second: ticks. met: the sorts of records that there were.
    """

    moments: dict[Label, Ints]
    data: dict[str, Ints]
    values: dict[str, tuple[str, Ints]]
    cycle: float
    per_second: int
    met: Met


def observe(case: Case, length: Fraction) -> Observed:
    """Run `case` for `length` seconds, recorded. BadCase and its like where it cannot be run."""
    watched = case.model_copy(update={"budget": (*case.budget, *_more(case)), "breaks": ()})
    listener = MomentListener()

    def subscribe(recorder: Recorder, timebase: Timebase) -> None:
        listener.subscribe(recorder)

    scene = Scene(watched, subscribe, keep_values=True)
    scene.run(length)
    values = _values(scene.limits)
    moments = {label: at - scene.start for label, at in listener.moments().items()}
    return Observed(
        moments, listener.data(), values, float(_cycle(case, scene.timebase)), scene.timebase.per_second, listener.met()
    )


def _values(limits: Iterable[BudgetJudge]) -> dict[str, tuple[str, Ints]]:
    found: dict[str, tuple[str, Ints]] = {}
    for limit in limits:
        found.setdefault(limit.budget.measure, (limit.measure.unit, _taken(limit.measure)))
    return found


def _more(case: Case) -> Iterator[Budget]:
    """Budgets on what the case does not measure and its scene can have."""
    known = {budget.measure for budget in case.budget}
    for measure, limit in OBSERVED.items():
        if measure not in known:
            budget = Budget.model_validate({"name": f"{measure} observed", "measure": measure, "max": limit})
            try:
                with output_muted():
                    Scene(case.model_copy(update={"budget": (budget,), "breaks": ()}))
            except BadCase:
                continue
            yield budget


def _taken(measure: Measure) -> Ints:
    """All values of a series; of what is one number a run, that; empty if nothing was there to be measured."""
    if measure.series and measure.kept is not None:
        return measure.kept[0]
    nothing = measure.silent or (measure.occasions is not None and not measure.measured)
    return np.array([] if nothing else [measure.worst], np.int64)


def _cycle(case: Case, timebase: Timebase) -> Fraction:
    hertz = next((unit.oscclk * unit.pll / 2 for unit in case.unit.values()), Fraction(NOMINAL))
    return timebase.per_second / hertz


def compare(reference: Observed, level: Observed) -> list[Errors]:
    """Return the error of every observable of either run: measures, then data, then occurrences by place."""
    cycle, nothing = reference.cycle, np.empty(0, np.int64)
    found: list[Errors] = []
    for name in _both(reference.values, level.values):
        unit, before = reference.values.get(name, (level.values.get(name, ("", nothing))[0], nothing))
        after = level.values.get(name, ("", nothing))[1]
        told, scale = _units(unit, cycle)
        found.append(errors_of(name, told, [pair(before, after)], scale))
    for place in _both(reference.data, level.data):
        paired = pair(reference.data.get(place, nothing), level.data.get(place, nothing))
        unlike = Paired((paired.differences != 0).astype(np.int64), paired.unpaired)
        found.append(errors_of(place, DIFFER, [unlike]))
    moments = pair_moments(reference.moments, level.moments)
    shown: dict[str, list[Paired]] = {}
    counted = {(label.stream, label.what) for label in moments if label.value > 1}
    for label, paired in moments.items():
        shown.setdefault(_name(label, (label.stream, label.what) in counted), []).append(paired)
    found += [errors_of(name, CYCLES, pairs, cycle) for name, pairs in sorted(shown.items())]
    return found


def _both(first: Mapping[str, object], second: Mapping[str, object]) -> list[str]:
    return list(dict.fromkeys([*first, *second]))


def _units(unit: str, cycle: float) -> tuple[str, float]:
    """Return the unit in which an error is shown, and how many differences make one of it."""
    if unit == "time":
        return CYCLES, cycle
    if unit == "%":
        return unit, MILLIONTHS / 100
    return unit, MILLIONTHS if unit == "LSB" else 1.0


def _name(label: Label, counted: bool) -> str:
    """A row: all values of a number, but setting and clearing of a flag apart."""
    place, _, kind = label.stream.rpartition(" ")
    if kind != "flag":
        return f"{place} {label.what}"
    name = f"{place}.{label.what}"
    return name if counted else f"{name} {'set' if label.value else 'clear'}"
