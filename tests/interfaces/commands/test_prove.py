"""`periph-sim prove`: output, any number of processes, rejected input and interruption."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from periph_sim.interfaces.reports import coverage as reports
from periph_sim.proof.cover import cover_part
from tests.interfaces.commands.conftest import Run
from tests.proof.scenes import listener, settings_of

BAD = settings_of(low=8000, high=8060)
HERE = ("prove", "listener.toml", "--rounds", "3")


@pytest.fixture(autouse=True)
def desk(here: Path) -> Path:
    listener(here)
    return here


STOPPED = "Error: stopped by Ctrl-C or SIGTERM"


def interrupt(*_: object) -> None:
    raise KeyboardInterrupt


def sets(*changes: str) -> list[str]:
    return [word for change in changes for word in ("--set", change)]


def test_the_exit_status_is_0_if_every_budget_holds(periph_sim: Run) -> None:
    result = periph_sim(*HERE, "--phases", "0 us to 1 us", "--step", "10", "--jobs", "1")
    lines = result.out.splitlines()
    assert (result.status, lines[0]) == (0, "listener: 16 of 15,000 phases run; budgets: 3 held")
    assert "listener: 16 phases to run, about 1 s of CPU" in result.err
    assert all(len(line) <= 80 for line in lines)


def test_a_broken_budget_has_a_window_and_exit_status_1(periph_sim: Run) -> None:
    result = periph_sim(*HERE, *sets(*BAD), "--phases", "4 us to 5 us", "--step", "10", "--jobs", "1")
    assert result.status == 1
    assert "budgets: 1 broken, 2 held" in result.out
    assert "both neighbours held" in result.out and "bad: broken from 0.00416" in result.out
    assert result.out.count("first phase: certain from 2380.940 us on: dsp: GPIO.GPBSET written") == 1
    assert result.out.count("last phase: certain from ") == 1 and result.out.count(", which held: dsp: ") == 2
    assert all(len(line) <= 80 for line in result.out.splitlines())


def test_a_budget_that_no_run_judges_is_named_and_exit_status_is_1(periph_sim: Run) -> None:
    text = Path("listener.toml").read_text(encoding="utf-8")
    never = '[[budget]]\nname = "never"\nmeasure = "from edge BAD rise to edge BAD fall"\nmax = "1 us"\n'
    Path("listener.toml").write_text(text + never, encoding="utf-8")
    result = periph_sim(*HERE, "--phases", "0 us to 0.1 us", "--jobs", "1", "--json")
    assert result.status == 1
    assert result.json_object["budgets"]["never"]["verdict"] == "not judged"


def test_budgets_and_percentiles_that_are_not_covered_are_named(periph_sim: Run) -> None:
    text = Path("listener.toml").read_text(encoding="utf-8").replace('max = "1 us"', 'max = "1 us"\np99 = "0.9 us"')
    more = ('measure = "cpu load"\nmax = "90 %"', 'measure = "count of edge SEEN rise"\nmin = 3')
    budgets = [f'[[budget]]\nname = "{name}"\n{one}\n' for name, one in zip(("load", "seen"), more, strict=True)]
    Path("listener.toml").write_text(text + "".join(budgets), encoding="utf-8")
    message = periph_sim(*HERE, "--phases", "0 us to 0.1 us", "--jobs", "1", "--json").json_object
    assert message["not_covered"] == {
        "p99 of late": "a percentile describes all occurrences of a run",
        "load": "it is a share of a whole run",
        "seen": "it counts the events of a whole run",
    }
    assert message["budgets"].keys() == {"late", "bad", "high-water"}


def test_the_answer_is_the_same_with_any_number_of_processes(periph_sim: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """One window crosses the border of two parts, and one contains the end of the period."""
    monkeypatch.setattr(reports, "PART", 16)
    arguments = (*HERE, *sets(*settings_of(low=3440, high=3640, first="true")), "--step", "200", "--json", "--jobs")
    one, two, three = (periph_sim(*arguments, jobs).json_object for jobs in ("1", "2", "3"))
    assert one == two == three
    assert any(window["first"] > window["last"] and window["closed"] for window in one["windows"])
    assert (one["phases"]["chosen"], one["phases"]["run"]) == (76, 92)  # more are run to find the ends of windows


def test_failures_without_a_budget_are_named_with_their_reason(periph_sim: Run) -> None:
    result = periph_sim(
        *HERE,
        *sets(*BAD, "unit.dsp.settings.then=error"),
        "--phases",
        "4 us to 5 us",
        "--step",
        "10",
        "--jobs",
        "1",
        "--json",
    )
    message = result.json_object
    assert result.status == 1
    assert [window["name"] for window in message["windows"]] == ["ended by an error"]
    assert "a character came too late" in message["reasons"]["ended by an error"]
    assert {one["verdict"] for one in message["budgets"].values()} == {"held"}


def test_windows_of_sends_are_not_joined_at_the_end_of_their_millisecond(periph_sim: Run) -> None:
    """The reply is late at every phase, so there is one window, as wide as the phases that were run."""
    text = (
        'name = "silent"\nduration = "400 us"\n[unit.dsp]\nfirmware = "listener.py"\nmodules = ["SCI-A", "GPIO"]\n'
        '[[serial.send]]\nname = "ask"\nto = "dsp.SCI-A"\ntext = "?"\nat = "50 us"\n'
        '[[serial.expect]]\nname = "reply"\nfrom = "dsp.SCI-A"\ntext = "OK"\nafter_send = "ask"\nwithin = "200 us"\n'
    )
    Path("silent.toml").write_text(text, encoding="utf-8")
    result = periph_sim("prove", "silent.toml", "--phases", "0 ms to 2 ms", "--step", "60000", "--jobs", "1", "--json")
    (window,) = result.json_object["windows"]
    assert (window["first"], window["last"], window["closed"]) == (0, 300_000, False)
    result = periph_sim("prove", "silent.toml", "--phases", "0 ms to 2 ms", "--step", "60000", "--jobs", "1")
    assert "300,001 phases, " in result.out


WRONG = {
    "one time": (["--phases", "1.5 ms"], "--phases '1.5 ms': expected two times, for instance '1.5 ms to 1.6 ms'"),
    "no second time": (["--phases", "1 us to "], "--phases"),
    "no first time": (["--phases", " to 1 us"], "--phases"),
    "no times": (["--phases", "x to y"], "--phases: "),
    "no unit": (["--phases", "1 to 2"], "--phases: "),
    "negative": (["--phases", "-2 us to -1 us"], "--phases: "),
    "backwards": (
        ["--phases", "2 us to 1 us"],
        "no phase lies between these two times; the phases are those of a period",
    ),
    "between two cycles": (["--phases", "0.001 us to 0.002 us"], "no phase lies between these two times"),
    "after the period": (
        ["--phases", "1 ms to 2 ms"],
        "no phase lies between these two times; the phases are those of a",
    ),
    "no step": (["--step", "0"], "--step"),
    "no process": (["--jobs", "0"], "--jobs"),
    "a missing folder": (["--witness", "there"], "'there' does not exist"),
    "a file for a folder": (["--witness", "listener.py"], "'listener.py' is a file"),
    "chosen frames": (["--set", "inputs.frames=['1 ms']"], "prove chooses the starts itself"),
    "a misspelled key": (["--set", "hots.baud=1"], "did you mean host"),
}


@pytest.mark.parametrize(("arguments", "sentence"), WRONG.values(), ids=WRONG)
def test_bad_input_is_refused_with_status_2(periph_sim: Run, arguments: list[str], sentence: str) -> None:
    assert sentence in periph_sim.refused(*HERE, "--jobs", "1", *arguments)


@pytest.mark.parametrize("error", ["ENOSPC", "EACCES"])
def test_results_are_shown_if_their_witnesses_cannot_be_written(
    periph_sim: Run, monkeypatch: pytest.MonkeyPatch, error: str
) -> None:
    """The disk is full, or the folder is read-only."""
    import errno
    import tempfile

    def refuse(*_: Any, **__: Any) -> None:
        raise OSError(getattr(errno, error), os.strerror(getattr(errno, error)))

    Path("out").mkdir()
    monkeypatch.setattr(tempfile, "mkstemp", refuse)
    result = periph_sim(*HERE, "--phases", "0 us to 0.1 us", "--jobs", "1", "--witness", "out")
    assert result.status == 2
    assert "budgets: 3 held" in result.out
    assert "Error: out/listener_late.toml" in result.err and "Traceback" not in result.err


def test_the_earlier_results_are_shown_if_a_process_is_killed(periph_sim: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker dies at the first phase that fails; the results of the parts before it are shown."""
    monkeypatch.setattr(reports, "PART", 32)
    monkeypatch.setattr(reports, "TRIED", 1)
    dies = sets(*BAD, "unit.dsp.settings.then=dies")
    result = periph_sim(*HERE, *dies, "--phases", "0.7 us to 5 us", "--step", "5", "--jobs", "2", "--json")
    message = result.json_object
    assert result.status == 2
    assert "died" in message["stopped"] and message["stopped"] in result.err
    assert message["phases"]["run"] % 32 == 0 and message["phases"]["run"] < message["phases"]["chosen"]


