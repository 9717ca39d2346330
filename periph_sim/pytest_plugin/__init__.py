"""The pytest plugin: case files and test functions go in; verdicts, figures for JUnit and a table come out.

    periph_sim_cases = timing  --> one test a budget of each case file (collect.py)
    scene(...), @mark.case     --> a run that a test looks at (fixtures.py, runs.py)
    figures of what was judged --> user_properties --> JUnit XML, terminal summary (figures.py)

pytest loads this in every project in which periph_sim is installed, so nothing but pytest is imported here: chips,
boards and numpy come with the first case. `-p no:periph-sim` turns it off.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Generator, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from .keys import CASES, MARKER, current

if TYPE_CHECKING:
    from .fixtures import SceneFactory
    from .runs import Run


_in_tests: list[pytest.Item] = []  # that run now; several where a test runs a session of its own


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addini(CASES, "folders or files of periph-sim cases (*.toml), each budget of which is a test", "paths", [])


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", MARKER)
    for place in config.getini(CASES):
        if not place.exists():
            from ..core.suggest import did_you_mean

            there = did_you_mean(place.name, sorted(entry.name for entry in config.rootpath.iterdir()))
            raise pytest.UsageError(f"{CASES}: there is no folder or file {str(place)!r}; {there}")


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_load_initial_conftests(early_config: pytest.Config) -> Iterator[None]:
    """A session that runs cases is one in its own process (whole_session.py) from before its conftest.py on."""
    if not _in_tests and early_config.getini(CASES) and "PYTEST_XDIST_WORKER" not in os.environ:
        from .whole_session import begin

        begin(early_config)
    return (yield)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> Generator[None, int | None, int | None]:
    """The same where that was too early: pytest-xdist starts sessions that are none of its workers, too."""
    if _in_tests:
        return (yield)
    if config.getini(CASES):
        from .whole_session import begin

        begin(config)
    status = yield
    if f"{__name__}.whole_session" in sys.modules:  # it began
        from .whole_session import end

        return end(int(status or 0))
    return status


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtestloop(session: pytest.Session) -> Iterator[None]:
    """Begin the guard of the whole session, too, if a collected test asks for runs."""
    if not _in_tests and asks_for_runs(session.items):
        from .whole_session import begin

        begin(session.config)
    return (yield)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    if file_path.suffix != ".toml" or not parent.config.getini(CASES):
        return None
    from .collect import case_file

    return case_file(file_path, parent)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Whose figures are told meanwhile: runs may come from fixtures of any scope, and outlive a test."""
    item.config.stash[current] = item
    _in_tests.append(item)
    try:
        return (yield)
    finally:
        _in_tests.pop()
        del item.config.stash[current]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    from .figures import table

    reports = [report for group in terminalreporter.stats.values() for report in group]
    lines = table(reports)
    if lines:
        terminalreporter.write_sep("=", "periph-sim budgets")
        for line, good in lines:
            terminalreporter.write_line(line, red=not good)


@pytest.fixture(scope="session")
def scene(pytestconfig: pytest.Config) -> SceneFactory:
    """scene(file or firmware function, *changes, seconds=None, record=False, ...) -> Run: builds and runs a case."""
    from .fixtures import SceneFactory

    return SceneFactory(pytestconfig)


@pytest.fixture
def case_run(request: pytest.FixtureRequest, scene: SceneFactory) -> Run:
    """The run of the case that the nearest mark `case` names."""
    mark = request.node.get_closest_marker("case")
    if mark is None:
        pytest.fail('fixture case_run: the test has no mark; add @pytest.mark.case("timing/mine.toml")', pytrace=False)
    return scene(*mark.args, **mark.kwargs)


def asks_for_runs(items: Iterable[pytest.Item]) -> bool:
    """Return True if any of the tests uses a fixture of this plugin."""
    for item in items:
        known = getattr(getattr(item, "_fixtureinfo", None), "name2fixturedefs", {})
        for name in ("scene", "case_run"):
            if any(one.func.__module__ == __name__ for one in known.get(name, ())):
                return True
    return False
