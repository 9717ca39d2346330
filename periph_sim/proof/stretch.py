"""The case of a coverage or proof, and its runs with given phases or starts.

    phases 100, 101, 102 --[inputs]--> Scene --run--> Outcome: verdicts, and the names of what failed

Such a run is an ordinary run of the case, judged as `periph-sim run` judges it. Some limits of the budgets are left
out, because they are meant for the whole schedule of the case: limits of percentiles, limits of shares of time, and
limits of counts that are above 0. The glossary in `periph_sim.proof` has the terms.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from fractions import Fraction
from pathlib import Path

from msgspec import Struct

from ..core.kernel import SimulationStuck
from ..core.records import Kind, Listener, RecordCallback, Recorder
from ..core.time import Timebase
from ..f28335.memory.memory_map import NoSuchAddress
from ..f28335.pie.register_map import PIEIFR
from ..processor.user_code import FirmwareError
from ..scene.case.inputs_table import InputsTable
from ..scene.case.load import load
from ..scene.case.model import BadCase, Case
from ..scene.plan import ScenePlan
from ..scene.result import Result
from ..scene.scene import Scene
from ..timing.budget_plan import PER_MILLE, BudgetPlan
from ..timing.language.matcher import Matcher
from ..timing.measures.event import EventMeasure
from ..timing.verdict import FAIL, Verdict, percentile
from .measures_at_rest import events_of, round_events
from .phases import ROUNDS, Phases

# `Measure.looks_back` has one of these values if a value of the measure depends on records of one round only.
WITHIN_ROUND = frozenset(["this occurrence", "this transfer", "this round"])
DUE = frozenset({"due", "missed", "refused"})  # records at the due time of a round, without jitter
Subscribe = Callable[[Recorder, Timebase], None]
STUCK = "stuck"  # the name of a failure in which firmware waits for ever, or a line stays low
PERCENTILE = "a percentile describes all occurrences of a run"
ENDED = "ended by an error"  # the name of the failure of a run that was ended by one of RUN_ERRORS

RUN_ERRORS = (FirmwareError, SimulationStuck, NoSuchAddress)  # errors of a run whose message is a sentence for users


class Job(Struct, frozen=True):
    """The case of a coverage or proof, in a form that can be sent to another process.

    file: the path of the case as the user gave it, for messages. A relative path refers to the current folder.
    changes: the "key=value" texts that change the case, as in the option `--set`.
    start_up: True to move the first start through the start-up.
    rounds: the number of moved starts in a run with one phase alone.
    """

    file: str
    changes: tuple[str, ...] = ()
    start_up: bool = False
    rounds: int = ROUNDS


class Outcome(Struct, frozen=True):
    """The outcome of a run.

    verdicts: the verdicts of the covered budgets; empty if the run was ended by an error.
    failures: the names of the broken budgets, and STUCK or ENDED if the run failed in this way.
    reasons: a sentence about STUCK or ENDED, by this name.
    """

    verdicts: tuple[Verdict, ...]
    failures: frozenset[str]
    reasons: dict[str, str] = {}


class CoveredCase:
    """A case without the budgets that cannot be judged at single phases. It makes scenes and runs of this case.

    phases: the phases of the case.
    left_out: the reason for each budget, limit of a percentile or input that is not covered, by its name.
    not_whole: the reason for each budget that is left out wholly or in part, by its name.
    unknowns: the names of the options whose answers the runs have used.

    Raise BadCase if the case has no free start, or if no budget is left.
    """

    def __init__(self, job: Job) -> None:
        self._plan = whole = ScenePlan(load(Path(job.file), list(job.changes)))
        self.left_out: dict[str, str] = {}
        self.not_whole: dict[str, str] = {}
        for plan in whole.limits:
            name, reason = plan.budget.name, _why_left_out(plan)
            percentiles = PER_MILLE.keys() & plan.limits.keys()
            if reason:
                self.leave_out(name, reason)
            elif percentiles:
                self.left_out |= {f"{percentile(key)} of {name}": PERCENTILE for key in percentiles}
                self.not_whole[name] = PERCENTILE
        if not self.case.budget:
            raise self._nothing_to_judge()
        # the limits of percentiles are left out
        kept = [budget.model_copy(update=dict.fromkeys(PER_MILLE)) for budget in self.case.budget]
        self._plan = ScenePlan(self.case.model_copy(update={"budget": tuple(kept)}), whole)
        self.phases = Phases(self._plan, job.start_up, job.rounds)
        self.left_out |= _inputs_left_out(self.case, self.phases)
        self.unknowns: set[str] = set()

    @property
    def case(self) -> Case:
        """The case with the covered budgets only."""
        return self._plan.case

    def time(self, tick: int) -> tuple[float, str]:
        """Return the time from the start of the run to a tick: in seconds, and as text."""
        ticks = self._plan.ticks
        return float(ticks.timebase.seconds(tick - ticks.start)), ticks.timebase.show(tick - ticks.start)

    def with_ramp(self) -> CoveredCase:
        """Return this case with other data: those of a ramp, which change from frame to frame."""
        return self.with_host("motion", {})

    def with_host(self, key: str, value: object) -> CoveredCase:
        """Return this case with another value of a key of [host]."""
        assert self.case.host is not None
        other = copy(self)
        host = self.case.host.model_copy(update={key: value})
        other._plan = ScenePlan(self.case.model_copy(update={"host": host}), self._plan)
        return other

    def leave_out(self, name: str, reason: str) -> None:
        """Leave out budget `name`, with this reason. Raise BadCase if no budget is left."""
        kept = tuple(budget for budget in self.case.budget if budget.name != name)
        self.left_out[name] = self.not_whole[name] = reason
        if not kept:
            raise self._nothing_to_judge()
        self._plan = ScenePlan(self.case.model_copy(update={"budget": kept}), self._plan)

    def _nothing_to_judge(self) -> BadCase:
        reasons = "; ".join(f"{name}: {reason}" for name, reason in self.left_out.items())
        what = "there is no budget that a single round or phase can break; add one, such as a limit of `reaction`"
        return self.case.mistake(what + (f" ({reasons})" if reasons else ""), "budget")

    def scene_of(
        self,
        inputs: InputsTable,
        duration: Fraction,
        seed: int,
        subscribe: Subscribe | None = None,
        keep_values: bool = False,
    ) -> Scene:
        """Return a scene, not yet run, with these starts and this duration in seconds.

        subscribe: called with the recorder of the scene, to subscribe to records; None for no call.
        keep_values: True to keep all values of the budgets.
        """
        costs = {} if self.case.inputs is None else self.case.inputs.costs
        inputs = inputs.model_copy(update={"costs": costs})
        case = self.case.model_copy(update={"inputs": inputs, "duration": duration, "seed": seed})
        return Scene(ScenePlan(case, self._plan), subscribe, keep_values=keep_values)

    def free_scene(self, listener: Listener, keep_values: bool, on_request: RecordCallback | None = None) -> Scene:
        """Return a scene, not yet run, in which no round and no frame starts until the caller starts it.

        listener: receives the records of accesses, interrupts, and events and frames on lines.
        keep_values: True to keep all values of the budgets.
        on_request: receives the records of the PIE's request flags; None for no receiver.
        """
        frames, rounds = (None if table is None else () for table in (self.case.host, self.case.controller))
        flags = [f"{unit}.PIE.{register.name}" for unit in self.case.unit for register in PIEIFR]

        def subscribe(recorder: Recorder, _: Timebase) -> None:
            recorder.subscribe([Kind.ACCESS, Kind.IRQ, Kind.BUS, Kind.FRAME], listener)
            if on_request is not None:
                recorder.subscribe([Kind.FLAG], on_request, {Kind.FLAG: flags})

        inputs = InputsTable(frames=frames, rounds=rounds)
        return self.scene_of(inputs, self.case.duration, self.case.seed, subscribe, keep_values)

    def looks_further(self) -> dict[str, list[str]]:
        """Return what the values of each covered budget depend on beside the records of one round.

        The result has a sorted list of texts for the name of each budget, such as ["the start of the next round"]; an
        empty one if the values follow from one round. Without a host, bytes are compared with those that the request
        states, so `wrong bytes` depends on the transfer only.
        """
        found: dict[str, list[str]] = {}
        for plan in self._plan.limits:
            parts = (plan, *plan.joined)
            ranges = {
                "this transfer"
                if self.case.host is None and part.budget.measure == "wrong bytes"
                else part.make().looks_back
                for part in parts
            }
            events = set[str]().union(*(round_events(part.make()) for part in parts))
            if "next" in events:
                ranges.add("the start of the next round")
            if events & DUE and self.phases.jitter:
                ranges.add("the jitter of the round")
            found[plan.budget.name] = sorted(ranges - WITHIN_ROUND)
        return found

    def events(self) -> dict[str, list[Matcher] | None]:
        """Return the events of each covered budget, by its name; None if its values do not follow from events alone."""
        found: dict[str, list[Matcher] | None] = {}
        for plan in self._plan.limits:
            measures = [part.make() for part in (plan, *plan.joined)]
            of_events = [measure for measure in measures if isinstance(measure, EventMeasure)]
            each = [one for measure in of_events for one in events_of(measure)]
            found[plan.budget.name] = each if len(of_events) == len(measures) else None
        return found

    def not_before(self) -> dict[str, int]:
        """Return, by budget, the tick of the run from which its values count, such as {"latency": 15000}."""
        start = self._plan.ticks.start
        return {plan.budget.name: max(0, plan.not_before - start) for plan in self._plan.limits}

    def run(
        self, phases: Sequence[int], seed: int, subscribe: Subscribe | None = None, before: int | None = None
    ) -> Outcome:
        """Run the case with these phases and return the outcome.

        seed: the seed of all random values.
        subscribe: called with the recorder of the scene, to subscribe to records; None for no call.
        before: the run ends before this tick; None for the usual end.
        """
        inputs, duration = self.phases.inputs(phases)
        if before is not None:
            duration = Fraction(before - 1 - self._plan.ticks.start, self.phases.ticks_per_second)
        scene = self.scene_of(inputs, duration, seed, subscribe)
        try:
            result = scene.run()
        except RUN_ERRORS as error:
            return Outcome((), frozenset({ENDED}), {ENDED: str(error)})
        return self._outcome(result)

    def finish(self, scene: Scene) -> Outcome:
        """End the run of a scene now and return the outcome."""
        return self._outcome(scene.finish(scene.kernel.now - scene.start))

    def _outcome(self, result: Result) -> Outcome:
        self.unknowns.update(result.unknowns)
        failures = {verdict.name for verdict in result.budgets if verdict.broken}
        reasons = {STUCK: result.stuck[0]} if result.stuck and result.verdict == FAIL else {}
        return Outcome(tuple(result.budgets), frozenset(failures | reasons.keys()), reasons)


def _inputs_left_out(case: Case, phases: Phases) -> dict[str, str]:
    """Return the inputs that phases do not cover, with the reason, such as {"controller.jitter": "it is drawn"}."""
    found: dict[str, str] = {}
    if phases.jitter:
        found["host.jitter" if phases.moved == "frames" else "controller.jitter"] = "each start comes at its phase"
    if phases.moved == "frames" and case.host is not None and case.host.frames is not None:
        found["host.frames"] = "frames are sent in each period"
    if phases.is_relative and case.controller is not None and case.controller.jitter:
        found["controller.jitter"] = "it is drawn"
    return found


def _why_left_out(plan: BudgetPlan) -> str:
    """Return the reason why a budget cannot be judged at single phases; "" if it can."""
    measure = plan.make()
    limits = {key: limit for key, limit in plan.limits.items() if key not in PER_MILLE}
    if not limits:
        return PERCENTILE
    if measure.series:
        return ""
    if measure.unit in ("%", "time"):
        return "it is a share of a whole run"
    return "" if set(limits.values()) == {0} else "it counts the events of a whole run"
