"""The examples in the help of each command: there are two or more, its options accept them, and they run."""

from __future__ import annotations

import re
import shlex
import shutil
import sys
from pathlib import Path

import pytest

from periph_sim.cli import cli, run_command
from tests.docs.pages import ROOT
from tests.interfaces.commands.conftest import Run

COMMANDS = cli.list_commands(None)  # type: ignore[arg-type]
ENDLESS = {"host-unit", "serve", "terminal", "watch"}  # these run in real time, or until Ctrl-C
LONG = {  # these take a quarter of a minute or more, and other tests run them
    "periph-sim check timing --junit results.xml",
    "periph-sim trade timing/imu_hil.toml --seconds 1",
}
SHORTER = {  # replacements in examples that take seconds
    "--arithmetic q16": "--arithmetic q16 --samples 200",
    "--only 'roll rate'": "--only 'roll rate' --samples 200",
    "imu_hil.toml --seconds 1 --explain": "imu_hil.toml --seconds 0.1 --explain",
    "imu_hil.toml --set seed=2": "imu_hil.toml --seconds 0.1 --set seed=2",
    "imu_hil.toml response": "imu_hil.toml --seconds 0.1 response",
    "imu_hil.toml stretch": "imu_hil.toml --seconds 0.1 stretch",
    "imu_moving.toml --direct": "imu_moving.toml --direct --seconds 0.1",
    "imu_moving.toml --seconds 1": "imu_moving.toml --seconds 0.1",
    "to 1.6 ms": "to 1.501 ms",
}


def examples_of(name: str) -> list[str]:
    """Return the examples in the help of a command, as shell commands."""
    command = cli.get_command(None, name)  # type: ignore[arg-type]
    assert command is not None and command.help is not None
    return re.findall(r"^\$ (.*)$", command.help, re.MULTILINE)


def arguments_of(example: str) -> list[str]:
    """Return the arguments of an example, without a redirection or a pipe."""
    program, _, *arguments = shlex.split(re.split(r" [|>] ", example)[0])
    assert program == "periph-sim"
    return arguments


EXAMPLES = [(name, example) for name in COMMANDS for example in examples_of(name)]
FINITE = [(name, example) for name, example in EXAMPLES if name not in ENDLESS and example not in LONG]
PREPARATIONS = (
    ("run", "timing/imu_hil.toml", "--seconds", "0.1", "--record", "run.psr"),
    ("assemble", "firmware/c28x/imu_hil.asm", "firmware.out"),
    ("imu-table", "--write", "rest.csv"),
    ("identify", "rest.csv", "--write-parameters", "my.toml"),
    ("new", "i2c-slave", "case"),
)


@pytest.fixture(scope="module")
def examples_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the files that the examples name."""
    folder = tmp_path_factory.mktemp("examples")
    shutil.copytree(ROOT / "timing", folder / "timing")
    shutil.copytree(ROOT / "firmware", folder / "firmware")
    for name in ("capture.sr", "before.sr", "after.sr"):
        shutil.copyfile(ROOT / "traces" / "imu_session.sr", folder / name)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for arguments in PREPARATIONS:
            patch.setattr(sys, "argv", ["periph-sim", *arguments])
            with pytest.raises(SystemExit) as ended:
                run_command()
            assert ended.value.code == 0, arguments
    return folder


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_of_every_command_begins_with_two_examples(name: str):
    examples = examples_of(name)
    assert len(examples) >= 2 and len(set(examples)) == len(examples)
    for example in examples:
        assert example.startswith(f"periph-sim {name} ")


@pytest.mark.parametrize(("name", "example"), EXAMPLES)
def test_the_options_of_a_command_accept_its_examples(name: str, example: str):
    command = cli.get_command(None, name)  # type: ignore[arg-type]
    assert command is not None
    assert command.make_context(name, arguments_of(example)).info_name == name


def test_each_replacement_occurs_in_an_example():
    assert all(any(long in example for _, example in FINITE) for long in SHORTER)


@pytest.mark.parametrize(("name", "example"), FINITE)
def test_an_example_runs(
    periph_sim: Run, examples_folder: Path, monkeypatch: pytest.MonkeyPatch, name: str, example: str
):
    monkeypatch.chdir(examples_folder)
    for long, short in SHORTER.items():
        example = example.replace(long, short)
    result = periph_sim(name, *arguments_of(example))
    assert result.status in (0, 1), result.err
    assert "Error" not in result.err
