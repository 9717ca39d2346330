"""`periph-sim sweep`: the table, CSV and JSON of many runs, and what is refused."""

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


def test_the_table_has_of_each_budget_the_run_that_was_nearest_to_its_limit(periph_sim: Run) -> None:
    came = periph_sim("sweep", *HERE, "--vary", f"{WORK}=10 us to 40 us step 10 us", "--vary", "seed=1, 2")
    lines = [line.split() for line in came.out.splitlines() if line.strip()]
    assert lines[0] == ["small:", "8", "runs;", "6", "pass,", "2", "fail"]
    assert ["work", "40.000", "us", "30", "us", "6", "2", "0"] in lines
    assert ["times", "1", "1", "0", "0", "0"] in lines
    assert came.out.splitlines()[-3:] == [
        f"run 0: {WORK}=10 us, seed=1",
        f"run 6: {WORK}=40 us, seed=1; work broken",
        f"run 7: {WORK}=40 us, seed=2; work broken",
    ]
    assert (came.status, came.err) == (1, "")


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
    came = periph_sim(*vary)
    assert (came.status, came.err) == (2, f"Error: {sentence}\n")
    assert came.out.splitlines()[0] == f"small: 2 runs; 2 pass; {sentence}"
    told = periph_sim(*vary, "--json").told
    assert (len(told["runs"]), told["stopped"]) == (2, sentence)


def test_where_every_run_passes_the_exit_status_is_0(periph_sim: Run) -> None:
    came = periph_sim("sweep", *HERE, "--vary", f"{WORK}=10 us, 20 us", "--set", "seed=3", "--json")
    assert came.status == 0
    told = came.told
    assert list(told)[:4] == ["schema", "schema_version", "case", "runs"]
    assert [run["set"] for run in told["runs"]] == [{"seed": "3", WORK: "10 us"}, {"seed": "3", WORK: "20 us"}]
    assert [run["verdict"] for run in told["runs"]] == ["pass", "pass"]
    assert told["runs"][1]["budgets"]["work"] == {
        "worst": 20.0,
        "limit": 30.0,
        "margin": 10.0,
        "at_s": 0.0,
        "count": 1,
        "verdict": "pass",
    }
    assert told["units"] == {"work": "us", "times": "count"}


def test_a_run_that_cannot_be_made_is_a_line_and_status_2_and_the_others_are_told(periph_sim: Run) -> None:
    came = periph_sim("sweep", *HERE, "--vary", f"{WORK}=10 us, 3 parsec", "--csv", "all.csv")
    assert came.status == 2
    assert came.out.startswith("small: 2 runs; 1 pass, 1 error\n")
    assert f"\nrun 1: {WORK}=3 parsec: error: small.toml, --set '{WORK}=3 parsec': " in came.out
    with open("all.csv", encoding="utf-8", newline="") as file:
        good, bad = csv.DictReader(file)
    assert (good["run"], good[WORK], good["verdict"], good["work: worst"]) == ("0", "10 us", "pass", "10.0")
    assert (bad["run"], bad["verdict"], bad["work: worst"], bad["work: verdict"]) == ("1", "error", "", "")
    assert "unit 'parsec'" in bad["error"]


def test_a_run_that_is_stuck_says_where_in_its_row(periph_sim: Run) -> None:
    text = FIRMWARE.replace("work: Duration", "work: Duration\n    waits: bool = False")
    waits = "    if settings.waits:\n        sci = dsp.module('SCI-A')\n        dsp.spin(lambda: sci.SCIRXST.RXRDY)\n"
    Path("mine.py").write_text(text + waits, encoding="utf-8")
    Path("small.toml").write_text(CASE.replace("modules = []", 'modules = ["SCI-A"]'), encoding="utf-8")
    came = periph_sim("sweep", *HERE, "--vary", "unit.dsp.settings.waits=false, true", "--csv", "all.csv")
    assert came.status == 1
    assert "\nrun 1: unit.dsp.settings.waits=true: stuck: dsp waits" in came.out, came.out
    with open("all.csv", encoding="utf-8", newline="") as file:
        good, bad = csv.DictReader(file)
    assert (good["verdict"], good["error"]) == ("pass", "")
    assert bad["verdict"] == "fail" and bad["error"].startswith("stuck: dsp waits"), bad["error"]
    assert bad["work: worst"] == "10.0"


def test_of_many_that_fail_some_are_told_and_the_others_counted(periph_sim: Run) -> None:
    came = periph_sim("sweep", *HERE, "--vary", f"{WORK}=31 us to 45 us step 1 us")
    assert came.out.count("; work broken") == 11  # ten of them, and the last one, which was furthest beyond
    assert came.out.endswith("\n4 more do not pass; --csv or --json has all\n")


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
def test_bad_input_is_told_with_status_2(periph_sim: Run, arguments: list[str], sentence: str) -> None:
    assert sentence in periph_sim.refused("sweep", *HERE, *arguments)
