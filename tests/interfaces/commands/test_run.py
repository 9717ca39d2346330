"""`periph-sim run`: exit status, table, JSON, --set, --seconds, --record, and what is said of mistakes."""

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


def test_budgets_that_hold_give_0_and_a_table(periph_sim: Run, desk: Path):
    out = periph_sim.passes("run", "small.toml")
    assert "small: PASS" in out and "rounds in time" in out
    assert "0.03 s simulated; 2 I2C bytes, 0 SCI bytes" in out
    assert "2 rounds, 2 nacked" in out


def test_a_broken_budget_gives_1_and_says_which(periph_sim: Run, desk: Path):
    came = periph_sim("run", "small.toml", "--set", "budget.rounds in time.max=100 us")
    assert (came.status, came.err) == (1, "")
    assert "small: FAIL" in came.out and "  broken\n" in came.out
    assert "rounds in time: 105.000 us is over its limit of 100.000 us, at 0.005000 s" in came.out


def test_json_is_one_object_with_everything(periph_sim: Run, desk: Path):
    status, result = periph_sim.json("run", "small.toml")
    assert status == 0
    assert (result["case"], result["verdict"], result["fidelity"]) == ("small", "pass", "exact")
    assert result["simulated_s"] == 0.03 and result["wall_s"] > 0 and result["events"] > 0
    (budget,) = result["budgets"]
    assert budget["name"] == "rounds in time" and budget["limit"] == 5000.0 and budget["unit"] == "us"
    assert budget["margin"] == pytest.approx(budget["limit"] - budget["worst"])


@pytest.mark.parametrize(("seconds", "length"), [("0.01", 0.01), ("10 ms", 0.01), ("1", 1.0), ("0", 0.0)])
def test_seconds_replaces_the_duration(periph_sim: Run, desk: Path, seconds: str, length: float):
    assert periph_sim("run", "small.toml", "--seconds", seconds, "--json").told["simulated_s"] == length


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
def test_a_mistake_is_one_sentence_on_standard_error_and_2(
    periph_sim: Run, desk: Path, arguments: list[str], sentence: str
):
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
def test_a_run_that_fails_midway_leaves_the_recording_up_to_there(periph_sim: Run, desk: Path, suffix: str):
    late = "def main(dsp, settings):\n    dsp.compute(1_500_000)\n    raise ValueError('boom')\n"
    (desk / "late.py").write_text(late, encoding="utf-8")
    before = {*desk.iterdir()}
    said = periph_sim.refused("run", "small.toml", "--set", "unit.dsp.firmware=late.py", "--record", f"run{suffix}")
    place = f"this was at 10.000 ms of the run; run{suffix} contains the run up to there"
    assert said == f"dsp: ValueError at line 3 of late.py: boom; {place}"
    assert {*desk.iterdir()} == before | {desk / f"run{suffix}"}
    if suffix == ".vcd":  # its last line is the end of the run, in ns
        assert (desk / "run.vcd").read_text(encoding="utf-8").endswith("\n#10000000\n")


def test_recordings_of_two_equal_runs_are_equal_and_of_another_seed_are_not(periph_sim: Run, desk: Path):
    jitter = ["--set", "controller.jitter=3 ms"]
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        periph_sim("run", "small.toml", "--record", f"{name}.jsonl", "--set", f"seed={seed}", *jitter)
    a, b, c = ((desk / f"{name}.jsonl").read_bytes() for name in "abc")
    assert a == b != c


def test_a_recording_does_not_change_the_verdict(periph_sim: Run, desk: Path):
    plain = periph_sim("run", "small.toml", "--json").told
    recorded = periph_sim("run", "small.toml", "--json", "--record", "run.vcd").told
    for result in (plain, recorded):  # a recorded run skips no bits
        del result["wall_s"], result["events"], result["bytes_skipped"]
    assert plain == recorded
    assert formats.read(desk / "run.vcd").channel("SCL").edges.size > 0


def test_a_fault_of_its_own_gives_3_and_asks_for_a_report(periph_sim: Run, desk: Path, monkeypatch):
    def broken(*_: object, **__: object) -> None:
        raise AssertionError("a bug")

    monkeypatch.setattr("periph_sim.interfaces.commands.run.Scene", broken)
    came = periph_sim("run", "small.toml")
    assert came.status == 3
    assert came.err.startswith("periph-sim: internal error; please report it with the command and what follows.")
    assert "AssertionError: a bug" in came.err


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
def test_usage(periph_sim: Run, desk: Path, arguments: list[str], status: int):
    came = periph_sim(*arguments)
    assert came.status == status
    assert "Traceback" not in came.err


