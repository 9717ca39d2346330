"""A small project of an earlier version: its cases, baselines, recording, tests and imports still work.

The files of `earlier_project` were written for commit 4dbea76, and its baselines and recording by that version.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent / "earlier_project"
IMPORTS = (HERE / "documented_imports.txt").read_text(encoding="utf-8").splitlines()


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = shutil.copytree(HERE, tmp_path / "project")
    (folder / "board_tests.py").rename(folder / "test_board.py")
    return folder


def run_python(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-W", "ignore", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_the_cases_keep_their_figures(project: Path):
    result = run_python(project, "-m", "periph_sim", "check")
    assert (result.returncode, result.stderr) == (0, "")
    rows = [line.split() for line in result.stdout.splitlines()]
    assert [row[0] for row in rows if row[-2:] == ["equal", "pass"]] == ["thermometer", "tilt"]


def test_a_figure_that_changed_is_still_a_change(project: Path):
    """The notes on counts that only the earlier version wrote do not hide other changes."""
    firmware = project / "bench" / "tilt.py"
    firmware.write_text(firmware.read_text().replace("compute(15_000)", "compute(15_001)"))
    result = run_python(project, "-m", "periph_sim", "check")
    assert result.returncode == 1 and "work worst 15000 -> 15001 cycles" in result.stdout


def test_the_tests_pass_and_read_the_recording(project: Path):
    result = run_python(project, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_board.py")
    assert result.returncode == 0 and "3 passed" in result.stdout


def test_the_documented_imports_work():
    code = "\n".join(IMPORTS)
    result = run_python(HERE, "-c", code)
    assert (result.returncode, result.stderr) == (0, "") and len(IMPORTS) > 45
