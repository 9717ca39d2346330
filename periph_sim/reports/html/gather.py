"""All that a report says of a case: a run's Result and Values go in, one more run shows the worst occurrences.

case, Result, typical --explain--> timelines, explanations        --> CaseReport
Result, Values --------------------> distributions, limits, facts --^
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

from ...explain.explain import Explained, explain
from ...scene.case.load import load
from ...scene.case.model import Case, Unit
from ...scene.result import SKIPPED, Result
from ...timing.budget_schema import Budget, Condition
from ...timing.format_value import figure, percentile
from ...timing.values import Values
from ...timing.verdicts import Verdict
from .distribution import distribution
from .explanation import explanation
from .lanes import timeline
from .model import BudgetReport, CaseReport, Standing


def case_report(
    case: Case,
    result: Result,
    values: Sequence[Values | None],
    typical: Sequence[Verdict],
    per_second: int,
    length: Fraction | None = None,
    changes: Sequence[str] = (),
    findings: Sequence[str] | None = None,
) -> CaseReport:
    """What the page says of a case that was run for `length` seconds (None: its own duration).

    result, values, typical: of that run; values in the order of its budgets, typical as `Scene.typical` gives it.
    per_second: ticks. changes: "key=value" texts that the case was read with. findings: all that is not as it should
    be, where that was judged: the case passes if there are none. None takes the run's own verdict. Raises what a Scene
    and its run may raise.
    """
    explained = explain(case, result.budgets, typical, length)
    budgets = [
        _budget(case, budget, verdict, kept, explained.get(budget.name), per_second)
        for budget, verdict, kept in zip(case.budget, result.budgets, values, strict=True)
    ]
    return CaseReport(
        name=case.name,
        about=case.about,
        verdict=_verdict(result, findings),
        standing=_standing(case, result, findings),
        fidelity=result.fidelity,
        simulated_s=result.simulated_s,
        wall_s=result.wall_s,
        clocks=tuple((name, f"{float(_sysclk(unit) / 1_000_000):.9g} MHz") for name, unit in case.unit.items()),
        options=tuple(result.unknowns),
        changes=tuple(changes),
        counts={name.replace("_", " "): count for name, count in result.counts.items() if count and name != SKIPPED}
        | {"I2C bytes": result.wire_bytes, "SCI bytes": result.sci_bytes},
        findings=tuple(_found(result) if findings is None else findings),
        notes=tuple(result.notes),
        budgets=tuple(budgets),
    )


def report_of_file(
    path: Path,
    changes: tuple[str, ...],
    result: Result,
    values: Sequence[Values | None],
    typical: Sequence[Verdict],
    per_second: int,
    findings: Sequence[str],
) -> CaseReport:
    """The report of a case file that was run for its own duration; can be called in a process of its own."""
    return case_report(load(path, list(changes)), result, values, typical, per_second, None, changes, findings)


def _verdict(result: Result, findings: Sequence[str] | None) -> str:
    if findings is None:
        return result.verdict
    return "fail" if findings else "pass"


def _standing(case: Case, result: Result, findings: Sequence[str] | None) -> Standing:
    if _verdict(result, findings) == "pass":
        return "good"
    standing = {verdict.name for verdict in result.budgets if not verdict.passed}
    as_said = all(verdict.broken == (verdict.name in case.breaks) for verdict in result.budgets)
    known = findings is None and standing and standing == set(case.breaks) and as_said and not result.stuck
    return "known" if known else "bad"


def _budget(
    case: Case, budget: Budget, verdict: Verdict, values: Values | None, worst: Explained | None, per_second: int
) -> BudgetReport:
    cycles = {name: float(per_second / _sysclk(unit)) for name, unit in case.unit.items()}
    bit = 0
    if case.host is not None:
        bit = round(per_second / (Fraction(case.host.baud) * (1 + case.host.error / 100)))
    return BudgetReport(
        verdict=verdict,
        limits=tuple(_limits(budget, verdict)),
        source=budget.source,
        must_break=verdict.name in case.breaks,
        distribution=None if values is None else distribution(values, per_second // 10**9),
        timeline=None if worst is None else timeline(worst.window, cycles, bit),
        explanation=None if worst is None else explanation(worst.chain),
    )


def _limits(budget: Budget, verdict: Verdict) -> list[tuple[str, str]]:
    """Each limit as the case has it, those of joined conditions with their measures; the nearest one as compared."""
    found = []
    parts: list[Budget | Condition] = [budget, *budget.also]
    for part in parts:
        of = f"{part.measure} " if budget.also else ""
        for key, given in part.limits().items():
            nearest = (part.measure, key) == (verdict.measure, verdict.which)
            text = figure(verdict.limit, verdict.unit) if nearest else f"{given}"
            found.append((f"{of}{percentile(key)}", text))
    return found


def _found(result: Result) -> list[str]:
    found = [f"{verdict.name}: {verdict.found}" for verdict in result.budgets if verdict.found]
    found += [f"first wrong: {result.first_wrong}"] if result.first_wrong else []
    if result.wrong:
        found.append("wrong: " + ", ".join(f"{place} ({times} times)" for place, times in result.wrong.items()))
    return found + [f"stuck: {line}" for line in result.stuck]


def _sysclk(unit: Unit) -> Fraction:
    return Fraction(unit.oscclk) * unit.pll / 2 * (1 + Fraction(unit.ppm) / 10**6)
