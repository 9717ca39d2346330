"""A run of a case for a test. If a budget does not hold, its assertion shows a table, causes and timing diagrams.

Plan (case, programs, length) --run_plan--> Run: result, budgets, transfers, edges(), records
                                             assert_budgets(...) --> nothing, or AssertionError with a text

broken budgets --> budget, worst, limit, margin, when, why
worst occurrences --> windows, from a second run or the run's own records --> explanation and diagram as text
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from pathlib import Path

from ...bus.i2c.transfer import Transfer
from ...core.phrases import did_you_mean
from ...core.records import RECORDED, Recorder
from ...core.text_table import text_table
from ...core.time import Timebase
from ...processor.user_code import output_muted
from ...replay.wire_log import WireLog
from ...scene.case.model import Case
from ...scene.firmware_loader import Firmware
from ...scene.prepared import PreparedScene
from ...scene.result import Result
from ...scene.scene import Scene
from ...timing.verdict import Verdict, figure, instant, limit
from ...traces.capture.capture import Capture
from ...traces.formats.record_table import Columns, RecordTable
from ..reports.explain.chain import Chain, relative, text
from ..reports.explain.explain import chain_of, explain
from ..reports.explain.window import Window, windows_of_edges, windows_of_table
from ..reports.proofs import NO_PROOF, ProofReport, mark_proven

OnJudged = Callable[["Run", Sequence[Verdict]], None]


class NoSuchBudget(KeyError):
    """Error for a name that no budget of the case has. The message is one sentence."""

    def __str__(self) -> str:
        return str(self.args[0])


@dataclass(frozen=True)
class Plan:
    """A case with its changes, which has not been run yet.

    seconds: the duration of the run; None for the duration that the case states.
    programs: a dictionary from units to firmware that is given as functions.
    """

    case: Case
    seconds: Fraction | None = None
    programs: Mapping[str, Firmware] = field(default_factory=dict)

    def scene(self, subscribe: Callable[[Recorder, Timebase], None] | None = None) -> Scene:
        """Return a new scene that has not been run yet. Raise BadCase if the scene cannot be built.

        subscribe: a function that is called once, while the scene is built, so that it can subscribe to records.
        """
        return self._prepared.scene((), subscribe, self.programs)

    @cached_property
    def _prepared(self) -> PreparedScene:
        """The prepared case, which the run shares with a second run for the edges of the wires."""
        return PreparedScene(self.case)

    @property
    def length(self) -> Fraction:
        """The length of the run in seconds."""
        return self.case.duration if self.seconds is None else self.seconds


class Budgets(dict[str, Verdict]):
    """A dictionary from the names of budgets to verdicts. An unknown name raises NoSuchBudget with similar names."""

    def __init__(self, case: str, verdicts: Sequence[Verdict]) -> None:
        super().__init__((verdict.name, verdict) for verdict in verdicts)
        self._case = case

    def __missing__(self, name: str) -> Verdict:
        __tracebackhide__ = True
        raise NoSuchBudget(f"case {self._case} has no budget {name!r}; {did_you_mean(name, self)}")


@dataclass(repr=False)
class Run:
    """A finished run.

    result: the figures that `periph-sim run` shows.
    budgets: a dictionary from the names of budgets to verdicts.
    records: the table of all records if the run was made with `record=True`, else None.
    proof: what the saved proof of the case says.
    """

    plan: Plan
    result: Result
    budgets: Budgets
    timebase: Timebase
    start: int  # the tick at which the run began
    records: RecordTable | None
    hangs: tuple[str, ...]  # sentences about wires that are held, and firmware that waits, until the end of the run
    _transfers: list[Transfer]
    _edges: Capture | None
    _typical: list[Verdict]
    _on_judged: OnJudged
    proof: ProofReport = NO_PROOF

    def __repr__(self) -> str:
        return f"<run of {self.result.case}, {self.result.simulated_s:g} s: {self.result.verdict}>"

    @property
    def transfers(self) -> list[Transfer]:
        """The transfers of the case's controller, in order. Raise LookupError if the case has no controller."""
        __tracebackhide__ = True
        if self.plan.case.controller is None:
            raise LookupError(
                f"case {self.result.case} has no controller; "
                "periph_sim.traces.decode.i2c.transfers(run.edges()) returns the transfers on its wires"
            )
        return self._transfers

    def edges(self) -> Capture:
        """Return the edges of all wires. The positions of edges are ticks.

        Edges are kept during the run if `record` is True or if the firmware is a function. Otherwise, the first call of
        this method runs the case a second time.
        """
        if self._edges is None:
            with output_muted():
                scene = self.plan.scene()
                log = WireLog(*scene.wires.values())
                end = self.start + self.timebase.ticks(self.plan.length, "nearest")
                scene.advance(end)
            self._edges = replace(log.capture(scene.timebase, end), path=Path(self.result.case))
        return self._edges

    def explained(self, verdicts: Sequence[Verdict]) -> list[tuple[Window, Chain | None]]:
        """Return, for each verdict that has an instant, a window and the explanation of the worst occurrence.

        A window contains the records around an occurrence. To get them, the case is run once more. Firmware that is
        given as a function is not run again: its window is made from the records of the run. If they were not kept, it
        is made from the edges of the wires, and the explanation is None.
        """
        case = self.plan.case
        if not self.plan.programs:
            return [(one.window, one.chain) for one in explain(case, verdicts, self._typical, self.plan.length)]
        if self.records is not None:
            seen = windows_of_table(case.name, self.records, self.timebase, verdicts, self.start)
            return [(window, chain_of(case, window)) for window in seen]
        return [(window, None) for window in windows_of_edges(self.edges(), self.timebase, verdicts, self.start)]

    def assert_budgets(self, *names: str, guaranteed: bool = False) -> None:
        """Raise AssertionError, with a table and a diagram, if any of these budgets does not hold.

        guaranteed: True to require a saved proof of the budgets, too, which `periph-sim prove --table --save` writes. A
            proof holds only for a case file without changes. If only a proof is missing, there is no table.

        Raise NoSuchBudget if the case has no budget with one of the names, and ValueError if no name is given.
        """
        __tracebackhide__ = True
        if not names:
            raise ValueError("assert_budgets: give at least one budget; assert_all() judges all budgets of the case")
        for name in names:
            _ = self.budgets[name]  # raises NoSuchBudget if the case has no such budget
        self._judge([verdict for verdict in self.result.budgets if verdict.name in names], guaranteed)

    def assert_all(self, *, guaranteed: bool = False) -> None:
        """Call `assert_budgets` for all budgets and `assert_not_stuck`. Raise ValueError if the case has no budgets."""
        __tracebackhide__ = True
        if not self.budgets:
            raise ValueError(f"case {self.result.case} has no budgets, so nothing would be judged; add some")
        self._judge(self.result.budgets, guaranteed)
        self.assert_not_stuck()

    def assert_not_stuck(self) -> None:
        """Raise AssertionError if a wire is held forever, or firmware waits for an event that cannot occur."""
        __tracebackhide__ = True
        if self.hangs:
            raise AssertionError("\n".join([f"{self.result.case} hangs:", *self.hangs]))

    def _judge(self, verdicts: Sequence[Verdict], guaranteed: bool = False) -> None:
        __tracebackhide__ = True
        self._on_judged(self, verdicts)
        broken = [verdict for verdict in verdicts if not verdict.passed]
        if broken:
            raise AssertionError(failure_text(self, broken, len(verdicts)))
        missing = self.proof.missing(verdicts) if guaranteed else []
        if missing:
            raise AssertionError("\n".join(f"{self.result.case}: {text}" for _, text in missing))


