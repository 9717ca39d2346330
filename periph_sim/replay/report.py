"""Result of a replay, as printed by `periph-sim replay`, with its verdict.

pass         everything judged is as in the capture
ambiguous    as pass, except for places that receivers may read either way
not judged   nothing is proved: the capture requires nothing of the firmware, a serial line does not fit its format, or
             the firmware did not cause the first difference
fail         something differs
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ..timing.verdict import Verdict
from .compare import Divergence


@dataclass
class Report:
    """The result of a replay.

    events: number of compared events of the capture.
    agreed: number of these events that are also in the replay, in the same order.
    first_divergence: the earliest divergence that is not of kind TIMING, without its history.
    divergences: the first divergence of each kind, in order of time, with its history. A divergence of kind TIMING
        exceeds the tolerance. It makes the replay fail only if the user has given a tolerance.
    bytes: I2C: number of bytes on the replayed wires, addresses included. UART: number of bytes that the firmware read.
    nacks: number of NACKs on the replayed wires.
    captured_events, captured_transfers: numbers of events and transfers in the whole capture.
    transfers: number of replayed transfers.
    captured_errors: number of UART frames with a framing or parity error in the capture, without breaks.
    ambiguous: number of events that are not judged, because receivers may read them in different ways.
    filled: names of the firmware's settings that were taken from the capture.
    unjudged: the reason why nothing was judged.
    lag_worst_us: the largest difference in time between an event of the capture and the same event in the replay. For
        UART, it is the largest time from a word's start bit to the firmware's read of the word.
    lag_samples: `lag_worst_us` in sample periods of the capture.
    late_worst_us: open loop: the longest time for which the chip holds SCL low after SCL rises in the capture.
    wall_s: the duration of the run in seconds of real time, without preparation and comparison.
    """

    case: str
    capture: str
    kind: str  # kind of the replay: i2c, uart, or session (both together)
    verdict: str  # pass, ambiguous, not judged or fail
    events: int
    agreed: int
    first_divergence: Divergence | None
    bytes: int
    captured_events: int = 0
    transfers: int = 0
    captured_transfers: int = 0
    captured_errors: int = 0
    ambiguous: int = 0
    filled: list[str] = field(default_factory=list)
    unjudged: str = ""
    loop: str = "closed"  # closed loop or open loop
    role: str = "slave"  # I2C: role of the F28335, slave or master
    divergences: list[Divergence] = field(default_factory=list)
    tolerance_us: float = 0.0
    addresses: list[str] = field(default_factory=list)  # I2C: addresses of the firmware, or of its targets as a master
    nacks: int = 0
    errors: dict[str, int] = field(default_factory=dict)  # UART: how often each error flag was read or set
    stretch_worst_us: float = 0.0
    stretch_total_us: float = 0.0
    captured_stretch_us: float = 0.0  # longest stretch or pause in the capture
    late_worst_us: float = 0.0
    lag_worst_us: float = 0.0
    lag_samples: float = 0.0
    simulated_s: float = 0.0
    wall_s: float = 0.0
    kernel_events: int = 0
    budgets: list[Verdict] = field(default_factory=list)  # verdicts of budgets; only the replay of a session has them
    unknowns: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


PASS, AMBIGUOUS, NOT_JUDGED, FAIL = "pass", "ambiguous", "not judged", "fail"

# For each setting that a replay fills in from the capture: what it determines, which is therefore not judged.
DECIDES = {"replies": "the data", "asleep": "the refusals", "busy": "the refusals", "script": "the requests"}


def verdict_of(failed: bool, asked: bool, ambiguous: int = 0) -> str:
    """Return the verdict of a replay.

    failed: True if the replay differs from the capture.
    asked: True if the capture requires something of the firmware.
    ambiguous: number of ambiguous events.
    """
    if failed:
        return FAIL
    if not asked:
        return NOT_JUDGED
    return AMBIGUOUS if ambiguous else PASS


def headline(report: Report) -> str:
    """Return the first line of a printed report: the verdict, the judged part of the capture, and restrictions."""
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
    """Return a phrase with the replayed part of the capture; "" if the whole capture was replayed."""
    if report.captured_events <= report.events:
        return ""
    transfers = f", {report.transfers} of {report.captured_transfers} transfers" if report.captured_transfers else ""
    return f"{report.events} of {report.captured_events} events{transfers}"
