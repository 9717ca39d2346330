"""A report of calculated worst cases as text and as JSON: each beside the value seen, then its sum term by term."""

from __future__ import annotations

from fractions import Fraction

from ...core.text_table import columns, paragraph, text_table
from ...timing.format_value import figure, percentile, simulated
from .compare_with_run import BoundWithRun, Report
from .terms import Bound, Term, total

ASSUMED = ("rates as received", "no frame left out", "no other interrupt", "no dependence on data")
MEASURED = (
    "Code and service routines are straight-line code, measured undisturbed (the case without its host, the case "
    "without requests); all else comes from the case."
)


def text(report: Report) -> str:
    lines = [f"{report.case}: {_verdict(report)}", f"assumes {', '.join(ASSUMED)}"]
    if report.beside:
        head = ("measure", "calculated", "seen", "ratio", "values")
        lines += ["", *text_table(head, [_row(report, each) for each in report.beside], range(1, 5))]
    if report.limits:
        lines += ["", *_limits(report)]
    for each in report.beside:
        lines += ["", *_sum(report, each.bound)]
        if each.bound.name == "margin":
            lines += paragraph(_held_from(report.held_from), "  ", "    ")
    lines += ["", "time left before the deadlines that the calculation needs:"]
    alike: dict[tuple[Term, ...], list[str]] = {}
    for deadline in report.deadlines:
        alike.setdefault(deadline.terms, []).append(deadline.name)
    for terms, names in alike.items():
        lines += ["", *paragraph(f"{', '.join(names)}: {_us(report, total(terms))} us"), *_terms(report, terms)]
    if report.handlers.terms:
        lines += ["", f"one interrupt: {_us(report, report.handlers.cost)} us", *_terms(report, report.handlers.terms)]
    return "\n".join([*lines, "", *paragraph(MEASURED)])


def _verdict(report: Report) -> str:
    if report.missed:
        names = "; ".join(f"{d.name} up to {report.timebase.show(-d.ticks)} too soon" for d in report.missed)
        return f"nothing calculated: {names}"
    broken = [each.bound.name for each in report.beside if each.seen is not None and not each.holds]
    unseen = [each.bound.name for each in report.beside if each.seen is None]
    said = [f"{' and '.join(broken)} seen beyond the calculated value"] * bool(broken)
    said += [f"of {' and '.join(unseen)} nothing was seen, so nothing is compared"] * bool(unseen)
    said += [
        f"{limit.budget} may break its limit, by {_amount(report, -(limit.spare or 0))}" for limit in report.beyond
    ]
    if report.unproven:
        unbounded = ", ".join(dict.fromkeys(each.budget for each in report.unproven))
        said.append(f"{unbounded} not calculated: {'; '.join(dict.fromkeys(u.reason for u in report.unproven))}")
    said += report.hung
    if not said:
        bounded = any(limit.bound is not None for limit in report.limits)
        said.append("calculated values are within their limits" if bounded else "no budget limits what is calculated")
    return f"{'; '.join(said)}; {simulated(report.simulated_s)} simulated to compare"


def _amount(report: Report, ticks: int) -> str:
    return figure(ticks * 1_000_000 / report.timebase.per_second, "us")


def _limits(report: Report) -> list[str]:
    """A row for each limit of the case whose measure is calculated, and a line for those that are not."""
    rows: list[tuple[str, ...]] = []
    for each in report.limits:
        if each.bound is not None:
            of, values = each.bound, (each.limit, each.bound.ticks, each.spare or 0)
            limit, bound, spare = (str(value) if of.counted else _amount(report, value) for value in values)
            key = f"{percentile(each.key)} "
            rows.append((each.budget, key + limit, bound, spare, "may break" if each.beyond else "holds"))
    lines = text_table(("budget", "limit", "calculated", "spare", ""), rows, range(1, 4)) if rows else []
    reasons: dict[str, list[str]] = {}
    for each in report.limits:
        if each.bound is None and each.budget not in reasons.get(each.reason, ()):
            reasons.setdefault(each.reason, []).append(each.budget)
    for reason, budgets in reasons.items():
        text = f"not calculated: {', '.join(budgets)} ({reason})"
        lines += paragraph(text, "  ", "    ")
    return lines


