from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """Return the path at which a session writes its log."""
    return tmp_path / "live.jsonl"
