"""`check` repeats the runs of the worst values of a coverage file: equal values, and differences that are findings."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from periph_sim.core.tolerance import Cycles
from periph_sim.interfaces.reports.baselines.check import STOPPED, CaseCheck, _covered, check
from periph_sim.interfaces.reports.baselines.files import BadCheck
from periph_sim.interfaces.reports.coverage_check import CoverageCheck, check_coverage
from periph_sim.scene.scene import Scene
from tests.interfaces.reports.baselines.desk import put
from tests.interfaces.reports.covered_desk import CASE, change_coverage, put_case

FILE = "cases/coverage/small.json"
AT = "phases 9.2375000 to 9.2377000 ms"
OTHER = f"{FILE}: is no coverage of this version of periph-sim"
RENEW = "prove --save renews it"
HELD = f"{FILE}: 2 budgets held at 31 of 1,500,000 phases"


HOST = CASE[CASE.index("[host]") : CASE.index("[[budget]]")]


def checked(update: bool = False) -> tuple[CaseCheck, CoverageCheck]:
    (one,) = check(["cases"], jobs=1, update=update)
    return one, one.coverage


def texts(found: CaseCheck | CoverageCheck) -> list[str]:
    if isinstance(found, CaseCheck):
        return [one.text for one in found.findings]
    return [text for _, text in found.findings]


def edit(case: Path, old: str, new: str) -> None:
    assert old in CASE
    case.write_text(CASE.replace(old, new), encoding="utf-8")


def test_values_that_match_are_no_finding(covered: Path):
    one, coverage = checked()
    assert (one.state, texts(one), coverage.state) == ("equal", [], "as saved")
    assert (coverage.file, coverage.report.line) == (Path(FILE), HELD)


def test_a_broken_worst_phase_is_found_though_the_run_and_its_baseline_are_unchanged(covered: Path):
    """The service routine takes 100 us instead of 20 us. In the ordinary run, it interrupts idle firmware."""
    put_case(Path("cases"), service=15_000)
    one, coverage = checked()
    assert (one.state, one.outcome.not_passed, coverage.state) == ("equal", [], "changed")
    (finding,) = one.findings
    value = "91.360 us is over its limit of 60.000 us, at 0.235290 s"
    assert finding.text == f"response breaks at {AT}: {value}; it was 11.360 us in {FILE}; {RENEW}"
    assert (finding.budget, CASE.splitlines()[finding.line - 1]) == ("response", "[[budget]]")


def test_firmware_that_has_changed_without_effect_is_out_of_date_but_no_finding(covered: Path):
    put_case(Path("cases"), comment="# a comment\n")
    one, coverage = checked()
    assert (texts(one), coverage.state) == ([], "out of date")
    text = f"{FILE} is out of date: firmware.py has changed; its 2 worst values are as saved"
    assert (coverage.report.line, coverage.report.worst) == (text, {})


def test_a_value_that_differs_within_its_limit_is_a_finding_unless_the_tolerance_allows_it(covered: Path):
    put_case(Path("cases"), service=3008)
    text = f"response at {AT}: 11.360 us in {FILE} -> 11.373 us; {RENEW}"
    assert texts(check_coverage(covered)) == [text]
    assert texts(check_coverage(covered, (), 1)) == [text]
    for tolerance in (2, Cycles(Fraction(2)), Fraction(14, 10**9)):
        assert check_coverage(covered, (), tolerance).state == "out of date"


def test_values_of_equal_text_are_shown_exactly(covered: Path):
    text = Path(FILE).read_text(encoding="utf-8")
    assert text.count('"worst": 11.36\n') == 1
    Path(FILE).write_text(text.replace('"worst": 11.36\n', '"worst": 11.3604\n'), encoding="utf-8")
    assert texts(check_coverage(covered)) == [f"response at {AT}: 11.3604 us in {FILE} -> 11.36 us; {RENEW}"]


def test_a_tightened_limit_breaks_at_the_same_value(covered: Path):
    edit(covered, '"60 us"', '"11 us"')
    one, coverage = checked()
    assert coverage.state == "changed" and one.outcome.not_passed == []
    assert [text.partition(":")[0] for text in texts(one)] == [f"response breaks at {AT}"]


@pytest.mark.parametrize(
    ("old", "new", "finding"),
    [
        ('name = "response"', 'name = "reply"', f"response: it is in {FILE}, but no budget that can be covered"),
        ('measure = "response"', 'measure = "stretch"', f"response: {FILE} has the measure 'response', not 'stretch'"),
        ('period = "10 ms"\n[[', 'period = "9 ms"\n[[', "there were 1,500,000, and are 1,350,000"),
        ("[host]", "[unit.dsp.unused]", f"{FILE}: its runs cannot be made again: cases/small.toml"),
        ('modules = ["I2C-A"', 'pll = 8\nmodules = ["I2C-A"', "a cycle was 6666.67 ps, and is 8333.33 ps"),
        ("[controller]", "[fault.none]", f"{FILE}: its runs cannot be made again: cases/small.toml"),
        (HOST, "", "the starts of rounds move, and moved those of frames"),
    ],
)
def test_a_case_whose_values_cannot_be_compared_is_a_finding(covered: Path, old: str, new: str, finding: str):
    edit(covered, old, new)
    found = check_coverage(covered)
    (text,) = texts(found)
    assert finding in text and text.endswith(RENEW) and found.state == "changed"


def test_a_run_that_is_ended_is_one_finding_for_each_run(covered: Path):
    put_case(Path("cases"), does="raise ValueError('no')")
    found = check_coverage(covered)
    first, second = found.findings
    assert first[0] is None and first[1].startswith(f"at {AT} of {FILE}, the run is ended: ") and "no" in first[1]
    assert "at phase 9.2" in second[1] and found.state == "changed"


def test_firmware_that_waits_for_ever_at_a_phase_is_a_finding_unless_it_was_saved(covered: Path):
    put_case(Path("cases"), does="self.dsp.spin(lambda: self.sci.SCIFFRX.RXFFOVF == 1)")
    stuck = "SCL is held low by dsp.GPIO33 at 70.295 ms: dsp waits for SCI-A.SCIFFRX.RXFFOVF since 64.673 ms"
    value = f"response at {AT}: 11.360 us in {FILE} -> 5.000 us; {RENEW}"
    places = (AT, "phase 9.2376267 ms")
    assert texts(check_coverage(covered)) == [*(f"at {at} of {FILE}: {stuck}; {RENEW}" for at in places), value]
    found = json.loads(Path(FILE).read_text(encoding="utf-8"))["found"]
    found["failed"] = {"1385644": ["stuck"]}
    change_coverage(covered, found=found)
    assert texts(check_coverage(covered)) == [f"at {AT} of {FILE}: {stuck}; {RENEW}", value]
    found["drifting"] = [{"names": ["stuck"], "first": 1385625, "last": 1385655}]
    change_coverage(covered, found=found)
    assert texts(check_coverage(covered)) == [value]


@pytest.mark.parametrize(
    ("contents", "finding"),
    [
        ("no JSON", f"{OTHER} (JSON is malformed"),
        ("{}", f"{OTHER} (Object missing required field"),
        (
            '{"version": 2}',
            f"{OTHER} (Invalid enum value 2 - at `$.version`",
        ),
    ],
)
def test_a_damaged_file_is_a_finding_and_the_case_is_judged(covered: Path, contents: str, finding: str):
    Path(FILE).write_text(contents, encoding="utf-8")
    one, coverage = checked()
    assert (coverage.state, one.state, len(one.outcome.verdicts)) == ("unreadable", "equal", 2)
    (text,) = texts(one)
    assert text.startswith(finding) and text.endswith("write it again with prove --save")


def test_an_incomplete_file_is_shown_and_its_values_are_compared(covered: Path):
    change_coverage(covered, finished=0, windows=None)
    one, coverage = checked()
    assert (texts(one), coverage.state, coverage.report.worst) == ([], "incomplete", {})
    assert coverage.report.line == f"{FILE} is not complete: 0 of 1 parts; prove --save continues it"
    put_case(Path("cases"), service=15_000)
    assert checked()[1].state == "changed"


def test_changes_of_the_case_are_applied_to_the_runs(covered: Path):
    (one,) = check(["cases"], jobs=1, changes=["budget.response.max=11 us"])
    assert one.coverage is not None and texts(one)[0].startswith(f"response breaks at {AT}")
    found = check_coverage(covered, ("budget.response.max=50 us",))
    assert (found.state, found.report.line.partition(";")[0]) == (
        "out of date",
        f"{FILE} is out of date: budget.response.max=50 us is set",
    )


def test_each_run_is_made_once_for_all_its_values(covered: Path, monkeypatch: pytest.MonkeyPatch):
    """Without a coverage file, only the ordinary run is made."""
    runs: list[Scene] = []
    real = Scene.run
    monkeypatch.setattr(Scene, "run", lambda scene, *args: runs.append(scene) or real(scene, *args))
    check_coverage(covered)
    assert len(runs) == 2
    found = json.loads(Path(FILE).read_text(encoding="utf-8"))["found"]
    found["worst"]["wrong bytes"]["phases"] = found["worst"]["response"]["phases"]
    change_coverage(covered, found=found)
    check_coverage(covered)
    assert len(runs) == 3
    Path(FILE).unlink()
    (one,) = check(["cases"], jobs=1)
    assert (one.coverage, one.findings, len(runs)) == (None, [], 4)


def test_a_file_that_is_removed_meanwhile_is_a_finding(covered: Path):
    Path(FILE).unlink()
    assert texts(check_coverage(covered)) == [f"{FILE}: it has been removed during the check"]


def test_a_process_that_dies_in_a_run_is_a_finding():
    def dies() -> CoverageCheck:
        raise BadCheck("small.toml: its process died")

    case: Any = SimpleNamespace(outcome=SimpleNamespace(path=Path("cases/small.toml")))
    found = _covered(dies, case, None)
    assert found is not None and found.findings == ((None, "at a phase of its coverage: small.toml: its process died"),)


def test_a_stopped_check_says_that_the_values_were_not_run(covered: Path):
    def stop(part: float) -> None:
        raise KeyboardInterrupt

    put(Path("cases"), "z")
    (one,) = check(["cases"], jobs=1, on_progress=stop, on_refused=lambda refused: None)
    assert one.coverage is not None and one.passed
    assert (one.coverage.state, one.coverage.report.line) == ("not run", f"{FILE}: {STOPPED}")


def test_new_baselines_leave_the_coverage_file_and_its_findings(covered: Path):
    before = Path(FILE).read_bytes()
    put_case(Path("cases"), service=15_000)
    one, coverage = checked(update=True)
    assert (one.passed, coverage.state, Path(FILE).read_bytes()) == (False, "changed", before)
