"""A result as a person reads it in the terminal: a Result goes in, tables come out."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from ..board.result import Result
from ..timing.shown import broken, figure, limit
from ..timing.verdicts import EVERY_PHASE, FAIL, NOT_JUDGED, PASS, Verdict

STYLES = {PASS: "", FAIL: "red", NOT_JUDGED: "yellow"}
WIDTH = 80
PADDING = (0, 1, 0, 0)  # of tables


def show(console: Console, result: Result, guaranteed: bool = False) -> None:
    """guaranteed: what holds only in what was seen has failed."""
    console.print(budget_table(f"{result.case}: {_title(result, guaranteed)}", result.budgets))
    for line in legend(result.budgets):
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    counts = ", ".join(f"{value} {name.replace('_', ' ')}" for name, value in result.counts.items() if value)
    console.print(
        f"{result.simulated_s:g} s simulated at {result.fidelity} fidelity; "
        f"{result.wire_bytes} I2C bytes, {result.sci_bytes} SCI bytes, {result.events} events\n{counts}",
        highlight=False,
    )
    for verdict in result.budgets:
        if verdict.found and not verdict.broken:
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


def _title(result: Result, guaranteed: bool) -> str:
    if result.verdict != PASS:
        return result.verdict.upper()
    if result.proof == EVERY_PHASE:
        return "PASS, for every phase"
    return "FAIL, since it passes in what was seen only" if guaranteed else "PASS, in what was seen"


def budget_table(title: str, budgets: Sequence[Verdict]) -> Table:
    """A row a budget, within 80 columns; red where it is broken, yellow where it is not judged."""
    table = Table(title=title or None, title_justify="left", title_style="bold", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    table.add_column("budget")
    names = ("seen", "bound", "limit", "count") if any(each.bound is not None for each in budgets) else NO_BOUND
    for name in names:
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    for verdict in budgets:
        cells = row(verdict)
        table.add_row(verdict.name, *(cells[name] for name in names), verdict.word, style=STYLES[verdict.verdict])
    return table


NO_BOUND = ("seen", "limit", "margin", "count")  # columns where nothing is bounded


def row(verdict: Verdict) -> dict[str, str]:
    """The figures of a verdict by column."""
    unit = verdict.unit
    return {
        "seen": figure(verdict.worst, unit),
        "bound": figure(verdict.bound, unit),
        "limit": limit(verdict.limit, unit, verdict.which),
        "margin": figure(verdict.margin, unit),
        "count": verdict.counted,
    }


def legend(budgets: Sequence[Verdict]) -> list[str]:
    """What broke, with its instant; and what the verdicts of this table prove, each reason once."""
    lines = [f"{each.name}: {broken(each)}" for each in budgets if each.broken and each.worst is not None]
    doubts: dict[str, list[str]] = {}
    for each in budgets:
        if each.unbounded:
            doubts.setdefault(each.unbounded, []).append(each.name)
    proven = any(each.proof == EVERY_PHASE for each in budgets)
    if proven:
        lines.append("every phase: holds for every phase" + "; seen: holds in what was seen, as" * bool(doubts))
    elif len(doubts) == 1 and not any(each.bound is not None for each in budgets):
        return [*lines, f"seen: holds in what was seen; no bounds, as {next(iter(doubts))}"]
    elif doubts:
        lines.append("seen: holds in what was seen, as")
    for reason, names in doubts.items():
        lines += wrap(f"{', '.join(names)}: {reason}", WIDTH, initial_indent="  ", subsequent_indent="    ")
    return lines
