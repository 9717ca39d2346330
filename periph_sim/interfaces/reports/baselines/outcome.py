"""Run of a case in a worker process, with an Outcome that can be sent between processes.

This module prints nothing and parses no command line, because it is imported in worker processes.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ....scene.case.load import load
from ....scene.case.model import Case
from ....scene.outside_parties import not_run
from ....scene.result import Result
from ....scene.scene import Scene
from ....timing.budgets import BudgetJudge, Values
from ....timing.verdict import Verdict
from .. import REFUSED
from ..explain.chain import Chain
from ..explain.explain import explain
from .event_chain import EventDigests, EventLine, Wanted, chains
from .files import BadCheck, Baseline, Figures


@dataclass
class Outcome:
    """The result of running a case file.

    breaks: the names of the budgets that must break according to the case.
    lines: a dictionary from each budget to its line in the file, or to 0 if the line is unknown. A condition that is
        joined to a budget by `and` has the line of the budget.
    breaks_line, name_line: the lines of the keys `breaks` and `name` in the file; 0 if unknown.
    changes: the "key=value" texts applied to the case.
    typical: the least critical occurrence of each budget that has several, as verdicts.
    trouble: sentences about wires that stay low and firmware that waits forever.
    values: the values of each budget; None for a budget whose values were not kept.
    """

    path: Path
    figures: Baseline
    breaks: tuple[str, ...]
    trouble: list[str]
    lines: dict[str, int]
    breaks_line: int
    name_line: int
    changes: tuple[str, ...]
    result: Result
    values: list[Values | None]
    typical: list[Verdict]

    @property
    def verdicts(self) -> list[Verdict]:
        return self.result.budgets

    @property
    def broken(self) -> list[str]:
        return [verdict.name for verdict in self.verdicts if verdict.broken]

    @property
    def not_passed(self) -> list[str]:
        """The names of the budgets that are broken or not judged."""
        return [verdict.name for verdict in self.verdicts if not verdict.passed]


@dataclass
class RejectedCase:
    """A case that cannot be run or compared.

    why: the reason as one sentence.
    outside: True if the reason is that the case needs an outside party, which is no error.
    """

    path: Path
    why: str
    outside: bool = False


def run_case(path: Path, changes: tuple[str, ...] = (), keep_values: bool = False) -> Outcome | RejectedCase:
    """Run a case for the duration that it states, and return the outcome, or the reason why it cannot be run."""
    try:
        case = load(path, list(changes))
        if case.outside is not None and case.outside.log is None:
            return RejectedCase(path, str(not_run(case)), outside=True)
        return _outcome(path, case, changes, keep_values)
    except REFUSED as error:
        return RejectedCase(path, str(error))


def run_again(
    path: Path,
    changes: tuple[str, ...],
    wanted: dict[str, Wanted],
    verdicts: list[Verdict],
    typical: list[Verdict],
) -> tuple[dict[str, EventLine], dict[str, Chain]]:
    """Run a case again, to find the events of some occurrences and to explain the worst occurrences of some verdicts.

    Return two dictionaries: from budgets to the events around their wanted occurrences, and from budgets to
    explanations.

    Raise BadCheck if the case cannot be run again.
    """
    try:
        case = load(path, list(changes))
        found = chains(case, wanted)
        return found, {one.window.verdict.name: one.chain for one in explain(case, verdicts, typical)}
    except REFUSED as error:  # the first run was possible, so the case or its firmware has changed
        raise BadCheck(f"{path}: it ran, but not a second time: {error}") from None


def _outcome(path: Path, case: Case, changes: tuple[str, ...], keep_values: bool) -> Outcome:
    digests = EventDigests(case.start)
    scene = Scene(case, digests.subscribe, keep_values=keep_values)
    result = scene.run()
    trouble = scene.deadlocks()
    if scene.stuck.hangs() and not trouble:
        trouble = scene.stuck.sentences[-1:]
    figures = baseline_of(scene, result).model_copy(update={"digest": digests.events, "bus_bytes": digests.bus_bytes})
    return Outcome(
        path=path,
        figures=figures,
        breaks=case.breaks,
        trouble=trouble,
        lines={
            part.budget.name: case.line("budget", entry)
            for entry, limit in enumerate(scene.limits)
            for part in limit.parts
        },
        breaks_line=case.line("breaks"),
        name_line=case.line("name"),
        changes=changes,
        result=result,
        values=[limit.values(scene.start) for limit in scene.limits],
        typical=scene.typical(),
    )


def baseline_of(scene: Scene, result: Result) -> Baseline:
    """Return the figures of a scene after its run, without chains and digests."""
    case = scene.case
    clocks = [int(unit.oscclk * unit.pll / 2) for unit in case.unit.values()]
    return Baseline(
        case=case.name,
        simulated=scene.kernel.now - scene.start,
        ticks_per_second=scene.timebase.per_second,
        ticks_per_cycle=scene.timebase.per_second // clocks[0] if clocks else 1,
        events=result.events,
        counts={
            **result.counts,
            "I2C bytes": result.wire_bytes,
            "SCI bytes": result.sci_bytes,
            **({"SCI bytes from units": result.sci_bytes_sent} if result.sci_bytes_sent else {}),
        },
        budgets={part.budget.name: _figures(part, scene.start) for limit in scene.limits for part in limit.parts},
    )


def _figures(limit: BudgetJudge, start: int) -> Figures:
    measure = limit.measure
    silent = measure.silent

    def when(at: int) -> int | None:
        return None if silent or at < 0 else at - start

    return Figures(
        measure=limit.budget.measure,
        unit=measure.unit,
        count=measure.count,
        worst=None if silent else measure.worst,
        worst_at=when(measure.worst_at),
        least=None if silent else measure.least,
        least_at=when(measure.least_at),
        chain_of="least" if limit.budget.max is None else "worst",
        chain=[],
    )


def occurrence(figures: Figures) -> Wanted | None:
    """Return the occurrence that the chain of a budget describes; None if nothing was measured or it has no instant."""
    least = figures.chain_of == "least"
    value, at = (figures.least, figures.least_at) if least else (figures.worst, figures.worst_at)
    if value is None or at is None:
        return None
    return Wanted(figures.measure, at, value if figures.unit == "time" else 0)
