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
    divergences: the first divergence of each kind, in order of time, with the chip's activity around it. One of kind
        TIMING exceeds the tolerance; it fails the replay if a tolerance was given.
    bytes: I2C: number of bytes on the replayed wires, addresses included. UART: number of bytes that the firmware read.
    nacks: number of NACKs on the replayed wires.
    captured_events, captured_transfers: numbers of events and transfers in the whole capture.
    transfers: number of replayed transfers.
    captured_errors: number of captured UART frames, except breaks, that have a framing or parity error themselves.
    ambiguous: number of events that are not judged, because receivers may read them either way.
    filled: names of the firmware's settings that were taken from the capture.
    unjudged: the reason why nothing was judged.
    lag_worst_us: the largest time from an event of the capture to the same event in the replay; for a UART word the
        largest time from its start bit to the firmware's read.
    lag_samples: the same time in sample periods of the capture.
    late_worst_us: open loop: the longest time for which the chip held SCL low after its rise in the capture.
    wall_s: the real time of the run alone, in seconds.
    """

    case: str
    capture: str
    kind: str  # kind of the capture: i2c, uart or session
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
    errors: dict[str, int] = field(default_factory=dict)  # UART: words read with FE or PE, and rises of other flags
    stretch_worst_us: float = 0.0
    stretch_total_us: float = 0.0
    captured_stretch_us: float = 0.0  # longest stretch by a captured target, or pause of its controller
    late_worst_us: float = 0.0
    lag_worst_us: float = 0.0
    lag_samples: float = 0.0
    simulated_s: float = 0.0
    wall_s: float = 0.0
    kernel_events: int = 0
    budgets: list[Verdict] = field(default_factory=list)  # verdicts of the budgets of a session
    unknowns: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


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
    """Format the replayed part of the capture; return "" if the whole capture was replayed."""
    if report.captured_events <= report.events:
        return ""
    transfers = f", {report.transfers} of {report.captured_transfers} transfers" if report.captured_transfers else ""
    return f"{report.events} of {report.captured_events} events{transfers}"
