"""`periph-sim run`: exit status, table, JSON, --set, --seconds, --record and error messages."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from periph_sim.traces import formats
from tests.interfaces.commands.conftest import CASE, Run
from tests.scene.runs import TIMING

ROOT = Path(__file__).parents[3]


def test_budgets_that_hold_give_status_0_and_a_table(periph_sim: Run, desk: Path):
    out = periph_sim.passes("run", "small.toml")
    assert "small: PASS" in out and "rounds in time" in out
    assert "0.03 s simulated; 2 I2C bytes, 0 SCI bytes" in out
    assert "2 rounds, 2 nacked" in out


def test_a_broken_budget_gives_status_1_and_is_named(periph_sim: Run, desk: Path):
    outcome = periph_sim("run", "small.toml", "--set", "budget.rounds in time.max=100 us")
    assert (outcome.status, outcome.err) == (1, "")
    assert "small: FAIL" in outcome.out and "  broken\n" in outcome.out
    assert "rounds in time: 105.000 us is over its limit of 100.000 us, at 0.005000 s" in outcome.out


def test_json_is_one_object_with_all_results(periph_sim: Run, desk: Path):
    status, result = periph_sim.json("run", "small.toml")
    assert status == 0
    assert (result["case"], result["verdict"], result["fidelity"]) == ("small", "pass", "exact")
    assert result["simulated_s"] == 0.03 and result["wall_s"] > 0 and result["events"] > 0
    (budget,) = result["budgets"]
    assert budget["name"] == "rounds in time" and budget["limit"] == 5000.0 and budget["unit"] == "us"
    assert budget["margin"] == pytest.approx(budget["limit"] - budget["worst"])


@pytest.mark.parametrize(("seconds", "length"), [("0.01", 0.01), ("10 ms", 0.01), ("1", 1.0), ("0", 0.0)])
def test_seconds_replaces_the_duration(periph_sim: Run, desk: Path, seconds: str, length: float):
    assert periph_sim("run", "small.toml", "--seconds", seconds, "--json").json_object["simulated_s"] == length


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["smal.toml"], "smal.toml: cannot be read (No such file or directory); did you mean small.toml?"),
        (["."], ".: is a folder; give a case file, or run all its cases: periph-sim check ."),
        (
            ["small.toml", "--seconds", "ten"],
            "--seconds: 'ten' is no length of time; write for instance 20 ms (ns, us, ms, s, min, h, d)",
        ),
        (["small.toml", "--seconds", "-1"], "--seconds: '-1 s' is negative; a duration is 0 or more"),
        (["small.toml", "--set", "seed"], "--set 'seed': expected key=value, for instance controller.period=10 ms"),
        (
            ["small.toml", "--set", "sed=1"],
            "small.toml, --set 'sed=1': there is no key 'sed'; did you mean seed?",
        ),
        (
            ["small.toml", "--set", "unit.dsp.firmware=imu"],
            "small.toml, --set 'unit.dsp.firmware=imu': unit.dsp.firmware: there is no firmware 'imu'; "
            "did you mean imu_hil?",
        ),
        (
            ["small.toml", "--record", "no/run.vcd"],
            "no/run.vcd, its place: found no such file or directory, expected a place that can be written to; "
            "give another path",
        ),
        (
            ["small.toml", "--record", "run.vdc"],
            "run.vdc: no recording is written as '.vdc'; did you mean .vcd?",
        ),
        (
            ["small.toml", "--set", "unit.dsp.firmware=crash.py"],
            "dsp: AttributeError at line 3 of crash.py: I2C-A.I2CSTR has no field 'AS'; did you mean AAS?; "
            "this was at 0.000 us of the run",
        ),
        (
            ["small.toml", "--set", "unit.dsp.firmware=crash.py", "--set", "unit.dsp.modules=[]"],
            "dsp: KeyError at line 2 of crash.py: dsp has no module 'I2C-A'; name it in modules of [unit.dsp]; "
            "this was at 0.000 us of the run",
        ),
        (
            ["small.toml", "--set", "unit.dsp.firmware=starts.py", "--set", "unit.dsp.modules=[]"],
            "dsp: KeyError at line 4 of starts.py: dsp has no module 'I2C-A'; name it in modules of [unit.dsp]; "
            "this was at 0.107 us of the run",
        ),
    ],
)
def test_bad_input_is_one_error_message_with_status_2(periph_sim: Run, desk: Path, arguments: list[str], sentence: str):
    (desk / "crash.py").write_text(CRASH, encoding="utf-8")
    (desk / "starts.py").write_text(STARTS, encoding="utf-8")
    before = sorted(desk.iterdir())
    assert periph_sim.refused("run", *arguments) == sentence
    assert sorted(desk.iterdir()) == before


STARTS = """\
from periph_sim.firmware import start_i2c

def main(dsp, settings):
    start_i2c(dsp)
"""
CRASH = """\
def main(dsp, settings):
    i2c = dsp.module("I2C-A")
    dsp.spin(lambda: i2c.I2CSTR.AS == 1)
