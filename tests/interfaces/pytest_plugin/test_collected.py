"""Case files as tests: which files are collected, their output, and the reports for failing and invalid cases."""

from __future__ import annotations

import re
import shutil
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from tests.interfaces.reports.covered_desk import put_case
from tests.proof.proven_slave import FIRMWARE, save_proof, write_slave

from .project import BARE_INI, SMALL

TIGHT = SMALL.replace('"60 us"', '"1 us"').replace('"1 ms"\n\n[[budget]]', '"2 us"\n\n[[budget]]')


def broken(project: pytest.Pytester) -> None:
    (project.path / "timing" / "small.toml").write_text(TIGHT)


FAULTY = "def main(dsp, settings):\n    dsp.module('I2C-A').I2CMDX.IRS = 1\n"
FAULT = "dsp: AttributeError at line 2 of faulty.py: I2C-A has no register 'I2CMDX'; did you mean I2CMDR*"
HANGS = """\
from periph_sim.firmware import start_i2c

def main(dsp, settings):
    with dsp.span("boot"):
        dsp.compute(9)
    start_i2c(dsp, own_address=0x50)
    dsp.spin(lambda: dsp.module("I2C-A").I2CSTR.AAS == 1)
"""
HUNG = """\
name = "hung"
duration = "1 ms"
[unit.dsp]
firmware = "hangs.py"
modules = ["I2C-A"]
[[budget]]
name = "boot"
measure = "span:boot"
max = "1 us"
"""


@pytest.mark.parametrize(
    ("files", "args", "outcomes", "lines"),
    [
        pytest.param(
            {},
            ["-v"],
            {"passed": 4},
            [
                "timing/small.toml::hangs nowhere PASSED*",
                "timing/small.toml::response PASSED*",
                "timing/small.toml::round complete PASSED*",
                "timing/small.toml::wrong bytes PASSED*",
                "*= periph-sim budgets =*",
                " case/budget*seen*limit*when",
                " small/response*us*60 us*s  seen",
                " small/round complete*us*1 ms*s  seen",
                " small/wrong bytes*0*0*-  seen",
            ],
            id="a case is a test for each budget",
        ),
        pytest.param({}, ["-k", "response"], {"passed": 1, "deselected": 3}, [], id="one budget"),
        pytest.param({}, ["-k", "small and complete"], {"passed": 1, "deselected": 3}, [], id="one budget of a case"),
        pytest.param({}, ["timing/small.toml::wrong bytes"], {"passed": 1}, [], id="one budget by its path"),
        pytest.param(
            {"faulty.py": FAULTY, "small.toml": SMALL.replace('"responder"', '"faulty.py"')},
            [],
            {"failed": 4},
            [FAULT] * 4,
            id="an error of the run is reported by each of its tests",
        ),
        pytest.param(
            {"hangs.py": HANGS, "small.toml": HUNG},
            ["-v"],
            {"passed": 1, "failed": 1},
            ["*hangs nowhere FAILED*", "*boot PASSED*", "hung hangs:", "dsp waits for *AAS*for ever*"],
            id="a case that hangs fails although its budgets hold",
        ),
        pytest.param(
            {"small.toml": 'breaks = ["response", "wrong bytes"]\n' + TIGHT},
            ["-v"],
            {"passed": 1, "failed": 2, "xfailed": 1},
            [
                "timing/small.toml::response XFAIL (known to break)*",
                "timing/small.toml::round complete FAILED*",
                "timing/small.toml::wrong bytes FAILED*",
                "[[]XPASS(strict)] known to break",
                " small/response * broken, as expected",
                " small/round complete * broken",
                " small/wrong bytes * seen",
            ],
            id="a budget that is to break must break",
        ),
        pytest.param(
            # No device answers, so nothing was measured, which does not prove the bug either.
            {"small.toml": 'breaks = ["response"]\n' + SMALL.replace("address = 0x50", "address = 0x51")},
            ["-k", "response"],
            {"failed": 1, "deselected": 3},
            ["*response is not judged, so it is unknown if it breaks*"],
            id="a known bug that is not judged fails",
        ),
        pytest.param(
            {"../pyproject.toml": "[tool.mine]\n", "../elsewhere.toml": "not even TOML"},
            [],
            {"passed": 4},
            [],
            id="other TOML files are left alone",
        ),
    ],
)
def test_a_case_is_collected(
    project: pytest.Pytester, files: dict[str, str], args: list[str], outcomes: dict[str, int], lines: list[str]
) -> None:
    for name, text in files.items():
        (project.path / "timing" / name).write_text(text)
    result = project.runpytest_inprocess(*args)
    result.assert_outcomes(**outcomes)
    result.stdout.fnmatch_lines(lines)


