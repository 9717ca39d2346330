"""A pytest plugin: what each test that names rules came to goes into a file, as pytest itself saw it.

    marks of collected items --> reports of setup, call, teardown --> {node id: {rules, outcome}} in `--rules FILE`

Only marks that pytest has on an item count. A test has passed if its call passed and neither its setup nor its teardown
failed; a skipped, failed, errored or expectedly failing test proves nothing. With xdist the workers' reports come to
the process that started them, which alone writes. Several runs add to one file.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.rules.texts import texts

PROPERTY = "rules"  # of a report's user_properties, which xdist carries from a worker
PASSED = "passed"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--rules", type=Path, metavar="FILE", help="Add which rules were named by tests, and what came.")


def pytest_configure(config: pytest.Config) -> None:
    path = config.getoption("--rules")
    if path is not None and not hasattr(config, "workerinput"):
        config.pluginmanager.register(Outcomes(path), "rule outcomes")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """UsageError for a mark that names no rule: a slip of the number would otherwise prove nothing, silently."""
    known = texts()
    for item in items:
        rules = rules_of(item)
        unknown = [rule for rule in rules if rule not in known]
        if unknown:
            raise pytest.UsageError(f"{item.nodeid}: there is no rule {', '.join(unknown)}; see tests/rules/*.toml")
        if rules:
            item.user_properties.append((PROPERTY, rules))


def rules_of(item: pytest.Item) -> list[str]:
    """The rules that a test's marks name, nearest mark first, each once."""
    return list(dict.fromkeys(str(rule) for mark in item.iter_markers("rule") for rule in mark.args))


class Outcomes:
    """Collects one run's reports and adds them to a file at its end."""

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
    """What runs have added to a file so far; empty if there is none."""
    found: dict[str, dict[str, object]] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    return found
