"""A pytest plugin that writes the outcome of each test that names rules to a file.

    marks of collected items --> reports of setup, call, teardown --> {node id: {rules, outcome}} in `--rules FILE`

Only the marks that pytest finds on an item count. A test has passed if its call passed and neither its setup nor its
teardown failed; a test that was skipped, failed or is expected to fail proves nothing. With xdist, the workers send
their reports to the main process, and only this process writes the file. Several runs add to one file.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.rules.texts import texts

PROPERTY = "rules"  # a key of `user_properties` of a report, which xdist transfers from the worker
PASSED = "passed"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--rules", type=Path, metavar="FILE", help="Add the tests that name rules, and their outcomes, to FILE."
    )


def pytest_configure(config: pytest.Config) -> None:
    path = config.getoption("--rules")
    if path is not None and not hasattr(config, "workerinput"):
        config.pluginmanager.register(Outcomes(path), "rule outcomes")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Raise UsageError if a mark names an unknown rule; a wrong number would otherwise go unnoticed."""
    known = texts()
    for item in items:
        rules = rules_of(item)
        unknown = [rule for rule in rules if rule not in known]
        if unknown:
            raise pytest.UsageError(f"{item.nodeid}: there is no rule {', '.join(unknown)}; see tests/rules/*.toml")
        if rules:
            item.user_properties.append((PROPERTY, rules))


def rules_of(item: pytest.Item) -> list[str]:
    """Return the rules that the marks of a test name, those of the nearest mark first, without duplicates."""
    return list(dict.fromkeys(str(rule) for mark in item.iter_markers("rule") for rule in mark.args))


class Outcomes:
    """Collects the reports of a run and adds them to a file at the end of the run."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._found: dict[str, dict[str, object]] = {}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        rules = next((value for name, value in report.user_properties if name == PROPERTY), None)
        if rules is None:
            return
        entry = self._found.setdefault(report.nodeid, {"rules": rules, "outcome": "not run"})
        came = "expected failure" if hasattr(report, "wasxfail") else report.outcome
        if came != PASSED:
            entry["outcome"] = came
        elif report.when == "call" and entry["outcome"] == "not run":
            entry["outcome"] = PASSED

    def pytest_sessionfinish(self) -> None:
        self._path.parent.mkdir(parents=True, exist_ok=True)
        self._path.write_text(json.dumps(read_outcomes(self._path) | self._found, indent=0), encoding="utf-8")


def read_outcomes(path: Path) -> dict[str, dict[str, object]]:
    """Return the outcomes that earlier runs have added to a file; empty if it does not exist."""
    found: dict[str, dict[str, object]] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    return found
