"""The path of a case's coverage file. This module imports hardly anything, so that looking for a file is fast."""

from __future__ import annotations

from pathlib import Path

FOLDER = "coverage"


def path_for(case: Path) -> Path:
    """Return the path of the coverage file of a case, which need not exist."""
    return case.parent / FOLDER / f"{case.stem}.json"
