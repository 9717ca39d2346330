"""The table of docs/fidelity.md that says what levels make of the scenes of timing/trade: a page goes in, the page with
what is measured now comes out.

What happens in a scene is told by people, and stays; of a new scene it is its `about`.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from periph_sim.reports.level_choice.compared import Comparison, Outcome, compare_levels
from periph_sim.reports.level_choice.errors import number
from periph_sim.reports.level_choice.levels import REFERENCE, level_of
from periph_sim.scene.case.discover import cases_below
from periph_sim.scene.case.load import load

SCENES = Path(__file__).resolve().parents[2] / "timing" / "trade"
NAMES = sorted(path.stem for path in cases_below(SCENES))
LEVELS = ("byte",)
HEAD = "| scene | worst error at `byte`, cycles | what happens |\n|---|---|---|\n"
TABLE = re.compile(rf"{re.escape(HEAD)}((?:\|.*\n)*)")


@cache
def compared(name: str) -> Comparison:
    """A scene at every level of fidelity, over all its length."""
    path = SCENES / f"{name}.toml"
    levels = [level_of(level) for level in (REFERENCE, "adaptive", *LEVELS)]
    return compare_levels(lambda more: load(path, list(more)), levels, load(path).duration)


def outcome(name: str, level: str) -> Outcome:
    return next(each for each in compared(name).outcomes if each.level.name == level)


def cell(found: Outcome) -> str:
    """`refused`, `exact`, `values` where times are exact and something else is not, else the worst error in cycles."""
    if found.refused:
        return "refused"
    if all(each.exact for each in found.errors if each.measured):
        return "exact"
    return number(found.worst) if found.worst else "values"


def rows(page: str) -> dict[str, list[str]]:
    """The cells of each scene on the page, without its name."""
    found = TABLE.search(page)
    if found is None:
        return {}
    cells = [[cell.strip() for cell in line.strip("|\n").split("|")] for line in found[1].splitlines()]
    return {name: others for name, *others in cells}


def refreshed_table(page: str) -> str:
    """The page with the figures that are measured now; of a page without such a table, the page."""
    if TABLE.search(page) is None:
        return page
    there = rows(page)
    lines = []
    for name in NAMES:
        told = there[name][-1] if name in there else load(SCENES / f"{name}.toml").about
        cells = [name, *(cell(outcome(name, level)) for level in LEVELS), told]
        lines.append(f"| {' | '.join(cells)} |\n")
    return TABLE.sub(lambda _: HEAD + "".join(lines), page)
