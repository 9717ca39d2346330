"""A rule is proved only by a test that pytest has collected and run, and that passed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

PROJECT = """
import pytest

TABLE = [pytest.param(1, marks=pytest.mark.rule("I2C-002")), 2]  # one case of one test names it
UNUSED = pytest.mark.rule("I2C-003")
rule = pytest.mark.rule


@rule("I2C-001")
def test_passes(): ...

@pytest.mark.parametrize("n", TABLE)
def test_of_a_table(n): ...

def test_beside_it(): ...

@pytest.mark.rule("I2C-004")
def test_fails(): assert False

@pytest.mark.rule("I2C-005")
@pytest.mark.skip
def test_skipped(): ...

@pytest.mark.rule("I2C-006")
def test_skips_itself(): pytest.skip()

@pytest.mark.rule("I2C-008")
@pytest.mark.xfail(strict=False)
def test_expected_to_fail(): assert False

@pytest.mark.rule("I2C-009")
@pytest.mark.xfail(strict=False)
def test_expected_to_fail_but_passes(): ...

@pytest.fixture
def broken(): raise ValueError

@pytest.fixture
def breaks_later():
    yield
    raise ValueError

@pytest.mark.rule("I2C-010")
def test_without_its_fixture(broken): ...

@pytest.mark.rule("I2C-011")
def test_whose_fixture_fails_later(breaks_later): ...

@pytest.mark.rule("I2C-012")
class TestClass:
    @pytest.mark.rule("I2C-013", "I2C-014")
    def test_in_a_class(self): ...
"""

OUTCOMES = {
    "test_passes": (["I2C-001"], "passed"),
    "test_of_a_table[1]": (["I2C-002"], "passed"),
    "test_fails": (["I2C-004"], "failed"),
    "test_skipped": (["I2C-005"], "skipped"),
    "test_skips_itself": (["I2C-006"], "skipped"),
    "test_expected_to_fail": (["I2C-008"], "expected failure"),
    "test_expected_to_fail_but_passes": (["I2C-009"], "expected failure"),
    "test_without_its_fixture": (["I2C-010"], "failed"),
    "test_whose_fixture_fails_later": (["I2C-011"], "failed"),
    "TestClass::test_in_a_class": (["I2C-013", "I2C-014", "I2C-012"], "passed"),
}


@pytest.fixture
def project(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> pytest.Pytester:
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))
    pytester.makepyfile(test_it=PROJECT)
    return pytester


def run(project: pytest.Pytester, *options: str) -> pytest.RunResult:
    started = project.runpytest_subprocess if "-n" in options else project.runpytest_inprocess
    return started("-p", "tests.rules.outcomes", "-p", "no:cacheprovider", *options)


def found(project: pytest.Pytester, file: str = "build/rules.json") -> dict[str, tuple[list[str], str]]:
    outcomes = json.loads((project.path / file).read_text(encoding="utf-8"))
    return {node.partition("::")[2]: (entry["rules"], entry["outcome"]) for node, entry in outcomes.items()}


@pytest.mark.parametrize("workers", [(), ("-n", "2")], ids=["one process", "xdist"])
def test_the_outcome_of_each_test_that_names_a_rule_is_written(
    project: pytest.Pytester, workers: tuple[str, ...]
) -> None:
    run(project, "--rules", "build/rules.json", *workers)
    assert found(project) == OUTCOMES


def test_two_partial_runs_add_up_to_one_file(project: pytest.Pytester) -> None:
    run(project, "--rules", "build/rules.json", "-k", "table or fails")
    assert set(found(project)) < set(OUTCOMES)
    run(project, "--rules", "build/rules.json", "-k", "not (table or fails)", "-n", "2")
    assert found(project) == OUTCOMES


def test_a_test_that_is_not_run_has_no_outcome(project: pytest.Pytester) -> None:
    run(project, "--rules", "only.json", "-k", "test_passes")
    assert found(project, "only.json") == {"test_passes": (["I2C-001"], "passed")}


def test_without_the_option_nothing_is_written(project: pytest.Pytester) -> None:
    run(project)
    assert not (project.path / "build").exists()


def test_a_mark_that_names_no_rule_ends_the_run(project: pytest.Pytester) -> None:
    project.makepyfile(test_more='import pytest\n@pytest.mark.rule("I2C-343")\ndef test_it(): ...')
    came = run(project)
    assert came.ret == pytest.ExitCode.USAGE_ERROR
    came.stderr.fnmatch_lines(["*test_more.py::test_it: there is no rule I2C-343; see tests/rules/*.toml"])
