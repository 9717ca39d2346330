"""The data of a case's report: plain data that can be sent between processes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ....timing.verdict import Verdict
from .distribution import Distribution
from .explanation import Explanation
from .failure import Failure
from .over_time import OverTime
from .timeline import Timeline

Standing = Literal["good", "known", "bad"]


@dataclass(frozen=True)
class BudgetReport:
    """The report of one budget.

    limits: key and text of each limit.
    must_break: True if the case says that the budget breaks.
    distribution, over_time: None if the budget has a single number per run.
    timeline: the timeline around the worst value; None if that has no instant.
    explanation: how the worst value came about.
    failure: what failed, and why.
    others: more occurrences beyond a limit, in order of time: the instant, in ticks from the start of the run, and the
    timeline.
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
    """One case. standing: "known" is a failure that the case expects.

    commit: of its repository, "" if there is none.
    clocks: unit and its SYSCLKOUT as text. findings: what is wrong beyond the verdicts. options: options for
    undocumented behaviour that the run used, UNIT.GROUP.NAME. counts: all other counts.
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
        """The budgets with their numbers, from 1; failed ones first."""
        return sorted(enumerate(self.budgets, 1), key=lambda one: (one[1].as_it_should_be, one[1].verdict.passed))
