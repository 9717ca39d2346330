"""A run that may be recorded: a path, or none, goes in; what a scene calls to be recorded comes out.

Who records nothing imports no writer, and no table of records either.
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
    """As `recording` gives them, or two functions that do nothing."""
    if path is None:
        return nullcontext((_nobody_subscribes, _nobody_is_told))
    from .recording import recording

    return recording(path, modules)


def _nobody_subscribes(recorder: Recorder, timebase: Timebase) -> None:
    """Nothing is recorded."""


def _nobody_is_told(tick: int, clocks: Clocks | None = None) -> None:
    """Nothing is written."""
