"""Execution of single runs of a sweep in worker processes. A Job and its rows can be sent between processes."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from pathlib import Path

from ....scene.case.toml_file import text_of
from ....scene.firmware_loader import Firmware
from ....scene.prepared import PreparedScene
from ....scene.result import Result
from .. import REFUSED

Row = Result | str  # the result of a run, or the reason why it could not be made


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
        return prepared.scene(changes, None, job.programs).run(job.length)
    except REFUSED as error:
        return _as_named(job, str(error))


def _as_named(job: Job, text: str) -> str:
    """Return a message with the path of the case as the caller wrote it."""
    folder, shown = (str(Path(path).parent) for path in (job.file, job.shown))
    return text.replace(job.file, job.shown).replace(f"{folder}{os.sep}", "" if shown == "." else f"{shown}{os.sep}")
