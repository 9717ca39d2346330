"""Names that were removed fail with one sentence, which says what to use instead."""

from __future__ import annotations

import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import periph_sim
from periph_sim.removed import COMMANDS, LEVELS, NAMES
from tests.commands.conftest import Run
from tests.commands.conftest import periph_sim as command  # noqa: F401

CASE = str(Path(__file__).parents[1] / "timing" / "responder.toml")


@pytest.mark.parametrize("name", NAMES)
def test_a_removed_name_cannot_be_imported_and_the_error_says_what_to_use(name: str):
    came = subprocess.run(
        [sys.executable, "-c", f"from periph_sim import {name}"], capture_output=True, text=True, check=False
    )
    assert came.returncode == 1
    assert came.stderr.splitlines()[-1] == f"ImportError: {NAMES[name]}"
    with pytest.raises(ImportError, match=rf"^periph_sim\.{name} was removed: .*; until then periph_sim\.sweep "):
        getattr(periph_sim, name)
    assert name not in dir(periph_sim) and periph_sim.sweep is import_module("periph_sim.reports.sweep.sweep").sweep


@pytest.mark.parametrize("arguments", [(), ("--help",), (CASE, "--seconds", "1", "--json")])
@pytest.mark.parametrize("name", COMMANDS)
def test_a_removed_command_says_what_to_use(command: Run, name: str, arguments: tuple[str, ...]):  # noqa: F811
    came = command(name, *arguments)
    assert (came.status, came.out) == (2, "")
    assert came.err == f"Error: {COMMANDS[name]}\n" and "`periph-sim sweep`" in came.err
    assert f"\n  {name} " not in command("--help").out and "\n  sweep " in command("--help").out


@pytest.mark.parametrize("how", [("--fidelity", "schedule"), ("--set", 'fidelity={I2C-A = "schedule"}')])
def test_a_removed_level_says_what_to_use(command: Run, how: tuple[str, str]):  # noqa: F811
    came = command("run", CASE, *how)
    assert (came.status, came.out) == (2, "")
    assert came.err.count("\n") == 1 and came.err.endswith(f"{LEVELS['schedule']}\n")
