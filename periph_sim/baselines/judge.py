"""What is not as it should be with a case: its outcome and changes go in, findings with their lines come out."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from ..timing.budgets import Verdict
from .compare import Change
from .outcome import Outcome

State = Literal["equal", "changed", "missing", "written"]


@dataclass
class Finding:
    """One thing that makes `check` fail. line: of the case file, 1 at least."""

    budget: str | None
    line: int
    text: str


@dataclass
class CaseCheck:
    """How a case stands. state: of its baseline. diff: what `--update-baseline` changed, as a unified diff."""

    outcome: Outcome
    baseline: Path
    state: State
    changes: list[Change]
    diff: str = ""
    findings: list[Finding] = field(default_factory=list)

    @property
    def passed(self) -> bool:
        return not self.findings


def judge(check: CaseCheck) -> list[Finding]:
    """Everything that is not as it should be, budgets first."""
    outcome = check.outcome
    top = outcome.name_line or 1
    findings = []
    for verdict in outcome.verdicts:
        line = outcome.lines[verdict.name] or top
        must = verdict.name in outcome.breaks
        if verdict.verdict == "fail" and not must:
            findings.append(Finding(verdict.name, line, f"{verdict.name} breaks: {broken(verdict)}"))
        elif verdict.verdict != "fail" and must:
            line = outcome.breaks_line or line
            text = f"{verdict.name} holds, but breaks says that it must break; take it out there if the bug is mended"
            findings.append(Finding(verdict.name, line, text))
    findings += [Finding(None, top, text) for text in outcome.trouble]
    if check.state == "missing":
        text = f"it has no baseline {check.baseline}; write one with --update-baseline"
        findings.append(Finding(None, top, text))
    elif check.state == "changed":
        for change in check.changes:
            line = outcome.lines.get(change.budget or "", 0) or top
            there = change.budget if change.budget in outcome.lines else None
            findings.append(Finding(there, line, str(change)))
    return findings


def broken(verdict: Verdict) -> str:
    """What broke a budget, as a phrase."""
    if verdict.worst is None:
        return f"nothing was measured by {verdict.measure!r}"
    over = "over" if verdict.worst > verdict.limit else "under"
    at = "" if verdict.at_s is None else f", at {verdict.at_s:.6f} s"
    return f"{_shown(verdict.worst, verdict.unit)} is {over} its limit of {_shown(verdict.limit, verdict.unit)}{at}"


def _shown(value: float | int, unit: str) -> str:
    if unit != "us":
        return f"{value}" if unit == "count" else f"{value} {unit}"
    return f"{value:.3f} us" if abs(value) < 1000 else f"{value / 1000:.3f} ms"
