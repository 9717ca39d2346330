"""A command run by the server is as one that was started by itself: what goes in, what comes out, its place."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.docs.pages import ROOT
from tests.docs.warm import folder_of_commands

BESIDE_PYTHON = str(Path(sys.executable).parent)  # where the installed command is
CASE = """\
name = "told"
duration = "1 ms"
[unit.dsp]
firmware = "told.py"
modules = ["I2C-A"]
"""
TOLD = """\
import os, sys
def main(dsp, settings):
    environment = {name: value for name, value in os.environ.items() if name not in ("PATH", "_")}
    print(os.path.basename(sys.argv[0]), sys.argv[1:], os.getcwd(), environment, sys.stdin.read())
    print(sys.path[1], len(sys.path), sys.stdin.encoding, sys.stdout.line_buffering, file=sys.stderr)
"""


def ran(folder: str, command: str, place: Path) -> subprocess.CompletedProcess[str]:
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
        ("periph-sim run case.toml --json < told.py | head -2; echo ${PIPESTATUS[0]}", 0),
        ("periph-sim run case.toml < told.py 2> b.txt | periph-sim decode no.vcd", 2),
    ],
)
def test_a_command_does_as_it_does_by_itself(warm: str, command: str, status: int, tmp_path: Path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    (tmp_path / "told.py").write_text(TOLD, encoding="utf-8")
    came, wanted = (ran(folder, command, tmp_path) for folder in (warm, BESIDE_PYTHON))
    assert (came.stdout, came.stderr, came.returncode) == (wanted.stdout, wanted.stderr, wanted.returncode)
    assert came.returncode == status and came.stdout + came.stderr


def test_a_command_that_is_ended_by_a_signal_says_so(warm: str, tmp_path: Path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    (tmp_path / "told.py").write_text("import os, signal\ndef main(*_): os.kill(os.getpid(), signal.SIGKILL)\n")
    assert ran(warm, "periph-sim run case.toml; echo $?", tmp_path).stdout == "137\n"
