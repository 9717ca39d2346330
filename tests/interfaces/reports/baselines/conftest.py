"""A case and its baseline, made once for all tests of this folder; each test has a copy of its own."""

from __future__ import annotations

import shutil
from contextlib import chdir
from pathlib import Path

import pytest

from periph_sim.interfaces.reports.baselines.check import check
from tests.interfaces.reports.baselines.desk import put


@pytest.fixture(scope="session")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that holds `cases`, with one case that holds and its baseline."""
    folder = tmp_path_factory.mktemp("written")
    with chdir(folder):  # paths in messages count from there
        put(Path("cases"))
        (one,) = check(["cases"], jobs=1, update=True)
    assert (one.state, one.findings) == ("written", [])
    return folder


@pytest.fixture
def cases(written: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder `cases` with one case that holds, and its baseline; also the current folder's only content."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(written / "cases", "cases")
    return Path("cases")
