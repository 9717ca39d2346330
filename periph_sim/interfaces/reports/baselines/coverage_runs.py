"""Runs of the worst values of coverage files, started for all cases of a check at once.

cases --start_coverages--> calls in other processes --> a function for each case that waits for its CoverageCheck
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from ....core.tolerance import Tolerance
from ....proof.saved_paths import coverage_path
from .files import BadCheck
from .workers import Start

if TYPE_CHECKING:
    from ..coverage_check import CoverageCheck


def start_coverages(
    cases: Iterable[tuple[Path, tuple[str, ...]]], start: Start, tolerance: int | Tolerance
) -> dict[Path, Callable[[], CoverageCheck | None]]:
    """Start the runs of the worst values of each coverage file.

    Return a dictionary from each case to a function that waits for the result, which is None without a coverage file.

    cases: pairs of a case and the changes that are applied to it.
    """
    found: dict[Path, Callable[[], CoverageCheck | None]] = {}
    for case, changes in cases:
        if coverage_path(case).exists():
            from ..coverage_check import check_coverage  # imported here, because few cases have such a file

            found[case] = _or_finding(case, start(check_coverage, case, changes, tolerance))
        else:
            found[case] = lambda: None
    return found


def _or_finding(case: Path, wait: Callable[[], CoverageCheck]) -> Callable[[], CoverageCheck]:
    """Return a function that calls `wait`. If the process of the runs has died, it returns a result with a finding."""
    from ..coverage_check import without_runs

    def result() -> CoverageCheck:
        try:
            return wait()
        except BadCheck as error:
            return without_runs(coverage_path(case), "changed", f"at a phase of its coverage: {error}")

    return result


def not_run(case: Path, why: str) -> CoverageCheck | None:
    """Return the result for the coverage file of a case that is not run; None if there is no file."""
    path = coverage_path(case)
    if not path.exists():
        return None
    from ..coverage_check import without_runs

    return without_runs(path, "not run", f"{path.as_posix()}: {why}")
