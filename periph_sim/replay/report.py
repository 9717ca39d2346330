"""Result of a replay, as printed by `periph-sim replay`."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..timing.verdict import Verdict
from .compare import Divergence


@dataclass
class Report:
    """events: compared events of the capture. agreed: those also in the replay, in the same order. bytes, nacks: on the
    replayed wires.

    captured_events, captured_transfers: of the whole capture; transfers: number replayed. captured_errors: UART
    frames with a framing or parity error in the capture itself, without breaks. ambiguous: events that cannot be
    judged, since receivers may read them either way. filled: settings of the firmware that were taken from the
    capture. unjudged: why nothing was judged.

    first_divergence: the earliest except timing, without its history. divergences: the first of each kind in order of
    time, with the chip's activity around it; a timing difference is one above the tolerance, and fails the replay if
    a tolerance was given.

    bytes: I2C with addresses; UART: those the firmware read from the SCI. lag: the largest time from an event of the
    capture to the same in the replay; for a UART word from its start bit to the firmware's read; lag_samples: the same
    in sample periods of the capture. late: open loop, the longest time for which the chip still held SCL when it rose.
    wall_s: the run alone.
    """

    case: str
    capture: str
    kind: str  # i2c, uart or session
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
    loop: str = "closed"  # closed or open
    role: str = "slave"  # I2C: role of the F28335, slave or master
    divergences: list[Divergence] = field(default_factory=list)
    tolerance_us: float = 0.0
    addresses: list[str] = field(default_factory=list)  # I2C: those left to the firmware, in hexadecimal
    nacks: int = 0
    errors: dict[str, int] = field(default_factory=dict)  # receiver flags that rose, with their counts
    stretch_worst_us: float = 0.0
    stretch_total_us: float = 0.0
    captured_stretch_us: float = 0.0  # by the captured target, or a pause of its controller
    late_worst_us: float = 0.0
    lag_worst_us: float = 0.0
    lag_samples: float = 0.0
    simulated_s: float = 0.0
    wall_s: float = 0.0
    kernel_events: int = 0
    budgets: list[Verdict] = field(default_factory=list)  # of a session
    unknowns: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
