"""The paths of a case's saved results. This module imports hardly anything, so that looking for a file is fast."""

from __future__ import annotations

from pathlib import Path


def coverage_path(case: Path) -> Path:
    """Return the path of the coverage file of a case, which need not exist."""
    return case.parent / "coverage" / f"{case.stem}.json"


def proof_path(case: Path) -> Path:
    """Return the path of the proof file of a case, which need not exist."""
    return case.parent / "proofs" / f"{case.stem}.json"


def unfinished_path(case: Path) -> Path:
    """Return the path of the file with the parts of an unfinished proof of a case, which need not exist."""
    return case.parent / "proofs" / f"{case.stem}.unfinished"
