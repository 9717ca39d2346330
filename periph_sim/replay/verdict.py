"""The verdict of a replay, and a line of text about it.

pass         everything judged is as in the capture
ambiguous    as pass, except for places that receivers may read either way
not judged   nothing was required of the firmware, a serial line does not fit its format, or the first difference is not
             the firmware's: nothing is proved
fail         something differs
"""

from __future__ import annotations

from .report import Report

PASS, AMBIGUOUS, NOT_JUDGED, FAIL = "pass", "ambiguous", "not judged", "fail"

# The part of the behaviour that each setting of the firmware determines if it was filled in from the capture.
DECIDES = {"replies": "the data", "asleep": "the refusals", "busy": "the refusals", "script": "the requests"}


def verdict_of(failed: bool, asked: bool, ambiguous: int = 0) -> str:
    """Return the verdict of a replay.

    failed: True if something differs.
    asked: True if the capture requires something of the firmware.
    ambiguous: number of ambiguous events.
    """
    if failed:
        return FAIL
    if not asked:
        return NOT_JUDGED
    return AMBIGUOUS if ambiguous else PASS


def headline(report: Report) -> str:
    """Format the verdict, the judged part of the capture, and its limitations."""
    parts = [report.verdict.upper()]
    if report.verdict == NOT_JUDGED:
        return f"{parts[0]}: {report.unjudged}"
    if covered := _coverage(report):
        parts.append(f"for {covered}")
    if report.ambiguous:
        parts.append(f"({report.ambiguous} of {report.events} ambiguous)")
    if report.captured_errors:
        parts.append(f"({report.captured_errors} of {report.events} frames have errors in the capture itself)")
    taken = sorted({DECIDES[name] for name in report.filled if name in DECIDES})
    if taken and report.verdict != FAIL:
        return f"{' '.join(parts)}: timing and protocol only; {' and '.join(taken)} came from the capture"
    return " ".join(parts)


def _coverage(report: Report) -> str:
    """Format the replayed part of the capture; empty if all of it."""
    if report.captured_events <= report.events:
        return ""
    transfers = f", {report.transfers} of {report.captured_transfers} transfers" if report.captured_transfers else ""
    return f"{report.events} of {report.captured_events} events{transfers}"
