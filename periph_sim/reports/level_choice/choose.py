"""The cheapest level within a bound, or the reason why there is none.

The cheapest level is the one with the fewest events: CPU time differs from run to run, and the choice must not.
A level whose records may differ from those of edge is not chosen where a budget is unmeasured in the first part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...timing.format_value import duration_text
from .compared import Comparison, Outcome
from .errors import INFINITE, number, worst_of
from .levels import Level


@dataclass(frozen=True)
class Best:
    """level: None if none is within the bound. why: a sentence."""

    level: Level | None
    bound_s: float
    why: str

    def as_json(self) -> dict[str, object]:
        return {"bound_s": self.bound_s, "level": None if self.level is None else self.level.name, "why": self.why}


def best_within(found: Comparison, bound_s: float, whole_s: float | None = None) -> Best:
    """Return the cheapest level whose times are off by no more, and which is exact in everything else.

    whole_s: of the run that it is chosen for; the case's own length if None.
    """
    whole = found.duration_s if whole_s is None else whole_s
    bound = f"{bound_s * 1e6:g} us"
    cycles = bound_s / found.cycle_s
    others = found.outcomes[1:]
    if not others:
        return Best(None, bound_s, f"there is no level beside {found.reference.level.name} to choose from")
    unknown = found.unmeasured_budgets if whole > found.simulated_s else ()
    fitting = [each for each in found.outcomes if each.holds(cycles) and (each.level.same_records or not unknown)]
    best = min(fitting, key=lambda outcome: outcome.events)
    if best is found.reference:
        reasons = "; ".join(_reason(outcome, cycles, found, unknown) for outcome in others)
        return Best(best.level, bound_s, f"within {bound}: {best.level.name} alone is to be had: {reasons}")
    against = f"{best.events} events against {found.reference.events} of {found.reference.level.name}"
    off = worst_of(best.errors)
    worst = "all observables exact" if not off else f"worst error {number(off)} of {cycles:g} cycles"
    return Best(best.level, bound_s, f"within {bound}: {best.level.name} is the cheapest, {against}; {worst}")


def _reason(outcome: Outcome, cycles: float, found: Comparison, unknown: Sequence[str]) -> str:
    """Return the reason against a level. unknown: measures of budgets that did not occur in the first part."""
    name = outcome.level.name
    if outcome.refused:
        return f"{name} was refused"
    if outcome.holds(cycles) and unknown and not outcome.level.same_records:
        return f"{name} has no known error in {', '.join(unknown)}, unmeasured in {duration_text(found.simulated_s)}"
    if outcome.holds(cycles):
        return f"{name} takes {outcome.events} events, no fewer than {found.reference.events}"
    worst = max(outcome.errors, key=lambda each: (each.worst > 0, each.worst))
    if worst_of(outcome.errors) <= cycles:
        worst = next(each for each in outcome.errors if each.worst and each.unit != "cycles")
    how = "infinitely" if number(worst.worst) == INFINITE else f"by {number(worst.worst)} {worst.unit}"
    return f"{name} is off {how} ({worst.name})"