@pytest.mark.parametrize(
    ("arguments", "status"),
    [(["run", "small.toml"], 0), (["run", "small.toml", "--seconds", "0"], 1), (["run", "missing.toml"], 2)],
)
def test_exit_statuses_as_a_shell_sees_them(desk: Path, arguments: list[str], status: int):
    (desk / "small.toml").write_text(CASE.format(firmware="still.py"), encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    done = subprocess.run(
        [sys.executable, "-m", "periph_sim", *arguments], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == status
    assert "Traceback" not in done.stderr


def measured(run: Run, measure: str, *limits: str, options: tuple[str, ...] = ()):
    """What `run` says with the budget's measure and limits replaced."""
    changes = [f"measure={measure}", *limits]
    sets = [part for change in changes for part in ("--set", f"budget.rounds in time.{change}")]
    return run("run", "small.toml", *sets, *options)


def test_a_measure_of_events_stands_in_the_table_like_any_other(periph_sim: Run, desk: Path):
    came = measured(periph_sim, "from bus START to bus STOP", "p99_9=1 ms")
    assert (came.status, came.err) == (0, "")
    assert "p99.9 1 ms" in came.out
    assert "%" in measured(periph_sim, "bus load", "max=50 %").out


def test_a_measure_of_events_stands_in_json_with_the_limit_that_was_nearest(periph_sim: Run, desk: Path):
    came = measured(periph_sim, "count of bus START", "max=3", "min=1", options=("--json",))
    (budget,) = came.told["budgets"]
    shown = {"worst": 2, "limit": 3, "margin": 1, "count": 2, "unit": "count", "which": "max", "found": ""}
    assert shown.items() <= budget.items()


def test_an_event_that_never_matched_is_told_below_the_table(periph_sim: Run, desk: Path):
    came = measured(periph_sim, "period of bus address 0x11 read")
    assert came.status == 1
    assert "rounds in time: no event matched 'bus address 0x11 read'" in came.out


def test_an_event_that_cannot_be_is_refused_with_near_names(periph_sim: Run, desk: Path):
    came = measured(periph_sim, "period of edge SLC rise")
    assert (came.status, came.out) == (2, "")
    assert "there is no wire 'SLC'; did you mean SCL?" in came.err
    assert len(came.err.splitlines()) == 1


def test_a_pass_says_what_was_seen_and_claims_nothing_for_other_timings(periph_sim: Run):
    short = ("run", str(TIMING / "imu_hil_published.toml"), "--seconds", "0.05")
    came = periph_sim(*short)
    assert came.status == 0 and came.out.startswith("imu_hil_published: PASS, as seen in this run\n")
    assert came.out.splitlines()[2].split() == ["budget", "seen", "limit", "margin", "count"]
    assert "\ncount: occurrences; seen: held in this run, other timings are not covered\n" in came.out


@pytest.mark.parametrize("level", ["edge", "adaptive", "byte", "auto"])
def test_a_level_of_earlier_versions_has_no_effect_but_a_note(periph_sim: Run, level: str):
    responder = str(TIMING / "responder.toml")
    plain = periph_sim("run", responder, "--seconds", "0.02")
    came = periph_sim("run", responder, "--seconds", "0.02", "--fidelity", level, "--max-error", "1 us")
    note = f'note: fidelity = "{level}" is obsolete and has no effect: every run is exact; leave it out'
    assert (came.status, came.err) == (plain.status, plain.err) == (0, "")
    assert [line for line in came.out.splitlines() if line not in plain.out.splitlines()] == [note]


def test_a_table_of_levels_has_no_effect_but_a_note(periph_sim: Run):
    assert 'note: fidelity = "byte" is obsolete' in periph_sim.passes(
        "run", str(TIMING / "responder.toml"), "--seconds", "0.02", "--set", "fidelity.I2C-A=byte"
    )


@pytest.mark.parametrize("given", [("--disable", "bits"), ("--disable", "polls"), ("--disable", "all")])
def test_optimizations_are_switched_off_by_name_and_change_no_figure(periph_sim: Run, given: tuple[str, str]):
    responder = str(TIMING / "responder.toml")
    plain, came = (periph_sim("run", responder, "--seconds", "0.02", "--json", *more).told for more in ((), given))
    assert came.pop("bytes_skipped") == (0 if given[1] in ("bits", "all") else 76)
    assert came["counts"].pop("polls_skipped") == 0 or given[1] == "bits"
    assert plain.pop("bytes_skipped") == 76 and plain["counts"].pop("polls_skipped") > 100
    differs = {key for key in plain if came[key] != plain[key]}
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
def test_mistakes_about_optimizations_are_one_sentence(
    periph_sim: Run, desk: Path, arguments: tuple[str, ...], message: str
):
    assert message in periph_sim.refused("run", "small.toml", *arguments)


def test_more_parties_than_a_wire_can_have_are_refused_in_one_sentence(periph_sim: Run, tmp_path: Path):
    device = '[device.d{0}]\nmodel = "registers"\naddress = {1}\nregister = [{{ name = "DATA", at = 0, reset = 1 }}]\n'
    devices = "".join(device.format(number, 8 + number) for number in range(63))
    asks = '[controller]\nperiod = "5 ms"\n[[controller.request]]\naddress = 8\ncount = 2\n'
    (tmp_path / "many.toml").write_text(f'name = "many"\nduration = "10 ms"\n{asks}{devices}', "utf-8")
    assert (
        periph_sim.refused("run", str(tmp_path / "many.toml")) == "wire SDA: d62 would be party 63; a wire has up to 62"
    )


def test_a_case_without_budgets_is_told_one_that_it_can_have(periph_sim: Run, tmp_path: Path):
    case = tmp_path / "bare.toml"
    text = 'name = "bare"\nduration = "1 ms"\n[unit.dsp]\nfirmware = "prog.py"\nmodules = ["SCI-A"]\n'
    (tmp_path / "prog.py").write_text("def main(dsp, settings):\n    dsp.compute(1500)\n", encoding="utf-8")
    case.write_text(text, encoding="utf-8")
    lines = periph_sim("run", str(case)).out.splitlines()
    assert lines[0] == "bare: NOT JUDGED" and lines[1].startswith("the case has no budget; put one at its top")
    case.write_text(f"{lines[2].replace('50 %', '100 %')}\n{text}", encoding="utf-8")
    came = periph_sim("run", str(case))
    assert came.status == 0 and "bare: PASS" in came.out and " CPU load " in came.out
