"""One scene run at several levels: the errors of each against the first, and the events that it takes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf

from ...core.kernel import SimulationStuck
from ...f28335.system.memory_map import NoSuchAddress
from ...processor.error_origin import FirmwareError
from ...processor.user_code import output_muted
from ...scene.case.model import BadCase, Case
from ...scene.scene import Scene
from ...timing.format_value import duration_text
from .errors import Errors, within, worst_of
from .levels import Level
from .observe import Observed, compare, observe

REFUSED = (BadCase, SimulationStuck, NoSuchAddress, FirmwareError)
LONGER = "simulate longer with --seconds"
Make = Callable[[Sequence[str]], Case]


@dataclass(frozen=True)
class Outcome:
    """Result of a level. refused: why it could not be run. events: of its run without records. errors: empty for the
    reference.
    """

    level: Level
    refused: str = ""
    events: int = 0
    errors: tuple[Errors, ...] = ()

    @property
    def worst(self) -> float:
        """Cycles; infinite if it could not be run."""
        return inf if self.refused else worst_of(self.errors)

    def holds(self, cycles: float) -> bool:
        return not self.refused and within(self.errors, cycles)


@dataclass(frozen=True)
class Comparison:
    """Outcomes of all levels, the reference first.

    unmeasured_budgets: measures of the case's budgets that did not occur. observed: the run at the reference.
    cycle_s: a cycle of SYSCLKOUT.
    """

    case: str
    simulated_s: float
    duration_s: float
    cycle_s: float
    unmeasured_budgets: tuple[str, ...]
    observed: Observed
    outcomes: tuple[Outcome, ...]

    @property
    def reference(self) -> Outcome:
        return self.outcomes[0]


def compare_levels(make: Make, levels: Sequence[Level], length: Fraction, remedy: str = LONGER) -> Comparison:
    """Run all levels for `length` seconds. levels: the reference first.

    BadCase and its like where the reference cannot be run, or where nothing occurs in it; remedy: the advice for that.
    """
    first, *others = levels
    case = make(first.changes)
    reference = observe(case, length)
    if not reference.moments:
        part = f"the first {duration_text(float(length))} of {duration_text(float(case.duration))}"
        found = f"no flag, interrupt or byte occurs in {part}"
        raise BadCase(f"case {case.name}: nothing measured: {found}, and errors need occurrences; {remedy}")
    unmeasured = {each.name for each in compare(reference, reference) if not each.measured}
    with output_muted():
        result = Scene(case).run(length)
        outcomes = [Outcome(first, "", result.events)]
        outcomes += [_outcome(make, level, reference, length) for level in others]
    return Comparison(
        case.name,
        result.simulated_s,
        float(case.duration),
        reference.cycle / reference.per_second,
        tuple(budget.measure for budget in case.budget if budget.measure in unmeasured),
        reference,
        tuple(outcomes),
    )


def _outcome(make: Make, level: Level, reference: Observed, length: Fraction) -> Outcome:
    try:
        case = make(level.changes)
        errors = compare(reference, observe(case, length))
        return Outcome(level, "", Scene(case).run(length).events, tuple(errors))
    except REFUSED as error:
        return Outcome(level, str(error))
