"""The cheapest level within a bound: a `Trade` and seconds go in; a level, or why there is none, comes out.

Cheapest is what takes the fewest events, over the whole run: CPU time differs from run to run, and the choice must not.
A level whose records may differ from those of edge is not chosen where a budget is unmeasured in the first part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...core.text_table import paragraph
from ...timing.format_value import duration_text
from .errors import worst_of
from .levels import Level
from .text_report import INFINITE, number
from .trade import Outcome, Trade


@dataclass(frozen=True)
class Best:
    """level: None if none is within the bound. why: a sentence."""

    level: Level | None
    bound_s: float
    why: str

    def text(self) -> str:
        return "\n".join(paragraph(self.why))

    def as_json(self) -> dict[str, object]:
        return {"bound_s": self.bound_s, "level": None if self.level is None else self.level.name, "why": self.why}


def best_within(found: Trade, bound_s: float, whole_s: float | None = None) -> Best:
    """The cheapest level whose times are off by no more, and which is exact in all that is no time.

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
    best = min(fitting, key=_events)
    if best is found.reference:
        told = "; ".join(_reason(outcome, cycles, found, unknown) for outcome in others)
        return Best(best.level, bound_s, f"within {bound}: {best.level.name} alone is to be had: {told}")
    assert found.reference.cost is not None
    against = f"{_events(best)} events against {found.reference.cost.events} of {found.reference.level.name}"
    off = worst_of(best.errors)
    worst = "all observables exact" if not off else f"worst error {number(off)} of {cycles:g} cycles"
    return Best(best.level, bound_s, f"within {bound}: {best.level.name} is the cheapest, {against}; {worst}")


def _events(outcome: Outcome) -> int:
    assert outcome.cost is not None
    return outcome.cost.events


def _reason(outcome: Outcome, cycles: float, found: Trade, unknown: Sequence[str]) -> str:
    """Why a level was not taken. unknown: measures of budgets that did not occur in the first part."""
    name = outcome.level.name
    if outcome.cost is None:
        return f"{name} was refused"
    if outcome.holds(cycles) and unknown and not outcome.level.same_records:
        return f"{name} has no known error in {', '.join(unknown)}, unmeasured in {duration_text(found.simulated_s)}"
    if outcome.holds(cycles):
        assert found.reference.cost is not None
        return f"{name} takes {_events(outcome)} events, no fewer than {found.reference.cost.events}"
    worst = max(outcome.errors, key=lambda each: (each.worst > 0, each.worst))
    if worst_of(outcome.errors) <= cycles:
        worst = next(each for each in outcome.errors if each.worst and each.unit != "cycles")
    how = "infinitely" if number(worst.worst) == INFINITE else f"by {number(worst.worst)} {worst.unit}"
    return f"{name} is off {how} ({worst.name})"
