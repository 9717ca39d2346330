"""Every module can be imported, and commands run, without the parts of POSIX that Windows lacks.

These are modules, signals, fork and pseudo-terminals.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.scene.runs import TIMING

ROOT = TIMING.parent
TERMINALS = "a pseudo-terminal needs Linux or macOS; serve an SCI at --port or --rfc2217, which every system has"


def run(*arguments: str, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    code = f"import sys; sys.path.insert(0, {str(ROOT)!r}); sys.argv[0] = 'periph-sim'; " + (
        "import runpy; runpy.run_module('tests.platforms.without_posix', run_name='__main__', alter_sys=True)"
    )
    return subprocess.run([sys.executable, "-c", code, *arguments], cwd=cwd, capture_output=True, text=True)


def test_every_module_can_be_imported_except_those_of_pseudo_terminals() -> None:
    result = run("imports")
    modules = ("periph_sim.outside.live.i2cdriver_door", "periph_sim.outside.live.pty_door")
    assert result.stdout.splitlines() == [f"{module}: {TERMINALS}" for module in modules], result.stderr


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the case and the firmware that `new` writes, and a recording of its run."""
    made = tmp_path_factory.mktemp("user")
    assert run("new", "i2c-slave", "mine", cwd=made).returncode == 0
    result = run("run", "mine.toml", "--record", "mine.vcd", cwd=made)
    assert result.returncode == 0, result.stderr
    return made


COMMANDS = {
    "check with workers": ("check", str(TIMING / "responder.toml"), str(TIMING / "two_dsps.toml"), "--jobs", "2"),
    "sweep with workers": ("sweep", "mine.toml", "--vary", "seed=1, 2", "--jobs", "2"),
    "decode": ("decode", "mine.vcd"),
    "convert": ("convert", "mine.vcd", "mine.vcd.csv"),
    "replay": ("replay", "mine.vcd", "--case", "mine.toml"),
    "worst": ("worst", "mine.toml"),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_runs(name: str, folder: Path) -> None:
    result = run(*COMMANDS[name], cwd=folder)
    assert (result.returncode, result.stderr if "Traceback" in result.stderr else "") == (0, "")
    assert result.stdout


def test_a_case_is_served_over_tcp(folder: Path) -> None:
    pytest.importorskip("serial", reason="pyserial is not installed: the extra live has it")
    result = run("serve", str(TIMING / "imu_hil.toml"), "--rfc2217", "0", "--pace", "0", "--for", "5 ms", cwd=folder)
    assert result.stdout.startswith("rfc2217://127.0.0.1:") and "Traceback" not in result.stderr
    assert result.returncode == 1 and "not judged: too little was measured" in result.stdout


@pytest.mark.parametrize("option", ["--pty", "--i2cdriver"])
def test_serving_at_a_pseudo_terminal_is_rejected_in_one_sentence(option: str, folder: Path) -> None:
    result = run("serve", str(TIMING / "imu_hil.toml"), option, "--for", "1 ms", cwd=folder)
    assert (result.returncode, result.stderr) == (2, f"Error: {TERMINALS}\n")
