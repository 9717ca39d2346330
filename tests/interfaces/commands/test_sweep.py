"""`periph-sim sweep`: the table, CSV and JSON of many runs, and rejected input."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run

CASE = """\
name = "small"
duration = "100 us"
[unit.dsp]
firmware = "mine.py"
modules = []
[unit.dsp.settings]
work = "10 us"
[[budget]]
name = "work"
measure = "span:work"
max = "30 us"
[[budget]]
name = "times"
measure = "count of span work begin"
exactly = 1
"""
FIRMWARE = """\
from dataclasses import dataclass
from periph_sim.firmware import Duration

@dataclass
class Settings:
    work: Duration

def main(dsp, settings):
    with dsp.span("work"):
        dsp.compute(settings.work)
"""
WORK = "unit.dsp.settings.work"
HERE = ("small.toml", "--jobs", "1")


@pytest.fixture(autouse=True)
def desk(here: Path) -> None:
    Path("small.toml").write_text(CASE, encoding="utf-8")
    Path("mine.py").write_text(FIRMWARE, encoding="utf-8")


def test_the_table_has_the_run_nearest_to_the_limit_of_each_budget(periph_sim: Run) -> None:
    result = periph_sim("sweep", *HERE, "--vary", f"{WORK}=10 us to 40 us step 10 us", "--vary", "seed=1, 2")
    lines = [line.split() for line in result.out.splitlines() if line.strip()]
    assert lines[0] == ["small:", "8", "runs;", "6", "pass,", "2", "fail"]
    assert ["work", "40.000", "us", "30", "us", "6", "2", "0"] in lines
    assert ["times", "1", "1", "0", "0", "0"] in lines
    assert result.out.splitlines()[-3:] == [
        f"run 0: {WORK}=10 us, seed=1",
        f"run 6: {WORK}=40 us, seed=1; work broken",
        f"run 7: {WORK}=40 us, seed=2; work broken",
    ]
    assert (result.status, result.err) == (1, "")


def test_the_csv_file_replaces_no_firmware_that_vary_names(periph_sim: Run) -> None:
    Path("others").mkdir()
    other = Path("others/other.py")
    other.write_text(FIRMWARE, encoding="utf-8")
    vary = ("--vary", f"unit.dsp.firmware=mine.py, {other}", "--csv", str(other))
    assert "found a file that this command reads" in periph_sim.refused("sweep", "small.toml", "--jobs", "2", *vary)
    assert other.read_text(encoding="utf-8") == FIRMWARE


def test_a_stopped_sweep_says_so_in_its_table_and_in_json(periph_sim: Run) -> None:
    interrupted = FIRMWARE.replace("    with", "    if settings.work > 2e-5: raise KeyboardInterrupt\n    with")
    Path("mine.py").write_text(interrupted, encoding="utf-8")
    vary = ("sweep", *HERE, "--vary", f"{WORK}=10 us to 40 us step 10 us")
    sentence = "the sweep was stopped after 2 of 4 runs"
    result = periph_sim(*vary)
    assert (result.status, result.err) == (2, f"Error: {sentence}\n")
    assert result.out.splitlines()[0] == f"small: 2 runs; 2 pass; {sentence}"
    report = periph_sim(*vary, "--json").json_object
    assert (len(report["runs"]), report["stopped"]) == (2, sentence)


def test_the_exit_status_is_0_if_every_run_passes(periph_sim: Run) -> None:
    result = periph_sim("sweep", *HERE, "--vary", f"{WORK}=10 us, 20 us", "--set", "seed=3", "--json")
    assert result.status == 0
    report = result.json_object
    assert list(report)[:4] == ["schema", "schema_version", "case", "runs"]
    assert [run["set"] for run in report["runs"]] == [{"seed": "3", WORK: "10 us"}, {"seed": "3", WORK: "20 us"}]
    assert [run["verdict"] for run in report["runs"]] == ["pass", "pass"]
    assert report["runs"][1]["budgets"]["work"] == {
        "worst": 20.0,
        "limit": 30.0,
        "margin": 10.0,
        "at_s": 0.0,
        "count": 1,
        "verdict": "pass",
    }
    assert report["units"] == {"work": "us", "times": "count"}


def test_a_run_with_an_error_is_a_row_and_gives_status_2(periph_sim: Run) -> None:
    result = periph_sim("sweep", *HERE, "--vary", f"{WORK}=10 us, 3 parsec", "--csv", "all.csv")
    assert result.status == 2
    assert result.out.startswith("small: 2 runs; 1 pass, 1 error\n")
    assert f"\nrun 1: {WORK}=3 parsec: error: small.toml, --set '{WORK}=3 parsec': " in result.out
    with open("all.csv", encoding="utf-8", newline="") as file:
        good, bad = csv.DictReader(file)
    assert (good["run"], good[WORK], good["verdict"], good["work: worst"]) == ("0", "10 us", "pass", "10.0")
    assert (bad["run"], bad["verdict"], bad["work: worst"], bad["work: verdict"]) == ("1", "error", "", "")
    assert "unit 'parsec'" in bad["error"]


def test_the_row_of_a_stuck_run_says_where_it_waits(periph_sim: Run) -> None:
    text = FIRMWARE.replace("work: Duration", "work: Duration\n    waits: bool = False")
    waits = "    if settings.waits:\n        sci = dsp.module('SCI-A')\n        dsp.spin(lambda: sci.SCIRXST.RXRDY)\n"
    Path("mine.py").write_text(text + waits, encoding="utf-8")
    Path("small.toml").write_text(CASE.replace("modules = []", 'modules = ["SCI-A"]'), encoding="utf-8")
    result = periph_sim("sweep", *HERE, "--vary", "unit.dsp.settings.waits=false, true", "--csv", "all.csv")
    assert result.status == 1
    assert "\nrun 1: unit.dsp.settings.waits=true: stuck: dsp waits" in result.out, result.out
    with open("all.csv", encoding="utf-8", newline="") as file:
        good, bad = csv.DictReader(file)
    assert (good["verdict"], good["error"]) == ("pass", "")
    assert bad["verdict"] == "fail" and bad["error"].startswith("stuck: dsp waits"), bad["error"]
    assert bad["work: worst"] == "10.0"


def test_some_of_many_failures_are_listed_and_the_others_counted(periph_sim: Run) -> None:
    result = periph_sim("sweep", *HERE, "--vary", f"{WORK}=31 us to 45 us step 1 us")
    assert result.out.count("; work broken") == 11  # the first ten and the one furthest beyond its limit
    assert result.out.endswith("\n4 more do not pass; --csv or --json has all\n")


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--vary", "seeed=1, 2"], "small.toml, --vary 'seeed=1': there is no key 'seeed'; did you mean seed?"),
        (["--vary", "seed"], "--vary 'seed': expected KEY=VALUE, for instance controller.period=10 ms"),
        (["--vary", "seed=1", "--vary", "seed=2"], "--vary seed is given twice; give all its values at once"),
        (["--vary", "seed=1,"], "--vary seed=1,: a value is missing"),
        (["--vary", "seed=1", "--set", "seed=2"], "--set and --vary both name seed; remove one of them"),
        (["--vary", "seed=1", "--set", "x"], "--set 'x': expected KEY=VALUE"),
        (["--vary", "seed=1", "--seconds", "x"], "--seconds: "),
        (["--vary", f"{WORK}=x"], f"small.toml, --vary '{WORK}=x': {WORK}: "),
        (["--vary", "seed=1 to 3"], "but it is '1 to 3'; a range needs a step: 'FIRST to LAST step STEP'"),
        ([], "Missing option '--vary'"),
        (["--vary", "seed=1", "--csv", "no/all.csv"], "no/all.csv, its place: found no such file or directory"),
    ],
)
def test_bad_input_is_an_error_message_with_status_2(periph_sim: Run, arguments: list[str], sentence: str) -> None:
    assert sentence in periph_sim.refused("sweep", *HERE, *arguments)
