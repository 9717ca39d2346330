"""The file of a coverage: coverage/NAME.json beside the case, with the results and everything they depend on.

    Covered, Window --text_of--> file --read--> the same results, for other commands, or to continue a coverage

The phases of a coverage are run in parts. If a file does not have the results of all parts, the coverage was stopped
and can be continued.
"""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import blake2b
from typing import ClassVar

import msgspec

from .cover import Covered, Window
from .saved_file import SavedFile


class Choice(msgspec.Struct, frozen=True):
    """The phases that a coverage runs.

    moved, start_up, rounds: as in `Phases`.
    count: the number of all phases, `Phases.count`.
    cycle_ps: the length of a cycle in picoseconds.
    chosen, near: the number of chosen phases, and how many of them are near a write (`near`).
    step: the distance between the other chosen phases, in cycles.
    bounds: the first and the last phase that may be run.
    digest: the digest of the chosen phases.
    """

    moved: str
    start_up: bool
    count: int
    cycle_ps: float
    chosen: int
    near: int
    step: int
    rounds: int
    bounds: tuple[int, int]
    digest: str

    def time(self, phase: int) -> str:
        """Return a phase as a time in ms, to a tenth of a nanosecond, so that the texts of all phases are different."""
        return f"{phase * self.cycle_ps / 10**9:.7f} ms"


class CoverageFile(SavedFile, frozen=True, kw_only=True):
    """The contents of a coverage file.

    case: the name of the case.
    finished, parts: the number of parts that are finished, and of all parts.
    run_count: the number of different phases that were run.
    held: the chosen phases that held, as ranges of their indices (`to_ranges`).
    found: the results, without the list `held`, which would be long.
    windows: the ranges of phases at which a budget is broken or the run fails in another way (`cover.Window`); None
        until their ends are found, after all parts are finished.
    """

    WHAT: ClassVar[str] = "coverage"
    RENEW: ClassVar[str] = "delete it, and write it again with prove --save"
    case: str
    choice: Choice
    finished: int
    parts: int
    run_count: int
    held: list[tuple[int, int]]
    found: Covered
    windows: list[Window] | None

    @property
    def is_complete(self) -> bool:
        return self.windows is not None


def digest_of(phases: Sequence[int]) -> str:
    return blake2b(",".join(map(str, phases)).encode(), digest_size=16).hexdigest()


def to_ranges(held: Sequence[int], chosen: Sequence[int]) -> list[tuple[int, int]]:
    """Return the indices in `chosen` of the phases in `held`, as ranges (first index, index after the last)."""
    there = {*held}
    indices = {index for index, phase in enumerate(chosen) if phase in there}
    firsts = sorted(index for index in indices if index - 1 not in indices)
    afters = sorted(index + 1 for index in indices if index + 1 not in indices)
    return list(zip(firsts, afters, strict=True))


def from_ranges(ranges: Sequence[tuple[int, int]], chosen: Sequence[int]) -> list[int]:
    """Return the phases whose indices in `chosen` are in these ranges, which `to_ranges` has returned."""
    return [phase for first, after in ranges for phase in chosen[first:after]]
