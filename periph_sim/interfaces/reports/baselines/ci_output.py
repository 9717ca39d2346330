"""Results of a check for continuous integration: JUnit XML, and annotations of GitHub.

JUnit XML: each case is a test suite. It has a test case for each budget, and a test case with the name "the case" for
findings about the whole case. Properties contain the figures. If a budget must break, its break is no failure.

Annotations: lines on failing budgets and cases (see `github`). Source: GitHub's "Workflow commands for GitHub
Actions": `::error file=...,line=...::message`. Percent signs, carriage returns and line feeds are written as
%25, %0D and %0A. In properties such as `file`, colons and commas are also written as %3A and %2C.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree as xml

from ..explain.chain import Chain, relative, text
from .check import CaseCheck
from .files import Baseline
from .outcome import RejectedCase
from .summary import place_in_clone


def github(checks: list[CaseCheck], refused: Sequence[RejectedCase] = ()) -> list[str]:
    """Return the annotations: `::error` for each failing budget or case, and `::warning` for a firmware line at fault.

    A coverage file that is out of date or incomplete gives a `::notice`.

    refused: cases that could not be run; each gives an `::error` line.

    Findings at one line about one budget, or about the whole case, share an annotation, because GitHub shows only ten
    per step.
    """
    lines = []
    for check in checks:
        file = _property(in_repository(check.outcome.path))
        title = _property(f"periph-sim check: {check.outcome.figures.case}")
        about: dict[tuple[int, str | None], list[str]] = {}
        for finding in check.findings:
            about.setdefault((finding.line, finding.budget), []).append(finding.text)
        for (line, _), texts in about.items():
            lines.append(f"::error file={file},line={line},title={title}::{_message(chr(10).join(texts))}")
        lines += [line for name, chain in check.causes.items() for line in _cause(name, chain, title)]
        if check.coverage is not None and check.coverage.state in ("out of date", "incomplete"):
            lines.append(f"::notice file={file},line=1,title={title}::{_message(check.coverage.report.line)}")
    for one in refused:
        name = _property(f"periph-sim check: {one.path.stem}")
        lines.append(f"::error file={_property(in_repository(one.path))},line=1,title={name}::{_message(one.why)}")
    return lines


def in_repository(path: Path) -> str:
    """Return a path as GitHub expects it: relative to the root of the git clone, or as it is outside of a clone."""
    place = place_in_clone(path)
    return relative(path).as_posix() if place is None else place[1]


def _cause(budget: str, chain: Chain, title: str) -> list[str]:
    """Return a `::warning` for the firmware line that the explanation blames, if its file is below the current folder.

    Otherwise, return an empty list.
    """
    part = chain.blamed
    if part is None or part.place is None or part.place.file is None:
        return []
    if relative(part.place.file).is_absolute():
        return []
    where = f"file={_property(in_repository(part.place.file))},line={part.place.line},title={title}"
    return [f"::warning {where}::{_message(chr(10).join([f'{budget}: {part}', *text(chain)]))}"]


def _message(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _message(text).replace(":", "%3A").replace(",", "%2C")


WHOLE = "the case"


def junit(checks: list[CaseCheck], refused: Sequence[RejectedCase] = ()) -> str:
    """Return the XML with its declaration. Characters that XML does not allow become U+FFFD.

    refused: cases that could not be run; each becomes a suite with one test, which has an error.
    """
    root = xml.Element("testsuites", name="periph-sim check")
    for check in checks:
        _suite(root, check)
    for one in refused:
        suite = xml.SubElement(root, "testsuite", name=_safe(one.path.stem), file=_safe(one.path.as_posix()))
        _test(suite, WHOLE, 1, {}, [one.why], "error")
        _sums(suite)
    _sums(root)
    xml.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + xml.tostring(root, encoding="unicode") + "\n"


def _suite(root: xml.Element, check: CaseCheck) -> None:
    outcome, figures = check.outcome, check.outcome.figures
    suite = xml.SubElement(root, "testsuite", name=_safe(figures.case), file=_safe(outcome.path.as_posix()))
    properties = xml.SubElement(suite, "properties")
    coverage = {} if check.coverage is None else {"coverage": check.coverage.state}
    for name, value in {"baseline": check.state, **coverage, "events": figures.events, **figures.counts}.items():
        xml.SubElement(properties, "property", name=name, value=str(value))
    for verdict in outcome.verdicts:
        tail = "_us" if verdict.unit == "us" else ""
        said = _figures(figures, verdict.name) | {
            f"limit{tail}": str(verdict.limit),
            "verdict": verdict.word,
            "must_break": "yes" if verdict.name in outcome.breaks else "no",
        }
        _test(suite, verdict.name, outcome.lines[verdict.name], said, _found(check, verdict.name), "failure")
    _test(suite, WHOLE, outcome.name_line, {}, _found(check, None), "failure")
    _sums(suite)
    suite.set("time", f"{outcome.result.wall_s:.6f}")


def _found(check: CaseCheck, budget: str | None) -> list[str]:
    """Return the findings about a budget, or about the whole case if `budget` is None."""
    return [finding.text for finding in check.findings if finding.budget == budget]


def _test(suite: xml.Element, name: str, line: int, said: dict[str, str], found: list[str], tag: str) -> None:
    """Add a test case to the suite of a case.

    name: the name of a budget, or WHOLE.
    line: the line in the case file; 0 if unknown.
    said: a dictionary from the names of the test case's properties to their values.
    found: the findings, which are the lines of one element with this tag.
    """
    place = {"classname": suite.attrib["name"], "name": _safe(name), "file": suite.attrib["file"]}
    test = xml.SubElement(suite, "testcase", place, line=str(line or 1))
    if said:
        properties = xml.SubElement(test, "properties")
        for key, value in said.items():
            xml.SubElement(properties, "property", name=key, value=_safe(value))
    if found:
        wrong = [*map(_safe, found)]
        xml.SubElement(test, tag, message=wrong[0], type="check").text = "\n".join(wrong)


def _sums(parent: xml.Element) -> None:
    """Set attributes of an element to the numbers of tests, failures and errors below it."""
    for key, tag in (("tests", "testcase"), ("failures", "failure"), ("errors", "error")):
        parent.set(key, str(sum(1 for _ in parent.iter(tag))))


def _figures(figures: Baseline, budget: str) -> dict[str, str]:
    """Return a dictionary from the names of a budget's figures to their texts.

    Times and instants are in cycles of SYSCLKOUT. The other figures are the integers in the baseline.
    """
    of = figures.budgets[budget]
    shown = {"measure": of.measure, "count": str(of.count)}
    for key, value, in_cycles in (
        ("worst", of.worst, of.unit == "time"),
        ("worst_at", of.worst_at, True),
        ("least", of.least, of.unit == "time"),
        ("least_at", of.least_at, True),
    ):
        if value is not None:
            shown[f"{key}_cycles" if in_cycles else key] = figures.cycles(value) if in_cycles else str(value)
    return shown


def _safe(text: str) -> str:
    """Replace characters that XML 1.0 does not allow."""
    return "".join(
        c if c in "\t\n\r" or " " <= c <= "\ud7ff" or "\ue000" <= c <= "\ufffd" or c > "\uffff" else "\ufffd"
        for c in text
    )