def test_a_case_runs_once_for_all_its_tests(project: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    from periph_sim.scene.scene import Scene

    runs = []
    real = Scene.run
    monkeypatch.setattr(Scene, "run", lambda scene, *args: runs.append(scene) or real(scene, *args))
    project.runpytest_inprocess().assert_outcomes(passed=4)
    assert len([scene for scene in runs if scene.limits]) == 1  # scenes of bounds have no budgets


def test_a_broken_budget_reports_its_figures_and_shows_the_bus(project: pytest.Pytester) -> None:
    broken(project)
    result = project.runpytest_inprocess()
    result.assert_outcomes(passed=2, failed=2)
    result.stdout.fnmatch_lines(
        [
            "*_ small: response _*",
            "small: response * us, limit 1 us",
            " budget*seen*limit*margin*when  why",
            " response*us *1 us  -*us*s  the master gives up*",
            "response * us, at most 1.000 us allowed, at *",
            "*us  repeated START, two bytes (0x50 R)*",
            "* 5.000 us  100.0 %  bits of two bytes",
            "*v response: worst begins*",
            "*v ends, * us later*",
            "SCL  *┐ ┌─┐*",
            "     *┘ └─┘*",
            "SDA  *",
            "bytes*0x50 R*A*0x01*",
            "*+····*",
            "*us, from 0.00* s on",
            "timing/small.toml:20",
            "*_ small: round complete _*",
            "SCL  *░*",
            "bytes*S*0x50 W*A*0x00*Sr*0x50 R*0x02*N*P",
            "timing/small.toml:26",
            " small/response*broken",
            "FAILED timing/small.toml::response - small: response *",
        ]
    )
    assert "Traceback" not in result.stdout.str() and "runs.py" not in result.stdout.str()


def test_figures_are_properties_in_junit_xml(project: pytest.Pytester) -> None:
    broken(project)
    project.runpytest_inprocess("--junitxml=out.xml")
    root = ElementTree.parse(project.path / "out.xml").getroot()
    found = {case.attrib["name"]: properties(case) for case in root.iter("testcase")}
    assert found["hangs nowhere"] == {}
    head = "periph-sim/small/response/"
    response = {name.removeprefix(head): value for name, value in found["response"].items()}
    response.pop("which", None)  # present only with several limits
    names = ["verdict", "unit", "worst_us", "limit_us", "margin_us"]
    names += ["count", "measured", "occasions", "at_s"]
    assert list(response) == names
    assert response["verdict"] == "broken" and response["limit_us"] == "1.0" and response["count"] == "3"
    assert float(response["worst_us"]) + float(response["margin_us"]) == 1.0
    assert found["wrong bytes"]["periph-sim/small/wrong bytes/worst"] == "0"


def properties(case: ElementTree.Element) -> dict[str, str]:
    return {one.attrib["name"]: one.attrib["value"] for one in case.iter("property")}


def test_xdist_workers_print_the_same_table(project: pytest.Pytester) -> None:
    broken(project)
    alone = project.runpytest_inprocess()
    spread = project.runpytest_subprocess("-n", "2")
    spread.assert_outcomes(passed=2, failed=2)
    assert table(spread) == table(alone) != []


def table(result: pytest.RunResult) -> list[str]:
    """Return the lines of the summary sorted, because workers finish in any order."""
    return sorted(line for line in result.outlines if line.startswith(" small/"))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('measure = "response"', 'measure = "respons"'), r"small.toml, line \d+: budget.response.measure: there is no "
         r"measure 'respons'; did you mean response\?"),
        (('max = "60 us"', 'maks = "60 us"'), r"small.toml, line \d+: there is no key 'budget.response.maks'; "
         r".* max.*"),
        (('"responder"', '"respnder"'), r"small.toml, line \d+: unit.dsp.firmware: there is no firmware 'respnder'; "
         r"did you mean responder or responder_declared\?"),
        (("[unit.dsp]", "[unit.dsp"), r"small.toml, line \d+: it is not TOML: .*"),
    ],
)  # fmt: skip
def test_an_invalid_case_is_one_error_message(project: pytest.Pytester, change: tuple[str, str], message: str) -> None:
    (project.path / "timing" / "small.toml").write_text(SMALL.replace(*change))
    result = project.runpytest_inprocess()
    result.assert_outcomes(errors=1)
    assert result.ret == pytest.ExitCode.INTERRUPTED
    lines = result.outlines
    begin = next(number for number, line in enumerate(lines) if "ERROR collecting timing/small.toml" in line)
    assert re.search(message + "$", lines[begin + 1]), lines[begin + 1]
    assert lines[begin + 2].startswith("===")


