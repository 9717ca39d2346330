"""The pytest plugin. It runs case files as tests and provides fixtures for runs, figures for JUnit and a summary table.

    periph_sim_cases = timing  --> one test per budget of each case file (collect.py)
    scene(...), @mark.case     --> a run for a test (fixtures.py, runs.py)
    figures of judged budgets --> user_properties --> JUnit XML, terminal summary (figures.py)

pytest loads this module wherever periph_sim is installed, so this module imports only pytest. Models and numpy are
imported when the first case is built. `-p no:periph-sim` turns the plugin off.

A case is a TOML file with a simulated system and its budgets, which are limits for measured values. The figures of a
budget are its worst value, its limit, its margin and other numbers of its verdict.
"""

from __future__ import annotations

import os
from collections.abc import Generator, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from .keys import CASES, current

if TYPE_CHECKING:
    from ...supervisor import Completion
    from .fixtures import SceneFactory
    from .runs import Run


MARKER = (
    "case(file, *changes, seconds=None, record=False): "
    "the case that fixture case_run runs, with KEY=VALUE changes as for periph-sim run --set"
)
_in_tests: list[pytest.Item] = []  # the running tests; more than one if a test itself runs a pytest session
_completion: Completion | None = None  # reports the end of the session to the parent process (see `_begin`)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addini(CASES, "folders or files of periph-sim cases (*.toml), each budget of which is a test", "paths", [])


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", MARKER)
    for place in config.getini(CASES):
        if not place.exists():
            from ...core.phrases import did_you_mean

            there = did_you_mean(place.name, sorted(entry.name for entry in config.rootpath.iterdir()))
            raise pytest.UsageError(f"{CASES}: there is no folder or file {str(place)!r}; {there}")


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_load_initial_conftests(early_config: pytest.Config) -> Iterator[None]:
    """If the session has cases, start its child process (see `_begin`) before conftest.py is loaded."""
    if not _in_tests and early_config.getini(CASES) and "PYTEST_XDIST_WORKER" not in os.environ:
        _begin(early_config)
    return (yield)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> Generator[None, int | None, int | None]:
    """Call `_begin` for a session with cases. At the end of the session, call `_end`.

    `pytest_load_initial_conftests` has not called `_begin` if PYTEST_XDIST_WORKER is set. This variable is set in the
    workers of pytest-xdist, which need no child process, and also in sessions that the tests of a worker start, which
    need one. Here `_begin` can distinguish them.
    """
    if _in_tests:
        return (yield)
    if config.getini(CASES):
        _begin(config)
    status = yield
    return status if _completion is None else _end(_completion, int(status or 0))


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtestloop(session: pytest.Session) -> Iterator[None]:
    """Start the child process (see `_begin`), if it is not started yet and a collected test uses a fixture for runs."""
    if not _in_tests and asks_for_runs(session.items):
        _begin(session.config)
    return (yield)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    if file_path.suffix != ".toml" or not parent.config.getini(CASES):
        return None
    from .collect import case_file

    return case_file(file_path, parent)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Store which test is running. The results of the budgets that are judged during the test become its properties.

    A run cannot be assigned to one test when it is made, because several tests may share the run of a fixture.
    """
    item.config.stash[current] = item
    _in_tests.append(item)
    try:
        return (yield)
    finally:
        _in_tests.pop()
        del item.config.stash[current]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    from .figures import table

    lines = table(report for group in terminalreporter.stats.values() for report in group)
    if lines:
        terminalreporter.write_sep("=", "periph-sim budgets")
        for line, good in lines:
            terminalreporter.write_line(line, red=not good)


@pytest.fixture(scope="session")
def scene(pytestconfig: pytest.Config) -> SceneFactory:
    """Return a function that builds and runs a case.

    Call this function as scene(file or firmware function, *changes, seconds=None, record=False, ...) -> Run.
    """
    from .fixtures import SceneFactory

    return SceneFactory(pytestconfig)


@pytest.fixture
def case_run(request: pytest.FixtureRequest, scene: SceneFactory) -> Run:
    """Run the case named in the nearest mark `case`."""
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


def _begin(config: pytest.Config) -> None:
    """Continue the session in a child process, for which this process waits. Do nothing if this is the child process.

    Firmware that ends its process, for instance by `os._exit(0)`, would end the session with status 0, which means that
    all tests passed. With the child process, such a session has status 3, which pytest uses for internal errors. A
    worker of pytest-xdist needs no child process, because the session fails if a worker ends.
    """
    global _completion
    from ...supervisor import can_fork, split

    if _completion is None and can_fork and not hasattr(config, "workerinput"):
        _completion = split("pytest", strict=False)


def _end(completion: Completion, status: int) -> int:
    """Report that the session is complete, and return its exit status.

    If some output could not be written, return status 3 in place of 0, and do not report the session as complete.
    """
    global _completion
    from ...supervisor import NO_VERDICT

    if status == 0 and completion.flaw():
        return NO_VERDICT
    completion.complete(status)
    _completion = None
    return status