def run_plan(plan: Plan, on_judged: OnJudged, *, keep_edges: bool = False, record: bool = False) -> Run:
    """Build and run a case. Raise BadCase if it cannot be built, and the errors of the run.

    on_judged: a function that is called with the run and the verdicts each time that a test asserts budgets.
    keep_edges: True to keep the edges of all wires.
    record: True to keep all records and the edges of all wires.
    """
    columns = Columns()
    scene = plan.scene((lambda recorder, _: recorder.subscribe(RECORDED, columns)) if record else None)
    log = WireLog(*scene.wires.values()) if keep_edges or record else None
    transfers: list[Transfer] = []
    scene.on_transfer(transfers.append)
    result = scene.run(plan.length)
    proof = ProofReport("", otherwise="its firmware is a function, and a proof is of a case file")
    if plan.case.file is not None and not plan.programs:
        proof = mark_proven(relative(plan.case.file), plan.case.changes, result.budgets)
    now, per_second = scene.kernel.now, Fraction(scene.timebase.per_second)
    return Run(
        plan=plan,
        result=result,
        budgets=Budgets(result.case, result.budgets),
        timebase=scene.timebase,
        start=scene.start,
        records=columns.table(per_second, now, plan.case.recorded_modules, scene.clocks()) if record else None,
        hangs=(*scene.deadlocks(), *(scene.stuck.sentences[-1:] if scene.stuck.hangs() else ())),
        _transfers=transfers,
        _edges=None if log is None else replace(log.capture(scene.timebase, now), path=Path(result.case)),
        _typical=scene.typical(),
        _on_judged=on_judged,
        proof=proof,
    )


