"""Baselines made once for all tests of this folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.reports.baselines import check
from tests.reports.baselines.desk import put


@pytest.fixture
def cases(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder `cases` with one case that holds, and its baseline; also the current folder's only content."""
    monkeypatch.chdir(tmp_path)
    folder = Path("cases")
    put(folder)
    (written,) = check([folder], jobs=1, update=True)
    assert (written.state, written.findings) == ("written", [])
    return folder
