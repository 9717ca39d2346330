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

    moved: the kind of the moved starts: "frames", "rounds" or "sends".
    start_up: True if the first start is moved through the start-up.
    count: the number of all phases of a period.
    cycle_ps: the length of a cycle in picoseconds.
    chosen: the number of phases to run. near: how many of them are chosen because they are near a write.
    step: the distance between the other chosen phases, in cycles.
    rounds: the number of moved starts in a run with one phase alone.
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
        """Return a phase as a time, such as "18.9512933 ms". The digits suffice to distinguish all phases."""
        return f"{phase * self.cycle_ps / 10**9:.7f} ms"


class CoverageFile(SavedFile, frozen=True, kw_only=True):
    """The contents of a coverage file.

    case: the name of the case.
    finished, parts: the number of parts that are finished, and of all parts.
    run_count: the number of different phases that were run.
    held: the chosen phases that held, as ranges of indices (`to_ranges`).
    found: the results, without their list `held`, which would be long.
    windows: the windows; None until their ends are found, after all parts are finished.
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
        """True if all parts are finished and all windows are found."""
        return self.windows is not None


def digest_of(phases: Sequence[int]) -> str:
    return blake2b(",".join(map(str, phases)).encode(), digest_size=16).hexdigest()


def to_ranges(held: Sequence[int], chosen: Sequence[int]) -> list[tuple[int, int]]:
    """Return the indices of `held` in `chosen` as ranges, such as [(1, 3)] for [10, 20] in [0, 10, 20, 30]."""
    there = {*held}
    indices = {index for index, phase in enumerate(chosen) if phase in there}
    firsts = sorted(index for index in indices if index - 1 not in indices)
    afters = sorted(index + 1 for index in indices if index + 1 not in indices)
    return list(zip(firsts, afters, strict=True))


def from_ranges(ranges: Sequence[tuple[int, int]], chosen: Sequence[int]) -> list[int]:
    """Return the phases of `chosen` at these ranges of indices. This reverses `to_ranges`."""
    return [phase for first, after in ranges for phase in chosen[first:after]]
