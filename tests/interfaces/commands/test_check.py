"""`periph-sim check`: exit status, table, JSON, JUnit file, annotations and error messages."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as xml

import pytest

from tests.interfaces.commands.conftest import Run
from tests.interfaces.reports.baselines.desk import change, put
from tests.interfaces.reports.covered_desk import put_case

ROOT = Path(__file__).parents[3]
TIMING = ROOT / "timing"
LONG = ("imu_hil", "imu_hil_published", "two_dsps")  # each takes seconds


def test_a_baseline_is_written_and_a_later_change_is_explained(periph_sim: Run, cases: Path):
    result = periph_sim("check", "--jobs", "1")
    assert (result.status, result.err) == (1, "")
    assert "check: 0 of 1 as they should be" in result.out and "missing" in result.out
    missing = "it has no baseline timing/baselines/small.json; write one with --update-baseline"
    assert f"timing/small.toml, line 1: {missing}" in result.out
    assert "\nwritten: timing/baselines/small.json\n" in periph_sim.passes("check", "--jobs", "1", "--update-baseline")
    assert "equal" in periph_sim.passes("check", "--jobs", "1")
    put(cases, wait=3000)
    result = periph_sim("check", "--jobs", "1")
    assert (result.status, result.err) == (1, "")
    moved = "response worst 750 -> 1543 cycles: I2C-A.I2CDXR written by dsp 3000 cycles later"
    assert f"timing/small.toml, line 19: {moved}\n" in result.out
    out = periph_sim.passes("check", "--jobs", "1", "--update-baseline")
    assert f"small: {moved}\n" in out and '\n-      "worst": 15000,\n' in out


def test_the_table_counts_budgets_by_verdict_and_its_columns_are_explained(periph_sim: Run, cases: Path):
    put(cases, "mute", sdir_wait=False, breaks='breaks = ["wrong bytes"]\n')
    text = (cases / "mute.toml").read_text(encoding="utf-8")
    never = '[[budget]]\nname = "never"\nmeasure = "period of bus address 0x11 read"\nmax = "1 s"\n'
    (cases / "mute.toml").write_text(text + never, encoding="utf-8")
    lines = periph_sim("check", "--jobs", "1").out.splitlines()
    at = lines.index("                         not   must")
    assert [line.split() for line in lines[at + 1 : at + 5]] == [
        ["case", "seen", "broken", "judged", "break", "baseline"],
        ["─" * len(lines[at + 2].strip())],
        ["mute", "2", "1", "1", "1", "missing", "fail"],
        ["small", "3", "0", "0", "0", "missing", "fail"],
    ]
    legend = "columns count budgets; must break: named in `breaks`; baseline: changed figures"
    assert lines[at + 6] == legend and max(map(len, lines[: at + 7])) <= 80


def test_json_of_equal_runs_is_equal_byte_for_byte_in_any_number_of_processes(periph_sim: Run, cases: Path):
    put(cases, "other", wait=3000)
    one = periph_sim("check", "--jobs", "1", "--json")
    two = periph_sim("check", "--jobs", "2", "--json")
    assert one == two and one.status == 1
    report = one.json_object
    assert report["verdict"] == "fail"
    other, small = report["cases"]
    assert (other["case"], small["case"]) == ("other", "small")
    assert small["baseline"] == {"file": "timing/baselines/small.json", "state": "missing"}
    assert small["figures"]["budgets"]["response"]["worst"] == 15000


def test_json_says_what_changed(periph_sim: Run, cases: Path):
    periph_sim("check", "--jobs", "1", "--update-baseline")
    put(cases, wait=3000)
    (case,) = periph_sim("check", "--jobs", "1", "--json").json_object["cases"]
    change = next(change for change in case["changes"] if change["figure"] == "worst")
    assert change == {
        "budget": "response",
        "figure": "worst",
        "before": 15000,
        "now": 30860,
        "note": False,
        "text": "response worst 750 -> 1543 cycles",
        "why": "I2C-A.I2CDXR written by dsp 3000 cycles later",
    }


def test_junit_is_written_and_annotations_follow_the_table(periph_sim: Run, cases: Path):
    result = periph_sim("check", "--jobs", "1", "--junit", "out.xml", "--annotations", "github")
    assert result.status == 1
    assert result.out.splitlines()[-1].startswith("::error file=timing/small.toml,line=1,title=")
    root = xml.parse("out.xml").getroot()
    assert (root.get("tests"), root.get("failures")) == ("4", "1")


def test_an_output_replaces_no_file_that_a_change_names(periph_sim: Run, cases: Path):
    put(cases, "other")
    put(Path("elsewhere"), "mine")
    firmware = Path("elsewhere/mine_firmware.py")
    before = firmware.read_bytes()
    change = f"unit.dsp.firmware=../{firmware}"
    assert "found a file that this command reads" in periph_sim.refused(
        "check", "--jobs", "2", "--set", change, "--junit", str(firmware)
    )
    assert firmware.read_bytes() == before


@pytest.mark.parametrize(
    ("tolerance", "status"), [("4", 1), ("5", 0), ("4 cycles", 1), ("5 cycles", 0), ("33 ns", 1), ("34ns", 0)]
)
def test_a_tolerance_is_a_time_or_cycles(periph_sim: Run, cases: Path, tolerance: str, status: int):
    """The worst response was 5 cycles longer in the baseline."""
    assert periph_sim("check", "--update-baseline", "--jobs", "1").status == 0
    change(cases / "baselines" / "small.json", worst=15100, worst_at=1)
    result = periph_sim("check", "--jobs", "1", "--tolerance", tolerance)
    assert result.status == status
    notice = f"--tolerance without a unit is obsolete; write --tolerance '{tolerance} cycles'\n"
    assert result.err == (notice if tolerance.isdecimal() else "")


def test_annotations_are_on_standard_error_with_json(periph_sim: Run, cases: Path):
    result = periph_sim("check", "--jobs", "1", "--json", "--annotations", "github")
    assert result.json_object["verdict"] == "fail"
    assert result.err.startswith("::error file=timing/small.toml,line=1,title=")


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["nowhere"], "nowhere: there is no such file or folder; give case files, or folders of them"),
        (["timing/small_firmware.py"], "timing/small_firmware.py, line 1: it is not TOML: "),
        (["--junit", "no/out.xml"], "no/out.xml, its place: found no such file or directory, expected a place that"),
        (["--tolerance", "-1 cycles"], "--tolerance: -1 cycles is negative; a tolerance is 0 or more"),
        (["--tolerance", "3 bits"], "--tolerance: '3 bits': unit 'bits' is none of ns"),
        (["--tolerance", "x cycles"], "--tolerance: 'x' is not a number"),
        (["--set", "duration=1 ms"], "--update-baseline with --set: a baseline is of the unchanged case; remove one"),
        (["--jobs", "0"], "Invalid value for '--jobs': 0 is not in the range x>=1."),
        (["--annotations", "gitlab"], "Invalid value for '--annotations': 'gitlab' is not 'github'."),
    ],
)
def test_bad_input_is_an_error_message_with_status_2(periph_sim: Run, cases: Path, arguments: list[str], sentence: str):
    assert sentence in periph_sim.refused(
        "check", "--update-baseline", *([] if "--jobs" in arguments else ["--jobs", "1"]), *arguments
    )
    assert not (cases / "baselines").exists()


def test_pyproject_sets_the_folders_of_cases_and_baselines_and_the_default_options(
    periph_sim: Run, cases: Path, monkeypatch: pytest.MonkeyPatch
):
    put(Path("bench"), "other")
    table = '[tool.periph-sim]\ncases = ["bench"]\nbaselines = "ci/figures"\nguaranteed = true\njobs = 1\n'
    Path("pyproject.toml").write_text(table, encoding="utf-8")
    assert "\nwritten: ci/figures/other.json\n" in periph_sim.passes("check", "--update-baseline", "--no-guaranteed")
    monkeypatch.chdir("timing")
    report = "there is no ../bench/proofs/other.json; prove --table --save writes it"
    result = periph_sim("run", "../bench/other.toml")
    assert result.status == 1 and f"guaranteed: no budget is proven: {report}" in result.err.splitlines()
    result = periph_sim("check")
    assert result.status == 1 and "no budget is proven: there is no " in result.out
    assert "small" not in periph_sim.passes("check", "--no-guaranteed")
    assert periph_sim("run", "../bench/other.toml", "--no-guaranteed").status == 0
    Path("../pyproject.toml").write_text("[tool.periph-sim]\ntolerence = 1\n", encoding="utf-8")
    for command in (("check",), ("run", "small.toml")):
        assert (
            "pyproject.toml, line 2: there is no key 'tool.periph-sim.tolerence'; did you mean tolerance"
            in periph_sim.refused(*command)
        )


def test_without_a_folder_timing_the_current_folder_is_searched(periph_sim: Run, here: Path):
    put(Path("bench"))
    assert "\nbench/small.toml, line 1: it has no baseline bench/baselines/small.json" in periph_sim("check").out


def test_a_case_that_raises_has_status_2_and_the_other_cases_are_judged(periph_sim: Run, cases: Path):
    assert periph_sim("check", "--jobs", "1", "--update-baseline").status == 0
    put(cases, "bad", does="raise ValueError('boom')")
    result = periph_sim("check", "--jobs", "1", "--junit", "out.xml", "--annotations", "github")
    assert result.status == 2 and "Traceback" not in result.out + result.err
    assert "check: 1 of 2 as they should be" in result.out
    assert "\nError: dsp: ValueError at line " in result.out
    assert "::error file=timing/bad.toml,line=1," in result.out
    suites = {suite.get("name"): suite for suite in xml.parse("out.xml").getroot()}
    assert (suites["bad"].get("errors"), suites["small"].get("errors")) == ("1", "0")
    assert suites["small"].get("failures") == "0"
    status, report = periph_sim.json("check", "--jobs", "1")
    assert status == 2 and report["verdict"] == "fail"
    assert [one["file"] for one in report["refused"]] == ["timing/bad.toml"] and len(report["cases"]) == 1


def test_a_case_that_is_driven_from_outside_is_named_and_not_run(periph_sim: Run, cases: Path):
    put(cases, "theirs")
    theirs = cases / "theirs.toml"
    theirs.write_text(theirs.read_text().replace("[controller]", '[outside]\nwires = ["SDA"]\n\n[controller]', 1))
    result = periph_sim("check", "--jobs", "1", "--update-baseline")
    assert (result.status, result.err) == (0, "") and not (cases / "baselines" / "theirs.json").exists()
    assert "check: 1 of 1 as they should be" in result.out
    assert "\ntiming/theirs.toml: driven from outside, so not run here\n" in result.out
    report = periph_sim("check", "--jobs", "1", "--json").json_object
    assert report["verdict"] == "pass" and [one["file"] for one in report["driven_from_outside"]] == [
        "timing/theirs.toml"
    ]
    files = ("--junit", "out.xml", "--html", "out.html", "--summary", "out.md")
    assert periph_sim("check", "--jobs", "1", *files).status == 0
    assert [suite.get("name") for suite in xml.parse("out.xml").getroot()] == ["small"]
    assert "1 of 1 as they should be" in Path("out.md").read_text() and "theirs" not in Path("out.html").read_text()
    message = periph_sim.refused("check", "--jobs", "1", "--html", "alone.html", str(theirs))
    assert message.startswith("there is nothing to check: timing/theirs.toml, line")
    assert not Path("alone.html").exists()


def test_a_run_does_not_import_the_command_line(cases: Path):
    """A worker process imports neither the command line nor its tables."""
    code = (
        "import sys; from pathlib import Path; from periph_sim.interfaces.reports.baselines.outcome import run_case\n"
        "print(run_case(Path('timing/small.toml')).broken)\n"
        "print(sorted({'click', 'rich', 'periph_sim.cli'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env={"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=True
    )
    assert done.stdout == "[]\n[]\n"


def test_every_case_of_the_repository_has_a_baseline():
    stems = [
        sorted(path.stem for path in folder.glob(f"*.{end}"))
        for folder, end in ((TIMING, "toml"), (TIMING / "baselines", "json"))
    ]
    assert stems[0] == stems[1]


SHORT = sorted(
    str(path.relative_to(TIMING))
    for folder in (TIMING, TIMING / "variants")
    for path in folder.glob("*.toml")
    if path.stem not in LONG
)


@pytest.mark.long
@pytest.mark.parametrize("case", SHORT)
def test_the_short_cases_of_the_repository_match_their_baselines(
    periph_sim: Run, monkeypatch: pytest.MonkeyPatch, case: str
):
    monkeypatch.chdir(ROOT)
    result = periph_sim("check", "--jobs", "1", f"timing/{case}")
    assert result.status == 0, result.out


def outputs(folder: Path) -> tuple[str, str, str]:
    """JUnit XML, the summary and the HTML report."""
    junit, summary, html = (folder / f"out.{suffix}" for suffix in ("xml", "md", "html"))
    return junit.read_text(encoding="utf-8"), summary.read_text(encoding="utf-8"), html.read_text(encoding="utf-8")


FILES = ("--junit", "out.xml", "--summary", "out.md", "--html", "out.html", "--annotations", "github")


def test_a_coverage_file_that_matches_is_a_column_and_a_line(periph_sim: Run, covered: Path, tmp_path: Path):
    put(Path("cases"), "z")
    result = periph_sim("check", "cases", "--jobs", "1", *FILES)
    lines = result.out.splitlines()
    assert lines[3].split() == ["case", "seen", "broken", "judged", "break", "baseline", "coverage"]
    assert lines[5].split() == ["small", "2", "0", "0", "0", "equal", "as", "saved", "pass"]
    assert lines[6].split() == ["z", "3", "0", "0", "0", "missing", "fail"]
    assert "coverage: worst values of prove --save, run again; other phases are not run" in lines
    held = "cases/coverage/small.json: 2 budgets held at 31 of 1,500,000 phases"
    assert held in lines and max(map(len, lines[:10])) <= 80
    assert "::notice" not in result.out
    junit, summary, html = outputs(tmp_path)
    assert junit.count('<property name="coverage" value="as saved" />') == 1 and junit.count('name="coverage"') == 1
    assert summary.count(f"\ncoverage as saved: {held}\n") == 1 == summary.count("coverage as saved")
    assert f'<p class="coverage quiet">{held}</p>' in html
    assert "<dt>worst at 31 of 1,500,000 phases</dt><dd>11.360 us, at phases 9.2375000 to 9.2377000 ms</dd>" in html
    small, z = periph_sim("check", "cases", "--jobs", "1", "--json").json_object["cases"]
    assert small["coverage"] == {"file": "cases/coverage/small.json", "state": "as saved", "says": held}
    assert z["coverage"] is None


def test_a_phase_that_breaks_is_in_all_outputs_though_the_run_holds(periph_sim: Run, covered: Path, tmp_path: Path):
    put_case(Path("cases"), service=15_000)
    result = periph_sim("check", "cases", "--jobs", "1", *FILES)
    assert result.status == 1
    message = "response breaks at phases 9.2375000 to 9.2377000 ms: 91.360 us is over its limit of 60.000 us"
    assert result.out.splitlines()[5].split() == ["small", "2", "0", "0", "0", "equal", "1", "changed", "fail"]
    assert f"cases/small.toml, line 23: {message}" in result.out
    assert result.out.splitlines()[-1].startswith(
        "::error file=cases/small.toml,line=23,title=periph-sim check%3A small::"
    )
    junit, summary, html = outputs(tmp_path)
    assert f'<failure message="{message}' in junit and f"\n* line 23: {message}" in summary and f"<li>{message}" in html
    assert 'data-name="at phases"' not in html
    (small,) = periph_sim("check", "cases", "--jobs", "1", "--json").json_object["cases"]
    assert (small["verdict"], small["coverage"]["state"], small["broken"]) == ("fail", "changed", [])
    assert small["findings"][0]["budget"] == "response" and small["findings"][0]["text"].startswith(message)


def test_a_coverage_file_that_is_out_of_date_is_a_notice_and_passes(periph_sim: Run, covered: Path):
    put_case(Path("cases"), comment="# a comment\n")
    result = periph_sim("check", "cases", "--jobs", "1", "--annotations", "github")
    text = "cases/coverage/small.json is out of date: firmware.py has changed; its 2 worst values are as saved"
    assert result.status == 0 and f"\n{text}\n" in result.out
    title = "title=periph-sim check%3A small"
    assert result.out.splitlines()[-1] == f"::notice file=cases/small.toml,line=1,{title}::{text}"


def test_worker_processes_repeat_the_runs_of_a_coverage_file(periph_sim: Run, covered: Path):
    put(Path("cases"), "z")
    one, two = (periph_sim("check", "cases", "--jobs", jobs, "--json") for jobs in ("1", "2"))
    assert one == two and two.json_object["cases"][0]["coverage"]["state"] == "as saved"
