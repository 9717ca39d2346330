"""A case with a baseline and a coverage file, built once for all tests of this folder; each test has a copy."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.interfaces.reports.covered_desk import put_covered


@pytest.fixture(scope="session")
def covered_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("covered")
    put_covered(folder)
    return folder / "cases"


@pytest.fixture
def covered(covered_once: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Copy the case file cases/small.toml, its baseline and its coverage file to an otherwise empty current folder."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(covered_once, "cases")
    return Path("cases/small.toml")
