"""Annotations of a check for a CI service: CaseChecks go in, a line a budget that is not as it should be comes out.

Source: GitHub's "Workflow commands for GitHub Actions": `::error file=...,line=...::message`, with
%, carriage return and line feed written as %25, %0D, %0A, and in properties also : and , as %3A, %2C.
"""

from __future__ import annotations

from .judge import CaseCheck


def github(checks: list[CaseCheck]) -> list[str]:
    """`::error` lines that point at the line of the budget in its case file.

    All about a budget is one of them, and all about the case as a whole: GitHub shows ten of a step.
    """
    lines = []
    for check in checks:
        file = _property(check.outcome.path.as_posix())
        title = _property(f"periph-sim check: {check.outcome.figures.case}")
        about: dict[tuple[int, str | None], list[str]] = {}
        for finding in check.findings:
            about.setdefault((finding.line, finding.budget), []).append(finding.text)
        for (line, _), texts in about.items():
            lines.append(f"::error file={file},line={line},title={title}::{_message(chr(10).join(texts))}")
    return lines


def _message(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _message(text).replace(":", "%3A").replace(",", "%2C")
