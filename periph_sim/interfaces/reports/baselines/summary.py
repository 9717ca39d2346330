"""A summary of a check as Markdown: for each budget the measured value, its limit, and the change since a commit.

checks -------------------------------------------+--> table of each case --> GitHub's page of the run
baselines in a commit <--git show-- a git clone --+
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from subprocess import run

from ....timing.verdict import Verdict, figure, limit
from .check import CaseCheck
from .compare import number_text
from .files import BadCheck, Baseline, parse
from .outcome import RejectedCase

TITLES = ("budget", "seen", "limit", "verdict")
MARKS = {True: "✅", False: "❌"}
NEW = "new"
Baselines = Mapping[Path, Baseline | str]  # the baseline at each path, or why there is none


def place_in_clone(path: Path) -> tuple[Path, str] | None:
    """Return the root of the git clone that contains a file, and the file's path in it; None if it is in no clone."""
    whole = Path(os.path.abspath(path))  # unlike `Path.absolute`, without ".."
    root = next((folder for folder in whole.parents if (folder / ".git").exists()), None)
    return None if root is None else (root, whole.relative_to(root).as_posix())


def baselines_at(commit: str, paths: Iterable[Path]) -> Baselines:
    """Return the baselines at these paths as a commit contains them, or why there is none.

    commit: a name that git knows, such as "origin/main".

    Raise BadCheck if git is missing, a path is in no clone, or the clone does not contain the commit.
    """
    found: dict[Path, Baseline | str] = {}
    for path in paths:
        place = place_in_clone(path)
        if place is None:
            raise BadCheck(f"{path}: it is in no git clone, so it has no state at {commit}; leave --since out")
        root, name = place
        if _git(root, "rev-parse", "--verify", "--quiet", f"{commit}^{{commit}}") is None:
            fetch = "fetch it first; with actions/checkout, `fetch-depth: 0` does"
            raise BadCheck(f"--since {commit}: the clone {root} does not contain this commit; {fetch}")
        data = _git(root, "show", f"{commit}:{name}")
        try:
            found[path] = NEW if data is None else parse(f"{commit}:{path}", data)
        except BadCheck:  # a baseline in a commit cannot be repaired, so it does not stop the check
            found[path] = "no readable baseline"
    return found


def _git(root: Path, *arguments: str) -> bytes | None:
    """Return the output of a git command, or None if it fails. Raise BadCheck if git is not installed."""
    try:
        done = run(["git", "-C", os.fspath(root), *arguments], capture_output=True, check=False)
    except OSError:
        raise BadCheck("--since: git is not installed; install it, or leave --since out") from None
    return None if done.returncode else done.stdout


def summary(
    checks: Sequence[CaseCheck],
    refused: Sequence[RejectedCase] = (),
    since: tuple[str, Baselines] | None = None,
) -> str:
    """Return the summary of a check as Markdown, with a section for each case.

    refused: cases that could not be run.
    since: a commit, and a dictionary from paths to the baselines in this commit. A column shows the change of each
        value since the commit. If `since` is None, there is no such column.
    """
    good = sum(one.passed for one in checks)
    lines = [f"## periph-sim check: {good} of {len(checks) + len(refused)} as they should be", ""]
    for one in checks:
        lines += [f"### {MARKS[one.passed]} {_cell(one.outcome.figures.case)}", "", *_table(one, since), ""]
        lines += (
            [] if one.coverage is None else [f"coverage {one.coverage.state}: {_cell(one.coverage.report.line)}", ""]
        )
        lines += [f"* line {finding.line}: {_cell(finding.text)}" for finding in one.findings]
        lines += [""] if one.findings else []
    for case in refused:
        lines += [f"### {MARKS[False]} {_cell(case.path.stem)}", "", _cell(case.why), ""]
    return "\n".join(lines)


def _table(check: CaseCheck, since: tuple[str, Baselines] | None) -> list[str]:
    titles = TITLES if since is None else (*TITLES, f"since {since[0]}")
    rows = [f"| {' | '.join(titles)} |", f"|---|{'---:|' * 2}{'---|' * (len(titles) - 3)}"]
    for one in check.outcome.verdicts:
        word = f"{one.word}, must break" if one.name in check.outcome.breaks else one.word
        cells = [one.name, figure(one.worst, one.unit), limit(one.limit, one.unit, one.which), word]
        if since is not None:
            cells.append(_change(one, since[1].get(check.baseline, NEW), check.outcome.figures))
        rows.append(f"| {' | '.join(map(_cell, cells))} |")
    return rows


def _change(verdict: Verdict, before: Baseline | str, now: Baseline) -> str:
    """Return the change of a budget's value since the earlier baseline, or the reason why there is none.

    Baselines contain no percentiles. For a percentile, the change of the largest value is returned.
    """
    if isinstance(before, str):
        return before
    if verdict.name not in before.budgets:
        return NEW
    old, new = before.budgets[verdict.name], now.budgets[verdict.name]
    name = "least" if verdict.which == "min" else "worst"
    was, came = (getattr(one, name) for one in (old, new))
    of = "largest value: " if verdict.which.startswith("p") else ""
    if (old.measure, old.unit) != (new.measure, new.unit):
        return "another measure"
    if was == came:
        return f"{of}unchanged"
    if was is None or came is None:
        return "not measured before" if was is None else "no longer measured"
    if new.unit != "time":
        text = number_text(came - was, new.unit) + (f" {new.unit}" if new.unit in ("%", "LSB") else "")
    elif before.ticks_per_second != now.ticks_per_second:
        return "another clock"
    else:
        text = f"{now.cycles(came - was)} cycles"
    return f"{of}{'' if text[0] == '-' else '+'}{text}"


def _cell(text: str) -> str:
    """Escape a text for a cell of a Markdown table, and replace its line feeds by spaces."""
    return text.replace("\\", "\\\\").replace("|", "\\|").replace("<", "&lt;").replace("\n", " ")