WIDTH = 72  # number of columns of a text; pytest adds 8 columns before each line
MOST_EXPLAINED = 3  # maximum number of worst occurrences that are explained


def failure_text(run: Run, broken: Sequence[Verdict], judged: int) -> str:
    """Return the text of a failed assertion.

    The first line names the budgets that do not hold. For a single budget, it also says what was found.

    judged: the number of budgets that were asserted.
    """
    words = " or ".join(sorted({verdict.word for verdict in broken}))
    head = f"{len(broken)} of {judged} budgets {words}: {', '.join(verdict.name for verdict in broken)}"
    if len(broken) == 1:
        one = broken[0]
        found = "was never measured" if one.worst is None else figure(one.worst, one.unit)
        head = f"{one.name} {found}, limit {_limit(one)}"
        if one.until_s is not None:
            head = f"{one.name}: {one.found}"
        head += "" if one.broken or one.worst is None else f"; not judged, as {one.found}"
    lines = [f"{run.result.case}: {head}", "", *_table(broken)]
    if run.result.first_wrong and any(verdict.measure == "wrong bytes" for verdict in broken):
        lines += ["", f"first wrong: {run.result.first_wrong}"]
    lines += [*(f"stuck: {line}" for line in run.result.stuck), *run.result.reception()]
    happened = [verdict for verdict in broken if verdict.at_s is not None]
    for window, chain in run.explained(happened[:MOST_EXPLAINED]):
        lines += ["", *_picture(window, chain)]
    if len(happened) > MOST_EXPLAINED:
        left = ", ".join(verdict.name for verdict in happened[MOST_EXPLAINED:])
        lines += ["", f"(no picture of {left}; assert one alone to get it)"]
    return "\n".join(lines)


def _picture(window: Window, chain: Chain | None) -> list[str]:
    from ..reports.explain.picture import text_picture  # imported here, because only a failure needs this module

    verdict = window.verdict
    title = f"{verdict.name}, {figure(verdict.worst, verdict.unit)} at {instant(verdict.at_s)}:"
    shown = [title] if chain is None else text(chain)
    drawn = text_picture(window, WIDTH)
    if not drawn:
        return [*shown[:-1], f"{shown[-1]} no wire moves around it"] if chain is None else shown
    return [*shown, *drawn] if chain is None else [*shown, "", *drawn]


def _table(verdicts: Sequence[Verdict]) -> list[str]:
    rows: list[tuple[str, ...]] = []
    for verdict in verdicts:
        worst, margin = (figure(value, verdict.unit) for value in (verdict.worst, verdict.margin))
        why = verdict.why if verdict.worst is not None else "nothing was measured, which is not a pass"
        why = verdict.found or why
        rows.append((verdict.name, worst, _limit(verdict), margin, instant(verdict.at_s), why))
    return text_table(("budget", "seen", "limit", "margin", "when", "why"), rows, range(1, 5), WIDTH)


def _limit(verdict: Verdict) -> str:
    return limit(verdict.limit, verdict.unit, verdict.which)
