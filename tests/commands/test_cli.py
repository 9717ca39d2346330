"""The command line itself: commands are files, help imports none of them, one command does not load the others."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path

import pytest

from periph_sim.cli import FOLDER, cli
from periph_sim.commands.usage_error import MISTAKES
from tests.commands.conftest import Run

TRACE = str(Path(__file__).resolve().parents[2] / "traces" / "host_frames.sr")
HEAVY = (
    "pydantic",
    "rich",
    "greenlet",
    "periph_sim.scene",
    "periph_sim.scene.case",
    "periph_sim.f28335",
    "periph_sim.bus",
)


def imported_by(*arguments: str) -> list[str]:
    """The modules that a fresh `periph-sim` has loaded when it ends."""
    code = "import sys, periph_sim.cli as c\ntry: c.main()\nfinally: print('\\nloaded', *sys.modules)"
    came = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False)
    return came.stdout.rpartition("\nloaded ")[2].split()


def test_every_file_with_a_click_command_is_a_command_of_its_name():
    names = cli.list_commands(None)  # type: ignore[arg-type]
    assert {"decode", "regs", "replay", "run"} <= set(names)
    for name in names:
        command = cli.get_command(None, name)  # type: ignore[arg-type]
        assert command is not None and command.name == name
    assert len(names) < len(list(FOLDER.glob("*.py"))), "helpers beside the commands are none"


def test_help_shows_the_first_sentence_of_each(periph_sim: Run):
    came = periph_sim("--help")
    assert came.status == 0
    assert " ".join(came.out.split()).find("run Run CASE and say whether its budgets hold") > 0


def test_a_misspelt_command_is_told_the_nearest(periph_sim: Run):
    came = periph_sim("rgs")
    assert came.status == 2
    assert "there is no command 'rgs'; did you mean regs?" in came.err


@pytest.mark.parametrize("arguments", [("--help",), ("decode", "--help"), ("decode", TRACE, "--format", "csv")])
def test_what_needs_no_chips_loads_none(arguments: tuple[str, ...]):
    loaded = imported_by(*arguments)
    assert "periph_sim.cli" in loaded
    assert [name for name in loaded if name.startswith(HEAVY)] == []


@pytest.mark.parametrize("name", sorted(MISTAKES))
def test_every_mistake_is_an_error_there_is(name: str):
    module, _, error = name.rpartition(".")
    assert issubclass(getattr(importlib.import_module(module), error), Exception)
