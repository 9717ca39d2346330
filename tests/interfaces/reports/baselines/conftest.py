"""A case and its baseline, built once for all tests of this folder; each test has a copy of its own."""

from __future__ import annotations

import shutil
from contextlib import chdir
from pathlib import Path

import pytest

from periph_sim.interfaces.reports.baselines.check import check
from tests.interfaces.reports.baselines.desk import put


@pytest.fixture(scope="session")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Create a folder `cases` with a passing case and its baseline, and return the folder above it."""
    folder = tmp_path_factory.mktemp("written")
    with chdir(folder):  # paths in messages are relative to it
        put(Path("cases"))
        (one,) = check(["cases"], jobs=1, update=True)
    assert (one.state, one.findings) == ("written", [])
    return folder


@pytest.fixture
def cases(written: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Copy the passing case and its baseline to `cases`, in an otherwise empty current folder."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(written / "cases", "cases")
    return Path("cases")