"""


@pytest.mark.parametrize("suffix", [".vcd", ".jsonl"])
def test_the_recording_of_a_failed_run_is_kept_up_to_the_failure(periph_sim: Run, desk: Path, suffix: str):
    late = "def main(dsp, settings):\n    dsp.compute(1_500_000)\n    raise ValueError('boom')\n"
    (desk / "late.py").write_text(late, encoding="utf-8")
    before = {*desk.iterdir()}
    output = periph_sim.refused("run", "small.toml", "--set", "unit.dsp.firmware=late.py", "--record", f"run{suffix}")
    place = f"this was at 10.000 ms of the run; run{suffix} contains the run up to there"
    assert output == f"dsp: ValueError at line 3 of late.py: boom; {place}"
    assert {*desk.iterdir()} == before | {desk / f"run{suffix}"}
    if suffix == ".vcd":  # its last line is the end of the run, in ns
        assert (desk / "run.vcd").read_text(encoding="utf-8").endswith("\n#10000000\n")


def test_recordings_are_equal_for_equal_seeds_only(periph_sim: Run, desk: Path):
    jitter = ["--set", "controller.jitter=3 ms"]
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        periph_sim("run", "small.toml", "--record", f"{name}.jsonl", "--set", f"seed={seed}", *jitter)
    a, b, c = ((desk / f"{name}.jsonl").read_bytes() for name in "abc")
    assert a == b != c


def test_a_recording_does_not_change_the_verdict(periph_sim: Run, desk: Path):
    plain = periph_sim("run", "small.toml", "--json").json_object
    recorded = periph_sim("run", "small.toml", "--json", "--record", "run.vcd").json_object
    for result in (plain, recorded):  # a recorded run skips no bits
        del result["wall_s"], result["events"], result["bytes_skipped"]
    assert plain == recorded
    assert formats.read(desk / "run.vcd").channel("SCL").edges.size > 0


def test_an_internal_error_gives_status_3_and_asks_for_a_report(periph_sim: Run, desk: Path, monkeypatch):
    def broken(*_: object, **__: object) -> None:
        raise AssertionError("a bug")

    monkeypatch.setattr("periph_sim.interfaces.commands.run.Scene", broken)
    outcome = periph_sim("run", "small.toml")
    assert outcome.status == 3
    assert outcome.err.startswith("periph-sim: internal error; please report it with the command and what follows.")
    assert "AssertionError: a bug" in outcome.err


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        (["--version"], 0),
        (["--help"], 0),
        (["run", "--help"], 0),
        ([], 2),
        (["rum"], 2),
        (["run"], 2),
        (["run", "small.toml", "--sets"], 2),
    ],
)
def test_help_and_usage_errors_have_their_exit_statuses(periph_sim: Run, desk: Path, arguments: list[str], status: int):
    outcome = periph_sim(*arguments)
    assert outcome.status == status
    assert "Traceback" not in outcome.err


@pytest.mark.parametrize(
    ("arguments", "status"),
    [(["run", "small.toml"], 0), (["run", "small.toml", "--seconds", "0"], 1), (["run", "missing.toml"], 2)],
)
def test_the_process_ends_with_the_exit_status(desk: Path, arguments: list[str], status: int):
    (desk / "small.toml").write_text(CASE.format(firmware="still.py"), encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    done = subprocess.run(
        [sys.executable, "-m", "periph_sim", *arguments], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == status
    assert "Traceback" not in done.stderr


def run_with_measure(run: Run, measure: str, *limits: str, options: tuple[str, ...] = ()):
    """Return the result of `run` with the budget's measure and limits replaced."""
    changes = [f"measure={measure}", *limits]
    sets = [part for change in changes for part in ("--set", f"budget.rounds in time.{change}")]
    return run("run", "small.toml", *sets, *options)


def test_a_measure_of_events_is_in_the_table(periph_sim: Run, desk: Path):
    outcome = run_with_measure(periph_sim, "from bus START to bus STOP", "p99_9=1 ms")
    assert (outcome.status, outcome.err) == (0, "")
    assert "p99.9 1 ms" in outcome.out
    assert "%" in run_with_measure(periph_sim, "bus load", "max=50 %").out


def test_a_measure_of_events_is_in_json_with_the_nearest_limit(periph_sim: Run, desk: Path):
    outcome = run_with_measure(periph_sim, "count of bus START", "max=3", "min=1", options=("--json",))
    (budget,) = outcome.json_object["budgets"]
    shown = {"worst": 2, "limit": 3, "margin": 1, "count": 2, "unit": "count", "which": "max", "found": ""}
    assert shown.items() <= budget.items()


def test_an_event_that_never_matched_is_named_below_the_table(periph_sim: Run, desk: Path):
    outcome = run_with_measure(periph_sim, "period of bus address 0x11 read")
    assert outcome.status == 1
    assert "rounds in time: no event matched 'bus address 0x11 read'" in outcome.out