def _row(report: Report, each: BoundWithRun) -> tuple[str, ...]:
    sign = ">=" if each.bound.least else "<="
    return (
        each.bound.name,
        "none" if each.bound.unproven else f"{sign} {_value(report, each.bound, each.bound.ticks)}",
        "-" if each.seen is None else _value(report, each.bound, each.seen),
        "-" if each.ratio is None or each.bound.unproven else f"{float(each.ratio):.3f}",
        str(each.count),
    )


def _sum(report: Report, bound: Bound) -> list[str]:
    """The sum under its head."""
    sign = "at least" if bound.least else "at most"
    if bound.unproven:
        sign = "not calculated; what was measured adds up to"
    lines = [f"{bound.name}: {sign} {_value(report, bound, bound.ticks)}"]
    if bound.floor is None:
        return lines + _terms(report, bound.terms, bound.counted)
    lines += _terms(report, (bound.floor,))
    return [*lines, f"  or, if that is more, the sum of {_us(report, bound.sum)} us", *_terms(report, bound.terms)]


def _held_from(cycles: int) -> str:
    if not cycles:
        return "SCL may be held for it already"
    return f"SCL is free with {cycles - 1} cycles more before each write; from {cycles} on it may be held"


def _terms(report: Report, terms: tuple[Term, ...], counted: bool = False) -> list[str]:
    lines = []
    for term in terms:
        amount = f"{_cycles(report, term.ticks):>9} cycles {_us(report, term.ticks):>11} us"
        amount = f"{term.ticks:>9}" if counted else amount
        lines += columns([(amount, f"{term.what}  [{term.source}]")], right=(0,))
        if term.unproven:
            lines += paragraph(f"not calculated, since {term.unproven}", " " * 12, " " * 14)
    return lines


def _cycles(report: Report, ticks: int) -> str:
    cycles = ticks / report.cycle
    return f"{cycles.numerator}" if cycles.denominator == 1 else f"{float(cycles):.1f}"


def _us(report: Report, ticks: int) -> str:
    return f"{float(Fraction(ticks * 1_000_000, report.timebase.per_second)):.3f}"


def _value(report: Report, bound: Bound, ticks: int) -> str:
    return str(ticks) if bound.counted else f"{_us(report, ticks)} us"


def as_json(report: Report) -> dict[str, object]:
    """Times in microseconds and in cycles, as numbers; what is counted as `count`."""

    def time(ticks: int) -> dict[str, float]:
        us = Fraction(ticks * 1_000_000, report.timebase.per_second)
        return {"us": float(us), "cycles": float(ticks / report.cycle)}

    def value(counted: bool, amount: int) -> dict[str, float]:
        return {"count": amount} if counted else time(amount)

    def terms(given: tuple[Term, ...], counted: bool = False) -> list[dict[str, object]]:
        return [
            {"what": term.what, **value(counted, term.ticks), "source": term.source, "reason": term.unproven}
            for term in given
        ]

    return {
        "case": report.case,
        "simulated_s": report.simulated_s,
        "holds": report.holds,
        "passed": report.passed,
        "assumes": list(ASSUMED),
        "hung": list(report.hung),
        "held_from_cycles": report.held_from,
        "deadlines": [
            {"what": deadline.name, "spare": time(deadline.ticks), "terms": terms(deadline.terms)}
            for deadline in report.deadlines
        ],
        "calculated": [
            {
                "measure": each.bound.measure,
                "from_below": each.bound.least,
                "reason": each.bound.unproven,
                "calculated": value(each.bound.counted, each.bound.ticks),
                "seen": None if each.seen is None else value(each.bound.counted, each.seen),
                "ratio": None if each.ratio is None else float(each.ratio),
                "values": each.count,
                "holds": each.holds,
                "floor": terms((each.bound.floor,)) if each.bound.floor is not None else [],
                "terms": terms(each.bound.terms, each.bound.counted),
            }
            for each in report.beside
        ],
        "limits": [
            {
                "budget": each.budget,
                "measure": each.measure,
                "key": each.key,
                "calculated": each.bound is not None,
                "spare": None if each.bound is None else value(each.bound.counted, each.spare or 0),
                "reason": each.reason,
            }
            for each in report.limits
        ],
        "interrupt": terms(report.handlers.terms),
    }
