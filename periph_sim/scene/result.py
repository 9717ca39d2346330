"""What a run came to: the figures that tables and `--json` show."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..timing.verdict import Verdict

# Counts that tell of the simulator, not of the case.
SKIPPED = "polls_skipped"
FRAMES = "sci_frames"  # sent on UART lines, where some may pass at once,
FRAMES_PASSED = "sci_frames_passed"  # and those of them of which only the first and the last edge were events
BYTE_LEVEL = "byte_level"  # I2C bytes of which seven bits passed at once, where fidelity is "adaptive"


@dataclass
class Result:
    """What a run came to. wall_s: the run alone, building apart.

    sci_bytes: characters that others sent to SCIs of units. sci_bytes_sent: characters that SCIs of units sent.

    estimated: units whose cycles between accesses are estimated.
    """

    case: str
    verdict: str
    fidelity: str
    simulated_s: float
    wall_s: float
    events: int
    wire_bytes: int
    sci_bytes: int
    budgets: list[Verdict]
    counts: dict[str, int]
    unknowns: list[str]
    notes: list[str]
    stuck: list[str]
    wrong: dict[str, int] = field(default_factory=dict)
    first_wrong: str = ""
    estimated: list[str] = field(default_factory=list)
    sci_bytes_sent: int = 0

    @property
    def share_above_edges(self) -> str:
        """`100.0 % of the I2C bytes and 98.3 % of the SCI frames at byte level`; empty where each goes edge by edge."""
        counts = self.counts
        of = (
            (counts.get(BYTE_LEVEL), self.wire_bytes, "I2C bytes"),
            (counts.get(FRAMES_PASSED), counts.get(FRAMES), "SCI frames"),
        )
        told = [
            f"{100 * passed / count:.1f} % of the {what}" for passed, count, what in of if passed is not None and count
        ]
        return f"{' and '.join(told)} at byte level" if told else ""
