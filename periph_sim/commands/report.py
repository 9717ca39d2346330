"""A result as a person reads it in the terminal: a Result goes in, tables come out."""

from __future__ import annotations

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from ..board.result import Result
from ..timing.budgets import Verdict
from ..timing.shown import figure, instant, limit


def show(console: Console, result: Result) -> None:
    console.print(budget_table(f"{result.case}: {result.verdict.upper()}", result.budgets))
    counts = ", ".join(f"{value} {name.replace('_', ' ')}" for name, value in result.counts.items() if value)
    console.print(
        f"{result.simulated_s:g} s simulated at {result.fidelity} fidelity; "
        f"{result.wire_bytes} I2C bytes, {result.sci_bytes} SCI bytes, {result.events} events\n{counts}",
        highlight=False,
    )
    for verdict in result.budgets:
        if verdict.found:
            console.print(f"{verdict.name}: {verdict.found}", highlight=False, markup=False, soft_wrap=True)
    if result.first_wrong:
        console.print(f"first wrong: {result.first_wrong}", highlight=False)
    for place, times in list(result.wrong.items())[:12]:
        console.print(f"wrong: {place}, {times} times", highlight=False)
    for line in result.stuck:
        console.print(f"stuck: {line}", highlight=False, soft_wrap=True)
    for line in result.notes:
        console.print(f"note: {line}", highlight=False, soft_wrap=True)
    if result.unknowns:
        console.print(f"open questions touched: {', '.join(result.unknowns)}", highlight=False, soft_wrap=True)


def budget_table(title: str, budgets: list[Verdict]) -> Table:
    """A row a budget, the broken ones in red."""
    table = Table(title=title or None, title_justify="left", title_style="bold", box=SIMPLE_HEAD)
    table.add_column("budget")
    for name in ("worst", "limit", "margin", "count", "at"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    for verdict in budgets:
        table.add_row(*row(verdict), style="red" if verdict.verdict == "fail" else "")
    return table


def row(verdict: Verdict) -> tuple[str, ...]:
    return (
        verdict.name,
        figure(verdict.worst, verdict.unit),
        limit(verdict.limit, verdict.unit, verdict.which),
        figure(verdict.margin, verdict.unit),
        str(verdict.count),
        instant(verdict.at_s),
        verdict.verdict,
    )
