"""A case run at level "schedule": a case goes in; its budgets' verdicts come out, as those of a `Scene`.

    case --structure_of--> terms --Rounds, one scenario--> Journal --> transfers, frames, spans of the models
                                                                          '--> the measures of its budgets --> Result

Budgets on what the level does not tell are not judged, each with the level that tells it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from time import perf_counter

from ...core.time import Timebase, TimeError
from ...devices.host_pc import FRAME_BYTES
from ...scene.case.model import Case
from ...scene.limits import limits_of
from ...scene.result import AT_ANOTHER_LEVEL, Result
from ...scene.scope import scope_of_case
from ...timing.budget_schema import Budget
from ...timing.budgets import BudgetJudge
from ...timing.measures.age import Age
from ...timing.measures.bus import Nacked, Response, Stretch
from ...timing.measures.margin import Margin
from ...timing.measures.measure import Measure
from ...timing.measures.round import MissedRounds, NackedRounds, RoundTime, Slack
from ...timing.measures.span import SpanTime
from ...timing.verdict import FAIL, NOT_JUDGED, PASS, Verdict
from .errors import refuse
from .inputs import Inputs, inputs_of
from .journal import Journal
from .rounds import Rounds
from .structure import structure_of
from .told import Told

ANSWERED: tuple[type[Measure], ...] = (
    Response,
    Stretch,
    RoundTime,
    Slack,
    Age,
    Margin,
    SpanTime,
    MissedRounds,
    NackedRounds,
    Nacked,
)
IN_WORDS = "response, stretch, round, slack, age, margin of I2CDXR, span:NAME, missed rounds, nacked rounds, nacked"
FORGOTTEN = 'level "schedule" does not tell an age that so many frames may follow'


def tells(case: Case, budget: Budget) -> bool:
    """Whether the level gives a budget's verdict. BadCase for one that is none."""
    timebase = Timebase(*(int(each.oscclk * each.pll / 2) for each in case.unit.values()))
    (limit,) = limits_of(case.model_copy(update={"budget": (budget,)}), scope_of_case(case), timebase, 0)
    return not _lacking(limit)


class ScheduledScene:
    """case: as it is on edges. limits, start, timebase: as those of a `Scene`.

    structure: measured. happened: after `run`, what is no plain round: "a NACK", "a missed round", "a stretched byte",
    "a hang".

    BadCase where the case has another structure, or no budget that the level tells.
    """

    start = 0  # another begin is another structure

    def __init__(self, case: Case, *, keep_values: bool = False) -> None:
        began = perf_counter()
        self.structure = structure_of(case)
        self.happened: frozenset[str] = frozenset()
        self.case = self.structure.case
        self.timebase = Timebase(*(int(each.oscclk * each.pll / 2) for each in case.unit.values()))
        self.limits = limits_of(case, scope_of_case(case), self.timebase, self.start)
        self._lacks = {limit.budget.name: _lacking(limit) for limit in self.limits}
        if self.limits and all(self._lacks.values()):
            what = f'the level "schedule" tells none of these; it tells {IN_WORDS}'
            raise case.mistake(f'{what}; use fidelity = "edge", or "adaptive", which tell all', "budget")
        for limit in self.limits:
            if self._lacks[limit.budget.name]:
                limit.joined = []  # nobody tells them anything, so none can be the one that is shown
            elif keep_values and limit.measure.series:
                limit.measure.keep()
        self._built = perf_counter() - began

    def run(self, duration: Fraction | None = None, progress: Callable[[float], None] | None = None) -> Result:
        """As `Scene.run`."""
        wall = perf_counter()
        try:
            end = self.timebase.end_of_run(self.start, self.case.duration if duration is None else duration)
        except TimeError as error:
            raise self.case.mistake(str(error), "duration") from None
        inputs, journal = self._inputs(end), Journal()
        rounds = Rounds(self.structure, inputs, journal)
        rounds.run(progress)
        if rounds.refused[0]:
            raise refuse(self.case.name, "the module answers for firmware that is still elsewhere")
        told = Told(self.structure, inputs, rounds, journal)
        told.tell([measure for limit in self._judged() for measure in limit.own_measures])
        for limit in self._judged():
            limit.finish(end)
        told_of = {
            "a NACK": rounds.nacked[0],
            "a missed round": rounds.missed[0],
            "a stretched byte": rounds.held[0],
            "a hang": rounds.hung_at[0] >= 0,
        }
        self.happened = frozenset(what for what, there in told_of.items() if there)
        verdicts = [self._verdict(limit, told.forgotten) for limit in self.limits]
        return self._result(end, told, rounds, verdicts, self._built + perf_counter() - wall)

    def typical(self) -> list[Verdict]:
        """As `Scene.typical`. After `run`."""
        found = (limit.typical(self.start) for limit in self._judged())
        return [verdict for verdict in found if verdict is not None]

    def _judged(self) -> Iterator[BudgetJudge]:
        return (limit for limit in self.limits if not self._lacks[limit.budget.name])

    def _inputs(self, end: int) -> Inputs:
        """Of as many rounds as are due by the end."""
        one = inputs_of(self.structure, {}, 1, end)
        due = int(one.controller_first[0])
        rounds = max(end - due, 0) // int(one.round_.down(1)) + 1
        return inputs_of(self.structure, {}, rounds, end)

    def _verdict(self, limit: BudgetJudge, forgotten: bool) -> Verdict:
        lacking = self._lacks[limit.budget.name]
        if lacking:
            what = f'level "schedule" does not tell it; {AT_ANOTHER_LEVEL}'
        elif forgotten and any(isinstance(part.measure, Age) for part in limit.parts):
            what = f"{FORGOTTEN}; {AT_ANOTHER_LEVEL}"
        else:
            return limit.verdict(self.start)
        which, least = next(iter(limit.limits.items()))
        unit = "us" if limit.measure.unit == "time" else limit.measure.unit
        budget = limit.budget
        about = budget.name, budget.measure, unit, None, limit.show(least), None, 0
        return Verdict(*about, NOT_JUDGED, None, why=budget.why, which=which, found=what)

    def _result(self, end: int, told: Told, rounds: Rounds, verdicts: list[Verdict], wall: float) -> Result:
        stuck = []
        hung_at = int(rounds.hung_at[0])
        if 0 <= hung_at < end:
            what = f"SCL is held from {self.timebase.show(hung_at)} on, as the firmware waits for what cannot come"
            stuck.append(f'{self.structure.unit}: {what}; fidelity = "edge" tells where')
        failed = bool(stuck) or any(verdict.broken for verdict in verdicts)
        all_pass = bool(verdicts) and all(verdict.passed for verdict in verdicts)
        return Result(
            case=self.case.name,
            verdict=FAIL if failed else PASS if all_pass else NOT_JUDGED,
            fidelity="schedule",
            simulated_s=float(self.timebase.seconds(end)),
            wall_s=round(wall, 6),
            events=self.structure.edge_events,
            wire_bytes=told.i2c_bytes,
            sci_bytes=told.frames * FRAME_BYTES,
            budgets=verdicts,
            counts={
                "rounds": told.rounds,
                "missed": int(rounds.missed[0]),
                "nacked": int(rounds.nacked[0]),
                "frames": told.frames,
                "stuck": len(stuck),
            },
            unknowns=[],
            notes=[],
            stuck=stuck,
            terms_s=float(self.structure.edge_seconds),
        )


def _lacking(limit: BudgetJudge) -> str:
    """What a budget asks that the level does not tell; empty if it tells all."""
    return next((part.budget.measure for part in limit.parts if not isinstance(part.measure, ANSWERED)), "")