def test_the_earlier_results_are_shown_after_ctrl_c(periph_sim: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reports, "PART", 32)
    run = cover_part

    def stopped(job: Any, phases: Any, seed: int) -> Any:
        if phases[0] > 64:
            raise KeyboardInterrupt
        return run(job, phases, seed)

    monkeypatch.setattr(reports, "cover_part", stopped)
    result = periph_sim(*HERE, "--phases", "0 us to 1 us", "--step", "1", "--jobs", "1")
    assert (result.status, result.err.splitlines()[-1]) == (2, "Error: stopped by Ctrl-C or SIGTERM")
    assert result.out.startswith("listener: 96 of 15,000 phases run; budgets: 3 held")


def test_the_results_are_shown_after_ctrl_c_in_the_search_for_window_ends(
    periph_sim: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = Path("listener.toml").read_text(encoding="utf-8")
    text = text.replace("[host]", "[unit.dsp.settings]\nlow = 8000\nhigh = 8060\n[host]")
    Path("listener.toml").write_text(text, encoding="utf-8")
    command = (*HERE, "--phases", "4 us to 5 us", "--step", "10", "--jobs", "1", "--save")
    with monkeypatch.context() as stopped:
        stopped.setattr(reports, "windows_of", interrupt)
        result = periph_sim(*command)
    assert (result.status, result.err.splitlines()[-1]) == (2, STOPPED)
    assert (
        result.out.startswith("listener: ") and "budgets: 1 broken, 2 held; stopped, 0 phases not run\n" in result.out
    )
    assert "coverage/listener.json is not complete" in periph_sim("run", "listener.toml").out
    continued, file = periph_sim(*command), Path("coverage/listener.json")
    saved = file.read_bytes()
    assert "; 0 phases to run" in continued.err
    file.unlink()
    assert (periph_sim(*command).out, file.read_bytes()) == (continued.out, saved)


def test_the_windows_are_shown_after_ctrl_c(periph_sim: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("periph_sim.interfaces.reports.certain_failure.certain_failures", interrupt)
    result = periph_sim(*HERE, *sets(*BAD), "--phases", "4 us to 5 us", "--step", "10", "--jobs", "1")
    assert (result.status, result.err.splitlines()[-1]) == (2, STOPPED)
    assert "bad: broken from " in result.out and "certain from" not in result.out


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_a_signal_stops_the_command_and_the_results_are_shown(desk: Path) -> None:
    command = [sys.executable, "-m", "periph_sim", *HERE, "--jobs", "1", "--step", "1"]
    process = subprocess.Popen(command, cwd=desk, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    while "phases to run" not in process.stderr.readline():
        assert process.poll() is None
    time.sleep(0.1)  # all phases take a second
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert process.returncode == 2
    assert "Traceback" not in err and err.splitlines()[-1] == "Error: stopped by Ctrl-C or SIGTERM"
    assert out.startswith("listener: ")


SEVENTH = """
from periph_sim.firmware import start_sci


def main(dsp, settings):
    sci = start_sci(dsp, "SCI-A")
    number = 0
    while True:
        dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
        sci.SCIRXBUF.all
        number += 1
        with dsp.span("work"):
            dsp.compute(1500 if number % 7 == 0 else 15)
"""


def test_more_rounds_at_one_phase_find_rare_behaviour_of_the_firmware(periph_sim: Run) -> None:
    Path("seventh.py").write_text(SEVENTH, encoding="utf-8")
    Path("seventh.toml").write_text(
        'name = "seventh"\nduration = "5 ms"\n[unit.dsp]\nfirmware = "seventh.py"\nmodules = ["SCI-A"]\n'
        '[host]\nbaud = 1000000\nperiod = "1 ms"\n'
        '[[budget]]\nname = "work"\nmeasure = "span:work"\nmax = "1 us"\n',
        encoding="utf-8",
    )
    one_phase = ("prove", "seventh.toml", "--phases", "0 us to 0 us", "--jobs", "1", "--rounds")
    assert "budgets: 1 held" in periph_sim(*one_phase, "3").out
    result = periph_sim(*one_phase, "41")
    assert result.status == 1 and "budgets: 1 broken" in result.out


def test_a_stopped_coverage_does_not_replace_a_complete_one(periph_sim: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    saved = Path("coverage") / "listener.json"
    assert periph_sim(*HERE, "--phases", "0 us to 0.1 us", "--jobs", "1", "--save").status == 0
    complete = saved.read_bytes()

    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(reports, "cover_part", stopped)
    result = periph_sim(*HERE, "--phases", "0 us to 0.2 us", "--jobs", "1", "--save")
    assert result.status == 2 and "has a coverage of other phases or files" in result.err
    assert saved.read_bytes() == complete
    assert result.out.splitlines()[0].endswith("; stopped, 2 phases not run")


def test_a_coverage_that_cannot_be_written_is_refused_before_anything_runs(periph_sim: Run) -> None:
    Path("coverage").write_text("a file", encoding="utf-8")
    assert "--save: coverage: " in periph_sim.refused(*HERE, "--phases", "0 us to 0.1 us", "--jobs", "1", "--save")


def test_a_case_without_a_budget_that_prove_can_judge_is_refused(periph_sim: Run) -> None:
    text = Path("listener.toml").read_text(encoding="utf-8")
    Path("listener.toml").write_text(text.partition("[[budget]]")[0], encoding="utf-8")
    assert "there is no budget that a single round or phase can break" in periph_sim.refused(*HERE, "--jobs", "1")


@pytest.mark.parametrize("options", [[], ["--table"], ["--questions"]])
@pytest.mark.parametrize("folder", ["", "../{name}/"])
def test_an_error_equals_that_of_run(periph_sim: Run, desk: Path, options: list[str], folder: str) -> None:
    case = f"{folder.format(name=desk.name)}listener.toml"
    wrong = ["budget.0.maks=1"] if options == ["--table"] else ["budget.0.maks=1", "unit.dsp.firmware=listenr.py"]
    for changes in map(sets, wrong):
        report = periph_sim("run", case, *changes).err
        assert report.startswith(f"Error: {case}, --set ")
        assert periph_sim("prove", case, *options, *changes).err == report
    report = periph_sim("run", f"{case}x").err
    assert report.startswith(f"Error: {case}x: cannot be read ")
    assert periph_sim("prove", f"{case}x", *options).err == report


def test_the_same_path_in_another_folder_is_another_case(
    periph_sim: Run, desk: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = (*HERE, "--phases", "0 us to 0.1 us", "--jobs", "1")
    assert periph_sim(*options).status == 0
    other = desk / "other"
    other.mkdir()
    case = listener(other)
    case.write_text(case.read_text(encoding="utf-8").replace('max = "1 us"', 'max = "1 ns"'), encoding="utf-8")
    monkeypatch.chdir(other)
    assert periph_sim(*options).status == 1


def test_run_and_worst_say_why_a_damaged_or_old_coverage_is_not_used(periph_sim: Run) -> None:
    assert periph_sim(*HERE, "--phases", "0 us to 0.1 us", "--jobs", "1", "--save").status == 0
    Path("listener.py").write_text(Path("listener.py").read_text(encoding="utf-8") + "\n", encoding="utf-8")
    result = periph_sim("worst", "listener.toml")
    assert "coverage/listener.json is out of date: listener.py has changed; this is the worst of one run" in result.err
    Path("coverage/listener.json").write_text("{", encoding="utf-8")
    result = periph_sim("run", "listener.toml")
    assert "listener: FAIL" in result.out and "is no coverage of this version of periph-sim" in result.out
    assert "delete it, and write it again with prove --save" in result.out


def test_the_output_has_the_number_of_rounds_at_a_phase(periph_sim: Run) -> None:
    phases = ("--phases", "0 us to 0.1 us", "--jobs", "1")
    assert periph_sim(*HERE, *phases).out.splitlines()[-1] == (
        "held: in one round of each phase; at the ends of windows, in 3 rounds"
    )
    assert periph_sim(*HERE, *phases, "--start-up").out.splitlines()[-1] == (
        "held: in at least 3 rounds after each start"
    )


def test_a_data_file_that_the_firmware_reads_is_a_dependency_and_one_that_it_writes_is_not(periph_sim: Run) -> None:
    Path("table.txt").write_text("1", encoding="utf-8")
    text = Path("listener.py").read_text(encoding="utf-8")
    uses = 'open("table.txt").read()\nopen("log.txt", "w").write("x")\n'
    Path("listener.py").write_text(f"{text}\n{uses}", encoding="utf-8")
    assert periph_sim(*HERE, "--phases", "0 us to 0.1 us", "--jobs", "1", "--save").status == 0
    files = json.loads(Path("coverage/listener.json").read_text(encoding="utf-8"))["dependencies"]["files"]
    assert {"table.txt", "listener.py", "listener.toml"} <= files.keys() and "log.txt" not in files
    Path("table.txt").write_text("2", encoding="utf-8")
    assert "coverage/listener.json is out of date: table.txt has changed" in periph_sim("run", "listener.toml").out


def test_worst_names_all_phases_of_a_run_that_has_the_worst_value(periph_sim: Run) -> None:
    """A value that no phase has if it is run alone is reported for all phases of its run, not for the last one."""
    assert periph_sim(*HERE, "--phases", "0 us to 0.1 us", "--jobs", "1", "--save").status == 0
    saved = Path("coverage/listener.json")
    file = json.loads(saved.read_text(encoding="utf-8"))
    worst = file["found"]["worst"]["late"]
    worst["phases"], worst["verdict"]["margin"] = [0, 1, 2], -1.0
    saved.write_text(json.dumps(file), encoding="utf-8")
    result = periph_sim("worst", "listener.toml", "late")
    assert result.out.startswith("at phases 0.0000000 to 0.0000133 ms, the worst of coverage/listener.json:\n")


def test_a_folder_gets_a_picture_of_the_shares_of_failing_runs(periph_sim: Run) -> None:
    Path("out").mkdir()
    result = periph_sim(*HERE, *sets(*BAD), "--phases", "4 us to 5 us", "--step", "10", "--jobs", "1", "--svg", "out")
    assert result.out.splitlines()[-1] == "written: out/listener_certain.svg"
    drawn = Path("out/listener_certain.svg").read_text(encoding="utf-8")
    (first, last) = re.findall(r">(\d+) of \1<", drawn)
    assert int(first) > 0 and int(last) > 0 and "0.0041" in drawn


def test_without_a_failure_there_is_no_picture_of_shares(periph_sim: Run) -> None:
    Path("out").mkdir()
    result = periph_sim(*HERE, "--phases", "0 us to 0.1 us", "--jobs", "1", "--svg", "out")
    assert result.out.splitlines()[-1] == "written: out/listener_phases.svg"
    assert [path.name for path in Path("out").iterdir()] == ["listener_phases.svg"]
