"""pytest loads the plugin in every project: it must import nothing heavy, and it can be turned off."""

from __future__ import annotations

import pytest

LIGHT = """
import sys

def test_start():
    ours = {name.removeprefix("periph_sim") for name in sys.modules if name.startswith("periph_sim")}
    plugin = ".interfaces.pytest_plugin"
    assert ours == {"", ".form", ".interfaces", plugin, plugin + ".keys"}  # form: the choice of the core
    assert not {"pydantic", "numpy", "greenlet", "rich", "click", "drawsvg"} & set(sys.modules)
"""


def test_the_plugin_imports_heavy_modules_only_when_they_are_used(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(LIGHT)
    result = pytester.runpytest_subprocess("-p", "no:hypothesispytest", "-p", "no:cov", "-p", "no:cacheprovider")
    result.assert_outcomes(passed=1)


def test_the_plugin_can_be_turned_off(project: pytest.Pytester) -> None:
    result = project.runpytest_subprocess("-p", "no:periph-sim")
    assert result.ret == pytest.ExitCode.NO_TESTS_COLLECTED
    assert "periph-sim budgets" not in result.stdout.str()


def test_the_marker_is_listed(pytester: pytest.Pytester) -> None:
    result = pytester.runpytest_inprocess("--markers")
    result.stdout.fnmatch_lines(["@pytest.mark.case(file, *changes, seconds=None, record=False):*"])
