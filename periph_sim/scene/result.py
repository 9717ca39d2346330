"""The result of a run: the figures that tables and `--json` show."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..timing.verdict import Verdict

# Counts that tell of the simulator, not of the case.
SKIPPED = "polls_skipped"


@dataclass
class Result:
    """The result of a run. wall_s: seconds of real time of the run, without building the scene.

    bytes_skipped: I2C bytes of which seven bits were skipped.
    sci_bytes: characters that others sent to SCIs of units. sci_bytes_sent: characters that SCIs of units sent.

    estimated: units whose cycles between accesses are estimated.
    """

    case: str
    verdict: str
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
    bytes_skipped: int = 0
    fidelity: str = "exact"  # the only one; for readers of `--json` of earlier versions
