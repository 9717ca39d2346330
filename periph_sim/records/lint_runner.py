"""Lints that check what firmware did in a recorded run. Every file in `lints/` is a lint and is found automatically.

Run --each lint--> rows at fault --> findings, one for each place and fault
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import cast

from ..core.discover import modules_with
from . import lints
from .lint_finding import Finding, Lint, Options
from .run import Run


@cache
def all_lints() -> dict[str, Lint]:
    """Return the lints by name, in the order of their names."""
    found = modules_with("faults", lints.__name__, lints.__path__)
    return {name.replace("_", "-"): cast(Lint, module) for name, module in found.items()}


def lint(run: Run | Path | str, options: Options | None = None) -> list[Finding]:
    """Return the findings of all lints, ordered by their first time. run: a recorded run, or its file."""
    if not isinstance(run, Run):
        run = Run.read(run)
    found = []
    for name, one in all_lints().items():
        for fault in one.faults(run, options or Options()):
            for place, rows in run.by_place(fault.rows):
                first = int(run.table.tick[rows[0]])
                found.append(Finding(name, fault.unit, place, len(rows), first, fault.text, fault.source))
    return sorted(found, key=lambda finding: (finding.first, finding.lint, finding.place))
