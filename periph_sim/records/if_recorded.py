"""Optional recording of a run.

A run that is not recorded imports neither a writer nor a table of records.
"""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from ..core.records import Recorder
from ..core.time import Timebase

if TYPE_CHECKING:
    from ..traces.formats.record_table import Clocks
    from .recording import EndedAt, Subscribe


def if_recorded(
    path: Path | None, modules: dict[str, tuple[str, ...]]
) -> AbstractContextManager[tuple[Subscribe, EndedAt]]:
    """Return `recording` for the path; without a path, a context of two functions that do nothing."""
    if path is None:
        return nullcontext((_nobody_subscribes, _nobody_is_told))
    from .recording import recording

    return recording(path, modules)


def _nobody_subscribes(recorder: Recorder, timebase: Timebase) -> None:
    """Subscribe to nothing, since the run is not recorded."""


def _nobody_is_told(tick: int, clocks: Clocks | None = None) -> None:
    """Ignore the end of the run, since nothing is recorded."""
