"""Where a report comes from: the commit of the case's repository, in a repository made for it."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

import periph_sim
from periph_sim import form
from periph_sim.interfaces.reports.html.provenance import commit_of, versions


def git(folder: Path, *command: str) -> str:
    who = ("-c", "user.name=a", "-c", "user.email=a@b", "-c", "commit.gpgsign=false")
    return subprocess.run(["git", "-C", str(folder), *who, *command], check=True, capture_output=True, text=True).stdout


def test_a_commit_is_told_and_whether_files_differ_from_it(tmp_path: Path) -> None:
    git(tmp_path, "init", "-q")
    assert commit_of(tmp_path) == ""  # none yet
    case = tmp_path / "timing" / "case.toml"
    case.parent.mkdir()
    case.write_text("a", encoding="utf-8")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "-qm", "first")
    commit = git(tmp_path, "rev-parse", "HEAD")[:12]
    (tmp_path / "report.html").write_text("new", encoding="utf-8")  # nobody's change
    assert commit_of(case.parent) == commit
    case.write_text("b", encoding="utf-8")
    assert commit_of(case.parent) == f"{commit}, and uncommitted changes"


def test_without_a_repository_or_git_there_is_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    assert commit_of(tmp_path) == "" and commit_of(tmp_path / "nowhere") == ""
    monkeypatch.setenv("PATH", "")
    assert commit_of(Path(__file__).parent) == ""


def test_versions_name_the_form_of_the_core() -> None:
    assert versions().startswith(f"periph-sim {periph_sim.__version__}, {form.running}, Python 3.")
