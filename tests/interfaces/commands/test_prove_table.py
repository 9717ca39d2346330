"""`periph-sim prove --table`: its output, its files and rejected input."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from functools import wraps
from pathlib import Path
from typing import Any

import pytest

from periph_sim.proof import pair_table
from tests.interfaces.commands.conftest import CommandResult, Run
from tests.proof.pair_cases import keep_a_tenth, write_lonely
from tests.proof.proven_slave import write_slave
from tests.proof.test_closed_table import PERIOD, write_echo
from tests.proof.test_host_rates import compiled_only
from tests.proof.test_other_data import COMPARE, READ

MORE = """
[[budget]]
name = "pause"
measure = "period of frame RX begin"
min = "1 us"
"""


def test_budgets_of_one_round_are_proven_and_others_are_named(periph_sim: Run, tmp_path: Path):
    path = write_echo(tmp_path)
    path.write_text(path.read_text(encoding="utf-8") + MORE, encoding="utf-8")
    result = periph_sim("prove", str(path), "--table")
    assert result.status == 1
    assert result.err.startswith(f"fast_echo: {PERIOD} starts to run, about ") and result.err.endswith(" s of CPU\n")
    assert result.out.splitlines()[0] == f"fast_echo: table of {PERIOD} starts, {PERIOD} of them run: closed"
    words = {line.split()[0]: line.split()[-1] for line in result.out.splitlines() if line.startswith(" ")}
    assert (words["echo"], words["pause"]) == ("proven", "held")
    assert "not proven: pause: an occurrence of it lasts from one round to the next" in result.out
    assert "proven: for all sequences of frames that start at least" in result.out
    assert "proven: for any data of the frames\nassumed: clocks and rates as in the case" in result.out


def test_a_branch_that_depends_on_data_restricts_the_proof(periph_sim: Run, tmp_path: Path):
    result = periph_sim("prove", str(write_echo(tmp_path, 2.0, (READ, COMPARE))), "--table", "--save")
    assert "for any data" not in result.out and "assumed: clocks, rates and data as in the case" in result.out
    use = "not proven for other data of the frames: data decide a branch at _echo (echo.asm:54,"
    assert use in " ".join(result.out.split())
    assert "any data" not in periph_sim("run", str(tmp_path / "echo.toml")).out


def test_a_budget_whose_events_are_data_is_named(periph_sim: Run, tmp_path: Path):
    path = write_echo(tmp_path, 200.0)
    text = path.read_text(encoding="utf-8")
    text = text.replace("frame RX end to frame TX begin, in order", "access W SCI-A.SCITXBUF to edge TX fall")
    path.write_text(text, encoding="utf-8")
    result = periph_sim("prove", str(path), "--table", "--save")
    assert "proven: for any data of the frames, except for echo, whose events are data" in result.out
    assert "any data of the frames, except for echo, whose" in " ".join(periph_sim("run", str(path)).out.split())


def test_a_broken_budget_has_a_witness_that_breaks_it(periph_sim: Run, tmp_path: Path):
    path, folder = write_echo(tmp_path, 0.2), tmp_path / "witness"
    folder.mkdir()
    status, shown = periph_sim.json("prove", str(path), "--table", "--witness", str(folder))
    assert (status, shown["table"]["closed"], shown["budgets"]["echo"]["verdict"]) == (1, False, "broken")
    (file,) = folder.glob("*.toml")
    assert shown["written"] == [str(file)]
    again = periph_sim("run", str(file), "--json").json_object
    assert again["budgets"][0]["worst"] == shown["budgets"]["echo"]["worst"]


def test_the_witness_of_a_value_without_an_instant_runs_to_the_end(periph_sim: Run, tmp_path: Path):
    case = write_slave(tmp_path, "")
    result = periph_sim("prove", str(case), "--table", "--witness", str(tmp_path))
    assert result.status == 0
    (budget,) = periph_sim("run", str(tmp_path / "image_register_slave_wrong_bytes.toml"), "--json").json_object[
        "budgets"
    ]
    assert (budget["worst"], budget["verdict"], budget["at_s"]) == (0, "pass", None)


def test_a_case_without_a_table_is_one_error_message(periph_sim: Run, tmp_path: Path):
    path = write_echo(tmp_path)
    result = periph_sim("prove", str(path), "--table", "--set", "unit.dsp.ppm=1")
    assert (result.status, result.out) == (2, ""), result.err
    assert result.err.splitlines()[-1].startswith("Error: fast_echo has no closed table: unit.dsp.ppm is not 0")
    assert result.err.endswith(" (without --table, prove runs phases)\n")


@pytest.mark.parametrize("option", [["--step", "5"], ["--start-up"], ["--jobs", "2"], ["--rounds", "5"]])
def test_an_option_without_effect_is_refused(option: list[str], periph_sim: Run, tmp_path: Path):
    assert f"{option[0]} has no effect with --table" in periph_sim.refused(
        "prove", str(write_echo(tmp_path)), "--table", *option
    )


COUNT = """
[[budget]]
name = "starts"
measure = "count of bus START"
exactly = 12
"""


def test_a_range_of_clocks_has_several_tables_which_cover_jitter(periph_sim: Run, tmp_path: Path):
    case = write_slave(tmp_path, COUNT)
    changes = ("--set", "controller.first=9 ms", "--set", "controller.jitter=2 ms")
    result = periph_sim(
        "prove", str(case), "--table", "--ppm", "4", *changes, "--jobs", "1", "--witness", str(tmp_path)
    )
    assert result.status == 0
    assert result.err.startswith("image_register_slave: 3 tables, each of about 160 starts to run, about ")
    assert result.out.splitlines()[0] == "image_register_slave: 3 tables with 480 starts, 480 of them run: closed"
    assert "proven: for all clocks of the controller within 4 ppm of that in the case\n" in result.out
    assert "assumed: rates and data as in the case, and the first round after 7.0001 ms\n" in result.out
    message = " ".join(result.out.split())
    assert "not judged here, so run the case, too: starts: it counts the events of a whole run" in message
    assert "jitter" not in message
    witness = (tmp_path / "image_register_slave_wrong_bytes.toml").read_text(encoding="utf-8")
    assert "ppm = -4\n" in witness


@pytest.mark.parametrize("option", ["--ppm", "--host-ppm"])
@pytest.mark.parametrize("text", ["-1", "10001", "many"])
def test_a_wrong_range_of_clocks_is_rejected(text: str, option: str, periph_sim: Run, tmp_path: Path):
    message = f"{option} {text!r}: expected a number from 0 to 10,000"
    assert periph_sim.refused("prove", str(write_slave(tmp_path)), "--table", option, text) == message


@pytest.mark.parametrize("option", ["--ppm", "--host-ppm"])
def test_a_range_of_clocks_needs_a_table(option: str, periph_sim: Run, tmp_path: Path):
    assert f"{option} needs --table; add it" in periph_sim.refused("prove", str(write_slave(tmp_path)), option, "1")


def test_rounds_at_any_tick_need_a_table(periph_sim: Run, tmp_path: Path):
    message = "--any-tick needs --table; add it"
    assert message in periph_sim.refused("prove", str(write_slave(tmp_path)), "--any-tick")


@compiled_only
def test_a_proof_for_a_range_of_host_rates_states_the_range(
    periph_sim: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    keep_a_tenth(monkeypatch)
    case = write_lonely(tmp_path)
    case.write_text(case.read_text(encoding="utf-8").replace("baud = 1562500", "baud = 1562500\nerror = 0.16"), "utf-8")
    result = periph_sim("prove", str(case), "--table", "--host-ppm", "5", "--save", "--jobs", "2", "--json")
    assert result.json_object["table"]["host_within_ppm"] == 5.0
    assert result.json_object["table"]["any_tick"] is False
    line = "for all rounds that start with a cycle of the CPU, and at least 6.1005 ms apart, and all frames that start "
    line += "at least as far apart, and all bit rates of the host within 5 ppm, and any data of the frames\n"
    assert " ".join(line.split()) in " ".join(periph_sim("run", str(case)).out.split())


def test_a_saved_proof_names_its_range_of_clocks(periph_sim: Run, tmp_path: Path):
    case = write_slave(tmp_path, "")
    case.write_text(case.read_text(encoding="utf-8").replace('first = "5 ms"', 'first = "8 ms"'), encoding="utf-8")
    status, shown = periph_sim.json("prove", str(case), "--table", "--ppm", "1", "--save", "--jobs", "2")
    table = shown["table"]
    assert (status, table["tables"], table["within_ppm"], table["entries"]) == (0, 1, 1.0, 160)
    assert (
        "start at least 4.4001 ms apart, and all clocks of the controller within 1 ppm\n"
        in periph_sim("run", str(case)).out
    )


def counting(made: list[int], until: int = 10**6, error: type[BaseException] = KeyboardInterrupt) -> Callable[..., Any]:
    """Return `run_tasks` with `error` raised at call number `until`. Each earlier call appends its number to `made`."""
    real = pair_table.run_tasks

    @wraps(real)
    def counts(*arguments: Any) -> Any:
        if len(made) == until:
            raise error
        made.append(len(made))
        return real(*arguments)

    return counts


@compiled_only
def test_a_stopped_table_is_continued_to_the_same_proof(
    periph_sim: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    write_lonely(tmp_path)
    monkeypatch.chdir(tmp_path)
    keep_a_tenth(monkeypatch)
    monkeypatch.setattr(pair_table, "CHUNK", 16)
    table, unfinished = ("prove", "pair.toml", "--table", "--jobs", "1"), Path("proofs/pair.unfinished")
    way, parts, calls = f"; the same command continues from {unfinished}\n", list[int](), list[int]()

    def run(replaced: Callable[..., Any], *options: str) -> CommandResult:
        with monkeypatch.context() as calls_replaced:
            calls_replaced.setattr(pair_table, "run_tasks", replaced)
            return periph_sim(*table, *options)

    result = run(counting(parts, 4), "--save")
    assert (result.status, result.out) == (2, "")
    assert result.err.endswith(f"\nError: stopped by Ctrl-C or SIGTERM{way}") and "continued" not in result.err
    result = run(counting(parts, 7, BrokenProcessPool), "--save")
    assert result.status == 2
    assert result.err.startswith(f"lonely: continued from {unfinished}\n") and result.err.endswith(way)
    continued, proof = run(counting(parts), "--save"), Path("proofs/pair.json").read_bytes()
    assert continued.err.startswith(f"lonely: continued from {unfinished}\n") and not unfinished.exists()
    whole = run(counting(calls), "--save")
    assert "continued" not in whole.err and parts == calls and len(calls) > 8
    assert (whole.status, whole.out) == (continued.status, continued.out)
    assert "ms apart, and all frames that start at least as far apart" in whole.out
    assert Path("proofs/pair.json").read_bytes() == proof
