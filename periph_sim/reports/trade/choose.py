"""The cheapest level within a bound: a `Trade` and seconds go in; a level, or why there is none, comes out.

Cheapest is what takes the fewest events: CPU time differs from run to run, and the choice must not.
"""

from __future__ import annotations

from dataclasses import dataclass

from ...core.text_table import paragraph
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


def best_within(found: Trade, bound_s: float) -> Best:
    """The cheapest level whose times are off by no more, and which is exact in all that is no time."""
    bound = f"{bound_s * 1e6:g} us"
    cycles = bound_s / found.cycle_s
    if not found.moments:
        return Best(None, bound_s, f"nothing happened in {found.simulated_s:g} s, so no error is known")
    others = found.outcomes[1:]
    if not others:
        return Best(None, bound_s, f"there is no level beside {found.reference.level.name} to choose from")
    fitting = [outcome for outcome in found.outcomes if outcome.holds(cycles)]
    best = min(fitting, key=_events)
    if best is found.reference:
        told = "; ".join(_reason(outcome, cycles, found) for outcome in others)
        return Best(best.level, bound_s, f"within {bound}: {best.level.name} alone is to be had: {told}")
    against = f"{_events(best)} events against {_events(found.reference)} of {found.reference.level.name}"
    worst = "all observables exact" if not best.worst else f"worst error {number(best.worst)} of {cycles:g} cycles"
    return Best(best.level, bound_s, f"within {bound}: {best.level.name} is the cheapest, {against}; {worst}")


def _events(outcome: Outcome) -> int:
    assert outcome.cost is not None
    return outcome.cost.events


def _reason(outcome: Outcome, cycles: float, found: Trade) -> str:
    """Why a level was not taken."""
    name = outcome.level.name
    if outcome.cost is None:
        return f"{name} was refused"
    if outcome.holds(cycles):
        return f"{name} takes {_events(outcome)} events, no fewer than {_events(found.reference)}"
    worst = max(outcome.errors, key=lambda each: (each.worst > 0, each.worst))
    if outcome.worst <= cycles:
        worst = next(each for each in outcome.errors if not each.exact and each.unit != "cycles")
    how = "infinitely" if number(worst.worst) == INFINITE else f"by {number(worst.worst)} {worst.unit}"
    return f"{name} is off {how} ({worst.name})"