def test_the_error_for_an_impossible_event_suggests_similar_names(periph_sim: Run, desk: Path):
    outcome = run_with_measure(periph_sim, "period of edge SLC rise")
    assert (outcome.status, outcome.out) == (2, "")
    assert "there is no wire 'SLC'; did you mean SCL?" in outcome.err
    assert len(outcome.err.splitlines()) == 1


def test_a_pass_is_qualified_as_seen_in_this_run(periph_sim: Run):
    short = ("run", str(TIMING / "imu_hil_published.toml"), "--seconds", "0.05")
    outcome = periph_sim(*short)
    assert outcome.status == 0 and outcome.out.startswith("imu_hil_published: PASS, as seen in this run\n")
    assert outcome.out.splitlines()[2].split() == ["budget", "seen", "limit", "margin", "count"]
    assert "\ncount: occurrences; seen: held in this run, other timings are not covered\n" in outcome.out


@pytest.mark.parametrize("level", ["edge", "adaptive", "byte", "auto"])
def test_an_obsolete_fidelity_level_only_gives_a_note(periph_sim: Run, level: str):
    responder = str(TIMING / "responder.toml")
    plain = periph_sim("run", responder, "--seconds", "0.02")
    outcome = periph_sim("run", responder, "--seconds", "0.02", "--fidelity", level, "--max-error", "1 us")
    note = f'note: fidelity = "{level}" is obsolete and has no effect: every run is exact; leave it out'
    assert (outcome.status, outcome.err) == (plain.status, plain.err) == (0, "")
    assert [line for line in outcome.out.splitlines() if line not in plain.out.splitlines()] == [note]


def test_an_obsolete_table_of_fidelity_levels_only_gives_a_note(periph_sim: Run):
    assert 'note: fidelity = "byte" is obsolete' in periph_sim.passes(
        "run", str(TIMING / "responder.toml"), "--seconds", "0.02", "--set", "fidelity.I2C-A=byte"
    )


@pytest.mark.parametrize("given", [("--disable", "bits"), ("--disable", "polls"), ("--disable", "all")])
def test_disabled_optimizations_change_no_result(periph_sim: Run, given: tuple[str, str]):
    responder = str(TIMING / "responder.toml")
    plain, outcome = (
        periph_sim("run", responder, "--seconds", "0.02", "--json", *more).json_object for more in ((), given)
    )
    assert outcome.pop("bytes_skipped") == (0 if given[1] in ("bits", "all") else 76)
    assert outcome["counts"].pop("polls_skipped") == 0 or given[1] == "bits"
    assert plain.pop("bytes_skipped") == 76 and plain["counts"].pop("polls_skipped") > 100
    differs = {key for key in plain if outcome[key] != plain[key]}
    assert differs <= {"wall_s", "events"} and "events" in differs


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--fidelity", "edges"), "fidelity: it is obsolete, and 'edges' never was a level of it"),
        (("--disable", "bit"), "disable: there is no optimization 'bit'; did you mean bits?"),
        (("--disable", "bits", "--disable", "0"), "disable: there is no optimization '0'"),
        (("--disable", "\N{SNAIL}"), "disable: there is no optimization '\N{SNAIL}'"),
    ],
)
def test_a_wrong_optimization_is_one_error_message(
    periph_sim: Run, desk: Path, arguments: tuple[str, ...], message: str
):
    assert message in periph_sim.refused("run", "small.toml", *arguments)


def test_too_many_parties_of_a_wire_are_one_error_message(periph_sim: Run, tmp_path: Path):
    device = '[device.d{0}]\nmodel = "registers"\naddress = {1}\nregister = [{{ name = "DATA", at = 0, reset = 1 }}]\n'
    devices = "".join(device.format(number, 8 + number) for number in range(63))
    asks = '[controller]\nperiod = "5 ms"\n[[controller.request]]\naddress = 8\ncount = 2\n'
    (tmp_path / "many.toml").write_text(f'name = "many"\nduration = "10 ms"\n{asks}{devices}', "utf-8")
    assert (
        periph_sim.refused("run", str(tmp_path / "many.toml")) == "wire SDA: d62 would be party 63; a wire has up to 62"
    )


def test_for_a_case_without_budgets_a_budget_is_suggested(periph_sim: Run, tmp_path: Path):
    case = tmp_path / "bare.toml"
    text = 'name = "bare"\nduration = "1 ms"\n[unit.dsp]\nfirmware = "prog.py"\nmodules = ["SCI-A"]\n'
    (tmp_path / "prog.py").write_text("def main(dsp, settings):\n    dsp.compute(1500)\n", encoding="utf-8")
    case.write_text(text, encoding="utf-8")
    lines = periph_sim("run", str(case)).out.splitlines()
    assert lines[0] == "bare: NOT JUDGED" and lines[1].startswith("the case has no budget; put one at its top")
    case.write_text(f"{lines[2].replace('50 %', '100 %')}\n{text}", encoding="utf-8")
    outcome = periph_sim("run", str(case))
    assert outcome.status == 0 and "bare: PASS" in outcome.out and " CPU load " in outcome.out
