"""Completion of values in the shell, through click's own mechanism and in bash itself."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from periph_sim.cli import cli, run_command
from tests.interfaces.commands.test_cli import imported_by

CASE = """\
name = "small"
duration = "30 ms"

[unit.dsp]
firmware = "still.py"
modules = ["I2C-A"]

[controller]
order = ["gyroscope"]

[[controller.request]]
name = "set"
address = 0x48
count = 0

[serial]
expect = [{ name = "answer", within = "2 ms", bytes = "41" }]

[[budget]]
name = "rounds in time"
measure = "round"
max = "5 ms"

[[budget]]
name = "response"
measure = "response"
max = "5 us"
"""
BROKEN = {"no TOML": b"name = small\n", "no text": b"\xff", "other kinds": b'budget = "a"\nserial = [1]\nunit = 3\n'}
Complete = Callable[..., list[str]]


def ask(monkeypatch: pytest.MonkeyPatch, *words: str) -> None:
    """Set the variables with which bash asks for completions of a line of these words."""
    monkeypatch.setenv("_PERIPH_SIM_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", "\n".join(["periph-sim", *words]))
    monkeypatch.setenv("COMP_CWORD", str(len(words)))


@pytest.fixture
def complete(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., list[str]]:
    """Return a function that returns the completions of a line whose last word is unfinished."""
    (here / "case.toml").write_text(CASE, encoding="utf-8")
    monkeypatch.setattr(sys.modules["__main__"], "__package__", "", raising=False)  # the program is not pytest

    def lines(*words: str) -> list[str]:
        monkeypatch.setattr(sys, "argv", ["periph-sim"])
        ask(monkeypatch, *words)
        with pytest.raises(SystemExit):
            run_command()
        out, err = capsys.readouterr()
        assert err == ""
        return [line.removeprefix("plain,") for line in out.splitlines() if line]

    return lines


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        (["worst", "case.toml", ""], ["'rounds in time'", "response", "answer"]),
        (["worst", "case.toml", "re"], ["response"]),
        (["worst", "case.toml", "response", "re"], []),
        (["worst", "case.toml", "'rou"], ["rounds in time"]),
        (["run", "case.toml", "--set", "dur"], ["duration="]),
        (["check", "case.toml", "--set", "dur"], ["duration="]),
        (["replay", "a.sr", "--case", "case.toml", "--set", "dur"], ["duration="]),
        (["sweep", "case.toml", "--vary", "controller.per"], ["controller.period="]),
        (["run", "case.toml", "--set", "contr"], ["controller.order=", "controller.request."]),
        (["run", "case.toml", "--set", "budget."], ["'budget.rounds in time.'", "budget.response."]),
        (["run", "case.toml", "--set", "budget.response.ma"], ["budget.response.max="]),
        (["run", "case.toml", "--set", "controller.request.set.addr"], ["controller.request.set.address="]),
        (["run", "case.toml", "--set", "unit.dsp.options.i2c.bcm"], ["unit.dsp.options.i2c.bcm_reset="]),
        (["run", "case.toml", "--set", "host."], []),
        (["run", "case.toml", "--set", "fid"], []),
        (["run", "case.toml", "--disable", "b"], ["bits"]),
        (["trade", "case.toml", "--row", "rec"], ["'record .psr'", "'record .vcd'"]),
        (["trade", "case.toml", "--row", "ta"], ["table"]),
        (["regs", "i2cst"], ["I2CSTR"]),
        (["regs", "I2C-A.I2CS"], ["I2C-A.I2CSTR", "I2C-A.I2CSAR"]),
        (["regs", "SC"], ["SCI-A", "SCI-B", "SCI-C"]),
        (["races", "run.psr", "--register", "I2C-A.I2CSTR.RR"], ["I2C-A.I2CSTR.RRDY"]),
        (["why", "run.psr", "I2C-A.I2CSTR.XR"], ["I2C-A.I2CSTR.XRDY@"]),
        (["why", "run.psr", "SD"], ["SDA@"]),
        (["ch"], ["check"]),
        (["check", "--up"], ["--update-baseline"]),
        (["new", "s"], ["sci-protocol", "sensor"]),
        (["new", "--example", "two"], ["two_dsps"]),
    ],
)
def test_commands_options_and_their_values_are_completed(complete: Complete, words: list[str], offered: list[str]):
    found = complete(*words)
    assert found[: len(offered)] == offered
    assert len(found) == len(offered) or words[-1] in ("contr", "SC")  # these have many more


@pytest.mark.parametrize("data", BROKEN.values(), ids=BROKEN)
@pytest.mark.parametrize("words", [["worst", "case.toml", ""], ["run", "case.toml", "--set", "controller."]])
def test_a_broken_case_offers_nothing_and_prints_nothing(complete: Complete, data: bytes, words: list[str]):
    assert complete(*words)
    Path("case.toml").write_bytes(data)
    assert complete(*words) == []


@pytest.mark.parametrize(
    "words", [["worst", "missing.toml", ""], ["worst", ".", ""], ["run", "--set", ""], ["bogus", "x"], ["bogus", "--x"]]
)
def test_without_a_case_or_a_command_nothing_is_offered(complete: Complete, words: list[str]):
    assert complete(*words) == []


TAKES_VALUES = [
    (name, parameter.opts[0])
    for name in cli.list_commands(None)  # type: ignore[arg-type]
    for parameter in getattr(cli.get_command(None, name), "params", ())  # type: ignore[arg-type]
    if parameter._custom_shell_complete is not None
]


def test_every_key_of_a_case_is_completed():
    options = {name for name, option in TAKES_VALUES if option in ("--set", "--vary")}
    assert options >= {"run", "check", "sweep", "worst", "watch", "replay", "moving", "profile", "serve", "terminal"}


@pytest.mark.parametrize(("name", "option"), TAKES_VALUES)
def test_completion_does_not_import_numpy(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str, option: str):
    case = tmp_path / "case.toml"
    case.write_text(CASE, encoding="utf-8")
    words = [] if name in ("regs", "new") else [str(case)]
    ask(monkeypatch, name, *words, *([option] if option.startswith("--") else []), "")
    code = "import sys; sys.argv[0] = 'periph-sim'; sys.modules['__main__'].__package__ = ''"
    loaded = imported_by("", before=code)
    assert "periph_sim.interfaces.commands.completion" in loaded
    assert "numpy" not in loaded


def test_bash_completes_with_the_printed_script(tmp_path: Path):
    if os.name != "posix" or shutil.which("bash") is None:
        pytest.skip("there is no bash")
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    program = tmp_path / "periph-sim"
    code = "import sys; sys.argv[0] = 'periph-sim'; import periph_sim.cli as c; c.run_command()"
    program.write_text(f"#!/bin/sh\nexec {shlex.join([sys.executable, '-c', code])}\n", encoding="utf-8")
    program.chmod(0o755)
    script = """
        compopt() { echo "compopt $*"; }
        eval "$(_PERIPH_SIM_COMPLETE=bash_source periph-sim)"
        for line in "worst case.toml rou" "run case.toml --set dur"; do
            COMP_WORDS=(periph-sim $line); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); COMPREPLY=()
            _periph_sim_completion periph-sim
            printf '%s\\n' "${COMPREPLY[@]}"
        done
    """
    root = str(Path(__file__).parents[3])
    environment = os.environ | {"PATH": f"{tmp_path}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": root}
    came = subprocess.run(
        ["bash", "--norc", "-c", script], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert (came.stdout.splitlines(), came.stderr) == (["'rounds in time'", "compopt -o nospace", "duration="], "")
