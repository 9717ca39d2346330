"""Check of a capture against the timing limits of the I2C-bus specification, for the command line and for tests.

    Capture --measure--> times of every limit --row_of--> Report: pass, fail, or undecidable at this sample rate

In a test: `check(capture, "SCL", "SDA", Mode.FAST).assert_compliant()`.
"""

from __future__ import annotations

from ..capture.capture import Capture, gap_notes
from ..capture.sampling import stamp_notes
from .limits import LIMITS, Mode, resolution_of
from .measure import measure
from .report import Report, Row, Verdict, row_of

__all__ = ["Mode", "Report", "Row", "Verdict", "check"]


def check(
    capture: Capture,
    scl: str | int = "SCL",
    sda: str | int = "SDA",
    mode: Mode | str = Mode.STANDARD,
    *,
    exact: bool | None = None,
) -> Report:
    """Return a report with the verdict on each limit of the mode. The `str()` of the report is a table.

    exact: how time stamps are interpreted; see `resolution_of`.

    Raise LookupError if a channel is missing or ambiguous, and ValueError if the capture has no rate or the mode is
    unknown.
    """
    mode = Mode(mode)
    resolution = resolution_of(capture, exact)
    measures = measure(capture, scl, sda, mode, resolution)
    notes = list(capture.notes)
    notes += stamp_notes(capture) if resolution.slack else []
    notes += gap_notes(capture, capture.channel(scl), capture.channel(sda))
    if measures.blind:
        notes.append(
            f"pulses that mode {mode.value} allows may be shorter than a sample and lie between two: no limit passes"
        )
    rows = tuple(row_of(limit, measures, mode, resolution) for limit in LIMITS)
    return Report(str(capture.path), mode, resolution, rows, measures.starts, len(measures.shared), tuple(notes))
