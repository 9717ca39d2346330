"""A command run by the server behaves as one that is started directly: input, output, folder and environment."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.docs.pages import ROOT
from tests.docs.warm import folder_of_commands

BESIDE_PYTHON = str(Path(sys.executable).parent)  # the folder of the installed command
CASE = """\
name = "small"
duration = "1 ms"
[unit.dsp]
firmware = "mine.py"
modules = ["I2C-A"]
"""
FIRMWARE = """\
import os, sys
def main(dsp, settings):
    environment = {name: value for name, value in os.environ.items() if name not in ("PATH", "_")}
    print(os.path.basename(sys.argv[0]), sys.argv[1:], os.getcwd(), environment, sys.stdin.read())
    print(sys.path[1], len(sys.path), sys.stdin.encoding, sys.stdout.line_buffering, file=sys.stderr)
"""


def run_in_shell(folder: str, command: str, place: Path) -> subprocess.CompletedProcess[str]:
    environment = {
        "PATH": os.pathsep.join((folder, BESIDE_PYTHON, os.environ["PATH"])),
        "PYTHONPATH": str(ROOT),
        "COLUMNS": "77",
        "LC_ALL": "C.UTF-8",
        "SPACES": "a  b\n'",
    }
    return subprocess.run(
        ["bash", "-c", command], cwd=place, env=environment, capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def warm() -> str:
    return folder_of_commands(os.environ["PATH"], ROOT)


@pytest.mark.long
@pytest.mark.parametrize(
    ("command", "status"),
    [
        ("periph-sim --help", 0),
        ("periph-sim rum case.toml", 2),
        ("periph-sim run case.toml < case.toml", 1),
        ("echo x | periph-sim run case.toml --set duration='2 ms' --record a.jsonl > b.txt 2>&1; cat a.jsonl b.txt", 0),
        ("periph-sim run case.toml --json < mine.py | head -2; echo ${PIPESTATUS[0]}", 0),
        ("periph-sim run case.toml < mine.py 2> b.txt | periph-sim decode no.vcd", 2),
    ],
)
def test_a_command_behaves_as_if_it_was_started_directly(warm: str, command: str, status: int, tmp_path: Path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    (tmp_path / "mine.py").write_text(FIRMWARE, encoding="utf-8")
    result, wanted = (run_in_shell(folder, command, tmp_path) for folder in (warm, BESIDE_PYTHON))
    assert (result.stdout, result.stderr, result.returncode) == (wanted.stdout, wanted.stderr, wanted.returncode)
    assert result.returncode == status and result.stdout + result.stderr


def test_a_command_killed_by_a_signal_has_its_exit_status(warm: str, tmp_path: Path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    (tmp_path / "mine.py").write_text("import os, signal\ndef main(*_): os.kill(os.getpid(), signal.SIGKILL)\n")
    assert run_in_shell(warm, "periph-sim run case.toml; echo $?", tmp_path).stdout == "137\n"