def test_a_firmware_file_is_found_from_any_folder(project: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    firmware = project.mkdir("firmware")
    (firmware / "mine.py").write_text("from firmware.python.responder import Settings, main  # noqa: F401\n")
    (project.path / "timing" / "small.toml").write_text(SMALL.replace('"responder"', '"../firmware/mine.py"'))
    project.runpytest_inprocess().assert_outcomes(passed=4)
    monkeypatch.chdir(project.path / "timing")
    project.runpytest_inprocess("small.toml").assert_outcomes(passed=4)


def test_nothing_is_collected_without_the_option(project: pytest.Pytester) -> None:
    (project.path / "pytest.ini").write_text(BARE_INI)
    result = project.runpytest_inprocess()
    assert result.ret == pytest.ExitCode.NO_TESTS_COLLECTED
    assert "periph-sim budgets" not in result.stdout.str()


def test_a_missing_folder_is_a_usage_error(project: pytest.Pytester) -> None:
    (project.path / "pytest.ini").write_text(f"{BARE_INI}periph_sim_cases = timings\n")
    result = project.runpytest_inprocess()
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(
        ["ERROR: periph_sim_cases: there is no folder or file '*timings'; did you mean timing?"]
    )


def test_a_coverage_file_is_one_more_test(project: pytest.Pytester, covered_once: Path) -> None:
    shutil.copytree(covered_once, project.path / "timing", dirs_exist_ok=True)
    result = project.runpytest_inprocess("-v", "-rP", "--junitxml=out.xml")
    result.assert_outcomes(passed=4)
    result.stdout.fnmatch_lines(
        [
            "timing/small.toml::wrong bytes PASSED*",
            "timing/small.toml::coverage PASSED*",
            "*- Captured coverage call -*",
            "timing/coverage/small.json: 2 budgets held at 31 of 1,500,000 phases",
        ]
    )
    report = (project.path / "out.xml").read_text(encoding="utf-8")
    assert '<property name="periph-sim coverage of small" value="as saved" />' in report
    put_case(project.path / "timing", service=15_000)
    result = project.runpytest_inprocess()
    result.assert_outcomes(passed=3, failed=1)
    at = "phases 9.2375000 to 9.2377000 ms"
    result.stdout.fnmatch_lines(
        [
            "*_ small: coverage _*",
            f"response breaks at {at}: 91.360 us is over its limit of 60.000 us, *; it was 11.360 us in timing/*",
            "timing/small.toml:1",
        ]
    )
    put_case(project.path / "timing", service=3008)
    project.makefile(".toml", pyproject="[tool.periph-sim]\ntolerance = 2\n")
    project.runpytest_inprocess("-k", "coverage").assert_outcomes(passed=1, deselected=3)


GUARANTEED = "[tool.periph-sim]\nguaranteed = true\n"


def test_a_project_can_require_a_proof_of_each_budget(project: pytest.Pytester) -> None:
    project.makefile(".toml", pyproject=GUARANTEED)
    result = project.runpytest_inprocess("-v")
    result.assert_outcomes(passed=1, failed=3)
    why = "small: no budget is proven: there is no timing/proofs/small.json; prove --table --save writes it"
    assert result.outlines.count(why) == 3
    result.stdout.fnmatch_lines(["timing/small.toml::hangs nowhere PASSED*"])


def test_a_proven_budget_passes_until_its_proof_is_out_of_date(project: pytest.Pytester) -> None:
    project.makefile(".toml", pyproject=GUARANTEED)
    (project.path / "timing" / "small.toml").unlink()
    case = write_slave(project.path / "timing", "")
    save_proof(case)
    result = project.runpytest_inprocess("--junitxml=report.xml")
    result.assert_outcomes(passed=2)
    result.stdout.fnmatch_lines(["*image_register_slave/wrong bytes *proven"])
    assert '/verdict" value="proven" />' in (project.path / "report.xml").read_text(encoding="utf-8")
    firmware = project.path / "timing" / FIRMWARE
    firmware.write_text(firmware.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    result = project.runpytest_inprocess()
    result.assert_outcomes(passed=1, failed=1)
    why = f"timing/proofs/slave.json is out of date: {FIRMWARE} has changed; write it again with prove --table --save"
    assert f"image_register_slave: no budget is proven: {why}" in result.outlines


def test_a_known_bug_needs_no_proof_and_must_break(project: pytest.Pytester) -> None:
    project.makefile(".toml", pyproject=GUARANTEED)
    (project.path / "timing" / "small.toml").write_text('breaks = ["response", "wrong bytes"]\n' + TIGHT)
    result = project.runpytest_inprocess("-k", "response or wrong")
    result.assert_outcomes(failed=1, xfailed=1, deselected=2)
    result.stdout.fnmatch_lines(["[[]XPASS(strict)] known to break"])


def test_an_unknown_key_of_the_project_is_an_error(project: pytest.Pytester) -> None:
    project.makefile(".toml", pyproject="[tool.periph-sim]\nguarantee = true\n")
    result = project.runpytest_inprocess()
    result.assert_outcomes(errors=1)
    why = "pyproject.toml, line 2: there is no key 'tool.periph-sim.guarantee'; did you mean guaranteed?"
    assert why in result.outlines
