"""Removed names raise an error that names the replacement."""

from __future__ import annotations

import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import periph_sim
from periph_sim.removed import COMMANDS, LEVELS, MOVED, NAMES
from tests.interfaces.commands.conftest import Run
from tests.interfaces.commands.conftest import periph_sim as command  # noqa: F401

CASE = str(Path(__file__).parents[1] / "timing" / "responder.toml")


@pytest.mark.parametrize("name", NAMES)
def test_the_error_of_a_removed_name_says_what_to_use(name: str):
    result = subprocess.run(
        [sys.executable, "-c", f"from periph_sim import {name}"], capture_output=True, text=True, check=False
    )
    assert result.returncode == 1
    assert result.stderr.splitlines()[-1] == f"ImportError: {NAMES[name]}"
    with pytest.raises(ImportError, match=rf"^periph_sim\.{name} was removed: .*, periph_sim\.sweep "):
        getattr(periph_sim, name)
    assert (
        name not in dir(periph_sim)
        and periph_sim.sweep is import_module("periph_sim.interfaces.reports.sweep.sweep").sweep
    )


@pytest.mark.parametrize("arguments", [(), ("--help",), (CASE, "--seconds", "1", "--json")])
@pytest.mark.parametrize("name", COMMANDS)
def test_a_removed_command_says_what_to_use(command: Run, name: str, arguments: tuple[str, ...]):  # noqa: F811
    result = command(name, *arguments)
    assert (result.status, result.out) == (2, "")
    assert result.err == f"Error: {COMMANDS[name]}\n" and "`periph-sim prove`" in result.err
    assert f"\n  {name} " not in command("--help").out and "\n  sweep " in command("--help").out


@pytest.mark.parametrize("how", [("--fidelity", "schedule"), ("--set", 'fidelity={I2C-A = "schedule"}')])
def test_a_removed_level_says_what_to_use(command: Run, how: tuple[str, str]):  # noqa: F811
    result = command("run", CASE, *how)
    assert (result.status, result.out) == (2, "")
    assert result.err.count("\n") == 1 and result.err.endswith(f"{LEVELS['schedule']}\n")


@pytest.mark.parametrize("former", MOVED)
def test_a_moved_module_is_found_by_its_former_name_with_a_warning(former: str):
    sys.modules.pop(former, None)
    with pytest.warns(FutureWarning, match=rf"^{former} is now {MOVED[former]}, and its former name "):
        found = import_module(former)
    assert set(vars(import_module(MOVED[former]))) - {"__cached__", "__file__"} <= {*vars(found), "__builtins__"}


def test_both_names_of_a_moved_package_give_the_same_objects():
    code = "from periph_sim.sensors import motion; from periph_sim.sensors.models.parameters import ImuParameters"
    code += "; import periph_sim.imu.motion as n; import periph_sim.imu.models.parameters as p"
    code += "; print(p.ImuParameters is ImuParameters, motion.BadMotion is n.BadMotion)"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert result.stdout == "True True\n"
    assert result.stderr.count("FutureWarning: periph_sim.sensors is now periph_sim.imu") == 1
    with pytest.warns(FutureWarning), pytest.raises(ModuleNotFoundError, match=r"periph_sim\.imu\.nothing"):
        import_module("periph_sim.sensors.nothing")


def test_a_folder_that_an_update_left_behind_does_not_hide_the_moved_package(tmp_path: Path):
    (tmp_path / "sensors" / "__pycache__").mkdir(parents=True)
    code = f"import periph_sim; periph_sim.__path__.append({str(tmp_path)!r}); from periph_sim.sensors import motion"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert result.returncode == 0 and "periph_sim.sensors is now periph_sim.imu" in result.stderr
    packages = {name.split(".")[1] for name in MOVED if name.count(".") == 1}
    assert packages == set(periph_sim._FORMER_PACKAGES)
