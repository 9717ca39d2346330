"""A small project of an earlier version: its cases, baselines, recording, tests and imports go on working.

The files of `earlier_project` were written for commit 4dbea76, and its baselines and recording by that version.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent / "earlier_project"
IMPORTS = (HERE / "documented_imports.txt").read_text(encoding="utf-8").splitlines()  # of README, docs and firmware


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = shutil.copytree(HERE, tmp_path / "project")
    (folder / "board_tests.py").rename(folder / "test_board.py")
    return folder


def ran(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-W", "ignore", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_its_cases_keep_their_figures(project: Path):
    came = ran(project, "-m", "periph_sim", "check")
    assert (came.returncode, came.stderr) == (0, "")
    rows = [line.split() for line in came.stdout.splitlines()]
    assert [row[0] for row in rows if row[-2:] == ["equal", "pass"]] == ["thermometer", "tilt"]


def test_a_figure_that_changed_is_still_a_change(project: Path):
    """The notes on counts that only the earlier version wrote hide nothing else."""
    firmware = project / "bench" / "tilt.py"
    firmware.write_text(firmware.read_text().replace("compute(15_000)", "compute(15_001)"))
    came = ran(project, "-m", "periph_sim", "check")
    assert came.returncode == 1 and "work worst 15000 -> 15001 cycles" in came.stdout


def test_its_tests_pass_and_read_its_recording(project: Path):
    came = ran(project, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_board.py")
    assert came.returncode == 0 and "3 passed" in came.stdout


def test_its_documented_imports_are_found():
    code = "\n".join(IMPORTS)
    came = ran(HERE, "-c", code)
    assert (came.returncode, came.stderr) == (0, "") and len(IMPORTS) > 45
