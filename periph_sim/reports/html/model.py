"""What a report says of a case: plain data that can be sent from one process to another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ...timing.verdict import Verdict
from .distribution import Distribution
from .explanation import Explanation
from .failure import Failure
from .over_time import OverTime
from .timeline import Timeline

Standing = Literal["good", "known", "bad"]


@dataclass(frozen=True)
class BudgetReport:
    """One budget. distribution: None of what is one number a run. timeline: None where it has no instant.

    limits: key and text of each. must_break: the case says so. explanation: how the worst came about. failure: what is
    not as it should be, and why. over_time: the values over the run, None of what is one number a run. others: around
    more occurrences beyond a limit, in order of time, their instants (ticks from the run's begin) and timelines.
    """

    verdict: Verdict
    limits: tuple[tuple[str, str], ...]
    source: str
    must_break: bool
    distribution: Distribution | None
    timeline: Timeline | None
    explanation: Explanation | None
    failure: Failure | None = None
    over_time: OverTime | None = None
    per_second: int = 10**9
    others: tuple[tuple[int, Timeline], ...] = ()

    @property
    def as_it_should_be(self) -> bool:
        return self.verdict.broken if self.must_break else self.verdict.passed


@dataclass(frozen=True)
class CaseReport:
    """One case. standing: "known" is a failure that the case says must be.

    commit: of its repository, "" if there is none.
    clocks: unit and its SYSCLKOUT as text. findings: what is not as it should be, beyond the verdicts. options: answers
    to open questions that the run came to, UNIT.GROUP.NAME. counts: everything else that was counted.
    """

    name: str
    about: str
    verdict: str  # "pass" or "fail"
    standing: Standing
    simulated_s: float
    wall_s: float
    clocks: tuple[tuple[str, str], ...]
    options: tuple[str, ...]
    changes: tuple[str, ...]
    counts: dict[str, int]
    findings: tuple[str, ...]
    notes: tuple[str, ...]
    budgets: tuple[BudgetReport, ...]
    commit: str = ""

    @property
    def failed_first(self) -> list[tuple[int, BudgetReport]]:
        """The budgets with their places, from 1; those that are not as they should be first."""
        return sorted(enumerate(self.budgets, 1), key=lambda one: (one[1].as_it_should_be, one[1].verdict.passed))
