"""Thousands of scenarios of one case in a call: a case and arrays go in; arrays of what each came to come out.

schedule(case, {"host.first": [...], "seed": [...]}, rounds=50) --> ScheduleResult
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from numpy.typing import ArrayLike

from ... import form
from ...scene.case.load import load
from ...scene.case.model import Case
from .inputs import inputs_of
from .result import ScheduleResult
from .rounds import Rounds
from .scenarios import Scenarios, fits
from .structure import Structure, structure_of


def schedule(
    case: Case | str | Path | Structure, changes: Mapping[str, ArrayLike] | None = None, *, rounds: int = 50
) -> ScheduleResult:
    """What the case's run comes to in each scenario, over so many rounds; it ends a tick before the next one is due.

    changes: by name, one value for all scenarios or an array of shape (scenarios,). "seed": whole numbers.
    "host.first", "host.period", "controller.first", "controller.period" and "unit.NAME.settings.model_cost": whole
    nanoseconds. "host.ppm", "unit.NAME.ppm": numbers. case: a Case, a file, or what `structure_of` gave of it.

    BadSchedule, one sentence, for a case whose structure the level does not know, and for a change it cannot make.
    """
    if isinstance(case, str | Path):
        case = load(Path(case))
    structure = case if isinstance(case, Structure) else structure_of(case)
    inputs = inputs_of(structure, changes or {}, rounds)
    quick = form.running == form.COMPILED and fits(structure.terms)
    of = Scenarios(structure, inputs) if quick else Rounds(structure, inputs)
    of.run()
    return ScheduleResult(
        structure.case.name,
        inputs.scenarios,
        rounds,
        structure.per_second,
        of.observables(),
        of.hung_at,
        of.refused,
        inputs.end,
    )
