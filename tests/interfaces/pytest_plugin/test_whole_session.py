"""A session does not pass if user code ends its process, whether during collection, in a case or in a test."""

from __future__ import annotations

import pytest

from periph_sim.supervisor import can_fork

pytestmark = pytest.mark.skipif(not can_fork, reason="no fork here, so no process waits")

LOST = "pytest: user code ended the process with status 0 before its output was complete; exit status 3 is no verdict"
TEST = """
def ends(dsp, settings):
    dsp.compute(100)
    {code}

def test_one(scene):
    assert scene(ends, modules=["I2C-A"], seconds=0.001).result.simulated_s

def test_two():
    pass
"""
FIRMWARE = "import os\n{imported}\ndef main(dsp, settings):\n    {run}\n"


def run_case_session(project: pytest.Pytester, imported: str = "", run: str = "pass") -> pytest.RunResult:
    """Run a session of one case whose firmware executes this code."""
    folder = project.path / "timing"
    case = folder / "small.toml"
    case.write_text(case.read_text("utf-8").replace('"responder"', '"ends.py"'), encoding="utf-8")
    (folder / "ends.py").write_text(FIRMWARE.format(imported=imported, run=run), encoding="utf-8")
    return project.runpytest_subprocess()


@pytest.mark.parametrize("where", ["imported", "run"])
def test_an_exit_in_a_case_is_no_pass(project: pytest.Pytester, where: str):
    result = run_case_session(project, **{where: "os._exit(0)"})
    assert result.ret == 3 and result.errlines[-1] == LOST


def test_an_exit_in_firmware_of_a_test_is_no_pass(pytester: pytest.Pytester):
    pytester.makepyfile(TEST.format(code="__import__('os')._exit(0)"))
    result = pytester.runpytest_subprocess()
    assert result.ret == 3 and result.errlines[-1] == LOST


@pytest.mark.parametrize("code", ["os._exit(0)", "raise SystemExit(0)"])
def test_an_exit_of_conftest_is_no_pass(project: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, code: str):
    monkeypatch.delenv("PYTEST_XDIST_WORKER", raising=False)  # the session of this test may be an xdist worker
    project.makeconftest(f"import os\n{code}\n")
    result = project.runpytest_subprocess()
    assert result.ret == 3 and result.errlines[-1] == LOST


def test_system_exit_fails_its_test_and_the_others_run(pytester: pytest.Pytester):
    pytester.makepyfile(TEST.format(code="raise SystemExit(0)"))
    result = pytester.runpytest_subprocess()
    result.assert_outcomes(passed=1, failed=1)
    assert result.ret == 1 and "SystemExit at line 3 of test_system_exit" in result.stdout.str()


def test_skipping_in_firmware_is_no_pass(pytester: pytest.Pytester):
    pytester.makepyfile(TEST.format(code="__import__('pytest').skip('never mind')"))
    pytester.runpytest_subprocess().assert_outcomes(passed=1, failed=1)


@pytest.mark.parametrize(("code", "status"), [("pass", 0), ("1 / 0", 1)])
def test_a_session_that_ends_by_itself_has_its_own_status(pytester: pytest.Pytester, code: str, status: int):
    pytester.makepyfile(TEST.format(code=code))
    result = pytester.runpytest_subprocess()
    assert result.ret == status and not result.errlines
    assert result.stdout.lines[-1].count(" passed in ") or status


def test_wrong_usage_has_its_own_status(project: pytest.Pytester):
    assert project.runpytest_subprocess("--no-such-option").ret == pytest.ExitCode.USAGE_ERROR
    assert project.runpytest_subprocess("no_such_file.py").ret == pytest.ExitCode.USAGE_ERROR
