"""GitHub annotations of a check: one line per failing budget.

Source: GitHub's "Workflow commands for GitHub Actions": `::error file=...,line=...::message`, with
%, carriage return and line feed written as %25, %0D, %0A, and in properties also : and , as %3A, %2C.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..explain.chain import Chain
from ..explain.text_report import relative, text
from .judge import CaseCheck
from .outcome import RejectedCase


def github(checks: list[CaseCheck], refused: Sequence[RejectedCase] = ()) -> list[str]:
    """Return `::error` lines at the budget's line in its case file, and `::warning` at the blamed firmware line.

    refused: cases that could not be run; each is an `::error` line.

    All findings of a budget, or of the whole case, share one line: GitHub shows only ten per step.
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
        lines += [line for name, chain in check.causes.items() for line in _cause(name, chain, title)]
    for one in refused:
        name = _property(f"periph-sim check: {one.path.stem}")
        lines.append(f"::error file={_property(one.path.as_posix())},line=1,title={name}::{_message(one.why)}")
    return lines


def _cause(budget: str, chain: Chain, title: str) -> list[str]:
    """Return a `::warning` line at the firmware line that took most of the time, if it is in this folder."""
    part = chain.blamed
    if part is None or part.place is None or part.place.file is None:
        return []
    file = relative(part.place.file)
    if file.is_absolute():
        return []
    where = f"file={_property(file.as_posix())},line={part.place.line},title={title}"
    return [f"::warning {where}::{_message(chr(10).join([f'{budget}: {part}', *text(chain)]))}"]


def _message(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _message(text).replace(":", "%3A").replace(",", "%2C")
