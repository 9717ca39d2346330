"""Findings of a case: everything that makes `check` fail, with lines."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from ....timing.verdict import Verdict, broken
from ..explain.chain import Chain
from .compare import Change
from .outcome import Outcome

State = Literal["equal", "changed", "missing", "written"]


@dataclass
class Finding:
    """One reason why `check` fails. line: the line in the case file, at least 1."""

    budget: str | None
    line: int
    text: str


@dataclass
class CaseCheck:
    """The result of checking a case.

    state: the state of its baseline.
    diff: the change that `--update-baseline` makes, as a unified diff.
    causes: for each budget that broke unexpectedly, the explanation of its worst occurrence.
    """

    outcome: Outcome
    baseline: Path
    state: State
    changes: list[Change]
    diff: str = ""
    causes: dict[str, Chain] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)

    @property
    def broken(self) -> list[Verdict]:
        """Budgets that broke unexpectedly."""
        outcome = self.outcome
        return [v for v in outcome.verdicts if v.broken and v.name not in outcome.breaks]

    @property
    def passed(self) -> bool:
        return not self.findings


def judge(check: CaseCheck) -> list[Finding]:
    """Return all findings, budgets first."""
    outcome = check.outcome
    top = outcome.name_line or 1
    findings = []
    for verdict in outcome.verdicts:
        line = outcome.lines[verdict.name] or top
        must = verdict.name in outcome.breaks
        if verdict.broken:
            if not must:
                findings.append(Finding(verdict.name, line, f"{verdict.name} breaks: {broken(verdict)}"))
        elif not verdict.passed:
            findings.append(Finding(verdict.name, line, f"{verdict.name} is not judged: {lacking(verdict)}"))
        elif must:
            line = outcome.breaks_line or line
            text = f"{verdict.name} holds, but is listed in breaks; remove it there if the bug is fixed"
            findings.append(Finding(verdict.name, line, text))
    findings += [Finding(None, top, text) for text in outcome.trouble]
    if check.state == "missing":
        text = f"it has no baseline {check.baseline}; write one with --update-baseline"
        findings.append(Finding(None, top, text))
    elif check.state == "changed":
        for change in (change for change in check.changes if not change.note):
            line = outcome.lines.get(change.budget or "", 0) or top
            there = change.budget if change.budget in {verdict.name for verdict in outcome.verdicts} else None
            findings.append(Finding(there, line, str(change)))
    return findings


def lacking(verdict: Verdict) -> str:
    """Return why a budget is not judged, as a phrase."""
    return verdict.found or f"nothing was measured by {verdict.measure!r}"
