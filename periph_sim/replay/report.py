"""What a replay came to, as `periph-sim replay` prints it."""

from __future__ import annotations

from dataclasses import dataclass, field

from .compare import Divergence


@dataclass
class Report:
    """events: of the capture, compared. agreed: up to the first that differs. bytes, nacks: on the replayed wires.

    bytes: I2C with addresses; UART what the firmware took from the SCI. lag: the largest time from an event of the
    capture to the same in the replay; of a UART word from its start bit to the firmware's read. wall_s: the run alone.
    """

    case: str
    capture: str
    kind: str  # i2c or uart
    verdict: str  # pass or fail
    events: int
    agreed: int
    first_divergence: Divergence | None
    bytes: int
    addresses: list[str] = field(default_factory=list)  # I2C: those left to the firmware, in hexadecimal
    nacks: int = 0
    errors: dict[str, int] = field(default_factory=dict)  # receiver flags that rose, how often
    stretch_worst_us: float = 0.0
    stretch_total_us: float = 0.0
    lag_worst_us: float = 0.0
    simulated_s: float = 0.0
    wall_s: float = 0.0
    kernel_events: int = 0
    unknowns: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
