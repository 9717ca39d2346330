"""All levels on one scene: what makes the case and the levels go in; a `Trade` of errors and costs comes out."""

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
from ...timing.format_value import duration_text
from .cost import Cost, cost_of
from .errors import Errors, within, worst_of
from .levels import Level
from .observe import Observed, compare, observe

REFUSED = (BadCase, SimulationStuck, NoSuchAddress, FirmwareError)
LONGER = "simulate longer with --seconds"
Make = Callable[[Sequence[str]], Case]


@dataclass(frozen=True)
class Outcome:
    """What came of a level. refused: why it could not be run. errors: empty of the reference."""

    level: Level
    refused: str = ""
    cost: Cost | None = None
    errors: tuple[Errors, ...] = ()

    @property
    def worst(self) -> float:
        """Cycles; infinite if it could not be run."""
        return inf if self.cost is None else worst_of(self.errors)

    def holds(self, cycles: float) -> bool:
        return self.cost is not None and within(self.errors, cycles)


@dataclass(frozen=True)
class Trade:
    """outcomes: the reference first. observables: how many it has, occurrences: of all of them. unmeasured: names of
    those beside them that did not occur; unmeasured_budgets: the case's own measures among these. observed: at the
    reference. cycle_s: a cycle.
    """

    case: str
    simulated_s: float
    duration_s: float
    cycle_s: float
    observables: int
    occurrences: int
    unmeasured: tuple[str, ...]
    unmeasured_budgets: tuple[str, ...]
    observed: Observed
    outcomes: tuple[Outcome, ...]

    @property
    def reference(self) -> Outcome:
        return self.outcomes[0]


def trade(
    make: Make,
    levels: Sequence[Level],
    length: Fraction,
    told: Callable[[float], None] | None = None,
    traced: bool = True,
    remedy: str = LONGER,
) -> Trade:
    """Run all levels for `length` seconds. levels: the reference first. traced: memory, too.

    BadCase and its like where the reference cannot be run, or where nothing occurs in it; remedy: what to do about it.
    """
    first, *others = levels
    case = make(first.changes)
    reference = observe(case, length)
    if not reference.moments:
        part = f"the first {duration_text(float(length))} of {duration_text(float(case.duration))}"
        found = f"no flag, interrupt or byte occurs in {part}"
        raise BadCase(f"case {case.name}: nothing measured: {found}, and errors need occurrences; {remedy}")
    itself = compare(reference, reference)
    unmeasured = tuple(each.name for each in itself if not each.measured)
    with output_muted():
        outcomes = [Outcome(first, "", cost_of(case, length, traced))]
        for number, level in enumerate(others, 1):
            if told is not None:
                told(number / len(levels))
            outcomes.append(_outcome(make, level, reference, length, traced))
    simulated = outcomes[0].cost
    assert simulated is not None
    return Trade(
        case.name,
        simulated.simulated_s,
        float(case.duration),
        reference.cycle / reference.per_second,
        len(itself) - len(unmeasured),
        sum(each.count for each in itself),
        unmeasured,
        tuple(budget.measure for budget in case.budget if budget.measure in unmeasured),
        reference,
        tuple(outcomes),
    )


def _outcome(make: Make, level: Level, reference: Observed, length: Fraction, traced: bool) -> Outcome:
    try:
        case = make(level.changes)
        errors = compare(reference, observe(case, length))
        return Outcome(level, "", cost_of(case, length, traced), tuple(errors))
    except REFUSED as error:
        return Outcome(level, str(error))
