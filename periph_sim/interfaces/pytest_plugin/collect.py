"""Collect case files as tests: one test per budget of each TOML file in a folder of `periph_sim_cases`.

    timing/mine.toml --> timing/mine.toml::hangs nowhere    passes if nothing waits forever
                         timing/mine.toml::response         passes if the budget holds (and is proven, see below)
                         timing/mine.toml::coverage         fails if a worst value of its coverage file is not as saved

There is a test "coverage" only if the case has a coverage file, which `periph-sim prove --save` writes.

The case is run once per process, by the first of its tests. The other tests use the same run. For a budget that the
case lists in `breaks`, the test is expected to fail because the limit is broken. If such a budget is not judged, this
is an unexpected failure. With `guaranteed = true` in the settings of the case's project, each other budget must be
proven.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from ...processor.user_code import output_muted
from ...proof.saved_paths import coverage_path
from ...scene.case.discover import is_case
from ...scene.case.load import load
from ...scene.project import project_of
from ..commands.command_frame import is_mistake
from .figures import properties
from .keys import CASES
from .runs import Plan, Run, run_plan

HANGS = "hangs nowhere"
COVERAGE = "coverage"
KNOWN = "known to break"


def case_file(path: Path, parent: pytest.Collector) -> CaseFile | None:
    """Return the collector of a case file; None if it is no case or is not at a path of ini option periph_sim_cases."""
    wanted = [place.resolve() for place in parent.config.getini(CASES)]
    if not any(path.resolve().is_relative_to(place) for place in wanted) or not is_case(path):
        return None
    return CaseFile.from_parent(parent, path=path)


class CaseFile(pytest.File):
    """Collector of a case file, which runs the case once for all its tests."""

    def collect(self) -> Iterable[pytest.Item]:
        """Yield the tests. Raise CollectError, whose message is one sentence, if the case cannot be built."""
        try:
            self.settings = project_of(self.path.parent).settings
            self._plan = Plan(load(self.path))
            with output_muted():
                self._plan.scene()
        except Exception as error:
            if not is_mistake(error):
                raise
            raise self.CollectError(str(error)) from None
        self._run: Run | None = None
        self._failed: Exception | None = None
        yield CaseItem.from_parent(self, name=HANGS, number=None, line=1)
        for number, budget in enumerate(self._plan.case.budget):
            line = self._plan.case.line("budget", number)
            item = CaseItem.from_parent(self, name=budget.name, number=number, line=line)
            if budget.name in self._plan.case.breaks:
                item.add_marker(pytest.mark.xfail(reason=KNOWN, raises=AssertionError, strict=True))
            yield item
        if coverage_path(self.path).exists():
            yield CoverageItem.from_parent(self, name=COVERAGE, number=None, line=1)

    def run(self) -> Run:
        """Return the run of the case, which is made once for all tests. If it fails, every call raises the error."""
        if self._failed is not None:
            raise self._failed
        if self._run is None:
            try:
                self._run = run_plan(self._plan, lambda run, verdicts: None)
            except Exception as error:
                self._failed = error
                raise
        return self._run


class CaseItem(pytest.Item):
    """A test that a budget of a case holds, or that the case does not hang.

    number: the position of the budget among the budgets of the case, from 0; None to test that the case does not hang.
    line: the line of the budget in the case file, from 1.
    """

    def __init__(self, number: int | None, line: int, **more: Any) -> None:
        super().__init__(**more)
        self._number = number
        self._line = line

    def runtest(self) -> None:
        assert isinstance(self.parent, CaseFile)
        run = self.parent.run()
        if self._number is None:
            run.assert_not_stuck()
            return
        verdict = run.result.budgets[self._number]
        self.user_properties.extend(properties(run.result.case, verdict))
        must_break = self.get_closest_marker("xfail") is not None
        if not verdict.passed and not verdict.broken and must_break:
            pytest.fail(f"{verdict.name} is not judged, so it is unknown if it breaks: {verdict.found}", pytrace=False)
        run.assert_budgets(verdict.name, guaranteed=self.parent.settings.guaranteed and not must_break)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], *args: Any, **more: Any) -> Any:
        """Return the text of a failure: the broken budgets, the message of a user's error, or an internal traceback."""
        if isinstance(excinfo.value, AssertionError) or is_mistake(excinfo.value):
            return f"{excinfo.value}\n\n{self.nodeid.partition('::')[0]}:{self._line}"
        return super().repr_failure(excinfo, *args, **more)

    def reportinfo(self) -> tuple[Path, int, str]:
        return self.path, self._line - 1, f"{self.path.stem}: {self.name}"


class CoverageItem(CaseItem):
    """A test that repeats the runs with the worst values of the case's coverage file, and compares the values.

    A file that is out of date or incomplete does not make the test fail; a section of the report says so.
    """

    def runtest(self) -> None:
        from ..reports.coverage_check import check_coverage
        from ..reports.explain.chain import relative

        assert isinstance(self.parent, CaseFile)
        found = check_coverage(relative(self.path), (), self.parent.settings.tolerance)
        self.user_properties.append((f"periph-sim coverage of {self.path.stem}", found.state))
        self.add_report_section("call", "coverage", found.report.line)
        if found.findings:
            raise AssertionError("\n".join(text for _, text in found.findings))
