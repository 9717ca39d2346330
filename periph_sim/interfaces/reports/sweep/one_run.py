"""Execution of single runs of a sweep in worker processes. Job and Row can be sent between processes."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from pathlib import Path

from ....core.kernel import SimulationStuck
from ....f28335.memory.memory_map import NoSuchAddress
from ....processor.user_code import FirmwareError
from ....scene.case.model import BadCase
from ....scene.case.toml_file import text_of
from ....scene.firmware_loader import Firmware
from ....scene.prepared import PreparedScene
from ....timing.verdict import Verdict

REFUSED = (BadCase, SimulationStuck, NoSuchAddress, FirmwareError)
ERROR = "error"  # the verdict of a run that could not be made


@dataclass(frozen=True)
class Job:
    """The data that all runs of a sweep share.

    shown: the path of the file as the caller wrote it, for messages.
    length: the duration of each run in seconds, in place of that of the case.
    """

    file: str
    shown: str
    length: Fraction | None
    programs: Mapping[str, Firmware]


@dataclass
class Row:
    """The figures of a run, named as in a `Result`. verdict: "error" if the run failed; `error` then says why."""

    verdict: str
    error: str = ""
    simulated_s: float = 0.0
    wire_bytes: int = 0
    sci_bytes: int = 0
    sci_bytes_sent: int = 0
    events: int = 0
    budgets: list[Verdict] = field(default_factory=list)
    counts: dict[str, int] = field(default_factory=dict)


def rows_of(job: Job, runs: Sequence[Sequence[str]]) -> list[Row]:
    """Execute some runs one after the other and return their rows. runs: the changes of each run, as for `--set`."""
    return [_row(job, changes) for changes in runs]


@lru_cache(maxsize=4)
def _prepared(file: str, text: str) -> PreparedScene:
    """Return the prepared scene of a file. A worker keeps it for later runs, as long as the file has the same text."""
    return PreparedScene(file)


def _row(job: Job, changes: Sequence[str]) -> Row:
    try:
        prepared = _prepared(job.file, text_of(Path(job.file), "case"))
        result = prepared.scene(changes, None, job.programs).run(job.length)
    except REFUSED as error:
        return Row(ERROR, _as_named(job, str(error)))
    return Row(
        result.verdict,
        simulated_s=result.simulated_s,
        wire_bytes=result.wire_bytes,
        sci_bytes=result.sci_bytes,
        sci_bytes_sent=result.sci_bytes_sent,
        events=result.events,
        budgets=result.budgets,
        counts=result.counts,
    )


def _as_named(job: Job, text: str) -> str:
    """Return a message with the path of the case as the caller wrote it."""
    folder, shown = (str(Path(path).parent) for path in (job.file, job.shown))
    return text.replace(job.file, job.shown).replace(f"{folder}{os.sep}", "" if shown == "." else f"{shown}{os.sep}")
