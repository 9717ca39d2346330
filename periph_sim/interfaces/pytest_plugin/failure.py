"""The text of failed budgets: a table, causes and timing diagrams.

verdicts --> budget, worst, limit, margin, when, why
worst occurrences --> windows (of a second, short run, or of the run's own records) --> chain and diagram, in text
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ...core.text_table import text_table
from ...timing.verdict import Verdict, figure, instant, limit
from ..reports.explain.chain import Chain, text
from ..reports.explain.picture import text_picture
from ..reports.explain.window import Window

if TYPE_CHECKING:
    from .runs import Run

WIDTH = 72  # pytest puts 8 columns before each line
MOST = 3  # worst occurrences explained


def failure_text(run: Run, broken: Sequence[Verdict], judged: int) -> str:
    """Return several lines; the first names the budgets, and for a single one by how much."""
    head = f"{len(broken)} of {judged} budgets {_worst_word(broken)}: {', '.join(verdict.name for verdict in broken)}"
    if len(broken) == 1:
        one = broken[0]
        found = "was never measured" if one.worst is None else figure(one.worst, one.unit)
        head = f"{one.name} {found}, limit {_limit(one)}"
        if one.until_s is not None:
            head = f"{one.name}: {one.found}"
        head += "" if one.broken or one.worst is None else f"; not judged, as {one.found}"
    lines = [f"{run.result.case}: {head}", "", *_table(broken)]
    if run.result.first_wrong and any(verdict.measure == "wrong bytes" for verdict in broken):
        lines += ["", f"first wrong: {run.result.first_wrong}"]
    lines += [f"stuck: {line}" for line in run.result.stuck]
    happened = [verdict for verdict in broken if verdict.at_s is not None]
    for window, chain in run.explained(happened[:MOST]):
        lines += ["", *_picture(window, chain)]
    if len(happened) > MOST:
        left = ", ".join(verdict.name for verdict in happened[MOST:])
        lines += ["", f"(no picture of {left}; assert one alone to get it)"]
    return "\n".join(lines)


def _worst_word(verdicts: Sequence[Verdict]) -> str:
    """Return "broken", "not judged", or both."""
    words = ["broken"] * any(verdict.broken for verdict in verdicts)
    return " or ".join([*words, *["not judged"] * any(not verdict.broken for verdict in verdicts)])


def _picture(window: Window, chain: Chain | None) -> list[str]:
    verdict = window.verdict
    title = f"{verdict.name}, {figure(verdict.worst, verdict.unit)} at {instant(verdict.at_s)}:"
    shown = [title] if chain is None else text(chain)
    drawn = text_picture(window, WIDTH)
    if not drawn:
        return [*shown[:-1], f"{shown[-1]} no wire moves around it"] if chain is None else shown
    return [*shown, *drawn] if chain is None else [*shown, "", *drawn]


def _table(verdicts: Sequence[Verdict]) -> list[str]:
    rows: list[tuple[str, ...]] = []
    for verdict in verdicts:
        worst, margin = (figure(value, verdict.unit) for value in (verdict.worst, verdict.margin))
        why = verdict.why if verdict.worst is not None else "nothing was measured, which is not a pass"
        why = verdict.found or why
        rows.append((verdict.name, worst, _limit(verdict), margin, instant(verdict.at_s), why))
    return text_table(("budget", "seen", "limit", "margin", "when", "why"), rows, range(1, 5), WIDTH)


def _limit(verdict: Verdict) -> str:
    return limit(verdict.limit, verdict.unit, verdict.which)
