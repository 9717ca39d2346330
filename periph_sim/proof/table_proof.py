"""A proof with closed tables: one for the case as it is, or one for each clock of a controller within a range.

case --clock_errors--> changed cases --TableMaker--> Part, Part, ... --> worst values, words, least distance of starts
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

from ..timing.verdict import BROKEN, NOT_JUDGED, PROVEN, Verdict
from .calls import CallAll, call_here
from .clock_errors import clock_errors
from .closed_table import BOTH, LEAST_REVISITED, StartTable, TableMaker, WorstInRuns, WorstRun
from .cover import is_worse
from .free_run import NotClosed
from .host_rates import plan_rates, prove_rates
from .other_data import data_use, follow_data
from .pair_budgets import within_round
from .pair_table import PairMaker
from .stretch import CoveredCase, Job
from .table_cases import check_pair

DIGITS = 15  # decimal digits of a time in seconds, so that it is rounded to the intended tick
HELD = "held"  # the word for a budget that no run broke, and that the tables do not prove


class Part(NamedTuple):
    """One table of a proof.

    changes: the changes of keys, as "key=value", that its case has in addition to those of the proof.
    """

    covered: CoveredCase
    table: StartTable
    changes: tuple[str, ...]


class WorstInProof(NamedTuple):
    """The worst value of a budget in all tables, and the table that has it."""

    part: Part
    found: WorstInRuns

    @property
    def verdict(self) -> Verdict:
        return self.found.verdict

    def run(self) -> WorstRun:
        """Return the starts and the end of the run."""
        return self.part.table.run_of(self.found, self.part.covered.phases.ticks_per_second)


class TableProof(NamedTuple):
    """The tables of a case. Only the last one can have failed.

    covered: the case.
    within: the greatest difference from `controller.ppm` that the tables cover, in ppm; None for the clock of the case
        only.
    parts: the tables.
    rates: the greatest difference from the bit rate of the host that the table covers, in ppm; None for the rate of the
        case only.
    any_tick: True if the proof holds for rounds that start at any tick, False if it holds for rounds that start with a
        cycle of the CPU. It only has a meaning if both rounds and frames are free.
    data_use: as `other_data.data_use`; None for a case without a host, or with a table that has failed.
    """

    covered: CoveredCase
    within: Fraction | None
    parts: list[Part]
    rates: Fraction | None = None
    any_tick: bool = False
    data_use: str | None = None

    @property
    def has_failed(self) -> bool:
        return self.parts[-1].table.has_failed

    @property
    def moved(self) -> str:
        """The word for the free starts: "rounds", "frames" or BOTH."""
        return BOTH if self.covered.phases.is_relative else self.covered.phases.moved

    @property
    def entries(self) -> int:
        """The number of entries that were run."""
        return sum(part.table.entries for part in self.parts)

    @property
    def entry_count(self) -> int:
        """The number of entries of all tables, but at least the number of entries that were run."""
        return max(self.entries, sum(sum(part.table.orbits) for part in self.parts))

    @property
    def again(self) -> int:
        """The number of entries that were run again."""
        return sum(part.table.again for part in self.parts)

    @property
    def apart(self) -> int:
        """The least distance of two starts for which the proof holds, in ticks."""
        return max(part.table.apart for part in self.parts)

    @property
    def first(self) -> int:
        """The tick of the case's first start or, if `rests_first` is True, of the first rest. 0 is the run's start.

        If `rests_first` is True, the proof holds for a first start at any tick after the first rest.
        """
        if not self.rests_first:
            return self.covered.phases.first_start()
        return max(part.table.first_rest for part in self.parts)

    @property
    def rests_first(self) -> bool:
        """True if the proof holds for any first start after `first`; False if it holds for `first` only."""
        return self.parts[0].table.rests_first

    def worst(self) -> dict[str, WorstInProof]:
        """Return a dictionary from each budget to its worst value in all tables."""
        found: dict[str, WorstInProof] = {}
        for part in self.parts:
            for name, worst in part.table.worst().items():
                if name not in found or is_worse(worst.verdict, found[name].verdict):
                    found[name] = WorstInProof(part, worst)
        return found

    def not_proven(self) -> dict[str, str]:
        """Return the budgets that the tables do not prove, as a dictionary from the name of each to the reason."""
        found: dict[str, str] = {}
        for part in self.parts:
            found = part.table.not_proven(part.covered, self.apart, self.within or Fraction(0)) | found
        return found

    def following_data(self) -> list[str]:
        """Return the proven budgets whose values can differ if the data differ, although all times are equal."""
        if self.data_use is None:
            return []
        return follow_data(self.covered, [name for name, word in self.words().items() if word == PROVEN])

    def words(self) -> dict[str, str]:
        """Return a dictionary from each covered budget to BROKEN, NOT_JUDGED, PROVEN or HELD."""
        worst, not_proven, words = self.worst(), self.not_proven(), {}
        for budget in self.covered.case.budget:
            found = worst.get(budget.name)
            if found is None or not (found.verdict.passed or found.verdict.broken):
                words[budget.name] = NOT_JUDGED
            elif found.verdict.broken:
                words[budget.name] = BROKEN
            else:
                words[budget.name] = HELD if self.has_failed or budget.name in not_proven else PROVEN
        return words


def prove(
    job: Job,
    within: Fraction | None = None,
    on_progress: Callable[[float], None] | None = None,
    on_estimate: Callable[[int, int, float], None] | None = None,
    call_all: CallAll = call_here,
    rates: Fraction | None = None,
    any_tick: bool = False,
) -> TableProof:
    """Make the tables of a case, up to the first one that fails.

    within, rates, any_tick: as in `TableProof`.
    on_progress: called with the fraction of the known entries that were run, 0 to 1.
    on_estimate: called with the number of tables, the number of entries in each, and the estimated CPU time in seconds.
    call_all: makes the calls that make tables. The first of several tables is always made in this process.

    Raise NotClosed if a table cannot be closed, and BadCase for a case without free starts.
    """
    covered = CoveredCase(job)
    for option, given in (("--host-ppm", rates is not None), ("--any-tick", any_tick)):
        if given and not covered.phases.is_relative:
            raise covered.case.mistake(f"{option} needs both a [host] and a [controller]; remove the option", "name")
    errors = [None] if within is None else clock_errors(covered.case, within)
    jobs = [job if error is None else _with_clock(covered, job, error) for error in errors]
    first = covered if within is None else CoveredCase(jobs[0])
    if covered.phases.is_relative:
        made = TableProof(within_round(covered), within, [], rates, any_tick)
        return _of_pairs(made, job, jobs, on_progress, on_estimate, call_all)
    least_again = -(-LEAST_REVISITED // len(jobs))
    rests_first = None if within is None else True
    parts: list[Part] = []

    def advance(done: float) -> None:
        if on_progress is not None:
            on_progress((len(parts) + done) / len(jobs))

    def estimate(entries: int, seconds: float) -> None:
        if on_estimate is not None:
            on_estimate(len(jobs), entries, seconds * len(jobs))

    def tables() -> Iterator[StartTable]:
        yield TableMaker(first, advance, estimate, None, rests_first, least_again).make()
        arguments = [(one, True, least_again) for one in jobs[1:]]
        yield from call_all(make_table, arguments)

    for one, table in zip(jobs, tables(), strict=True):
        parts.append(Part(CoveredCase(one) if parts else first, table, one.changes[len(job.changes) :]))
        advance(0)
        if table.has_failed:
            break
    return TableProof(covered, within, parts, data_use=_data_use(covered, parts[-1].table))


def _of_pairs(
    made: TableProof,
    job: Job,
    jobs: Sequence[Job],
    on_progress: Callable[[float], None] | None,
    on_estimate: Callable[[int, int, float], None] | None,
    call_all: CallAll,
) -> TableProof:
    """Make the tables of a case whose rounds and frames are free. See `prove`.

    made: the proof without tables. jobs: for each table, the case of `job` with further changes.
    """

    def advance(done: float) -> None:
        if on_progress is not None:
            on_progress((len(made.parts) + done) / len(jobs))

    def estimate(groups: int, seconds: float) -> None:
        if on_estimate is not None and not made.parts:
            on_estimate(len(jobs), groups, seconds * len(jobs))

    ignored = check_pair(made.covered.case)
    reason = made.covered.phases.not_exact(made.any_tick)
    if reason:
        raise NotClosed(reason)
    uses = []
    for one in jobs:
        covered = CoveredCase(one)
        maker = PairMaker(covered, one, ignored, advance, estimate, call_all, LEAST_REVISITED, made.any_tick)
        maker.explore()
        plan = None if made.rates is None else plan_rates(maker, ignored, made.rates)
        maker.estimate([len(starts) for _, starts in plan or ()])
        table = maker.make()
        if plan is not None and not table.has_failed:
            prove_rates(plan, maker, one, ignored, LEAST_REVISITED, call_all)
        made.parts.append(Part(covered, table, one.changes[len(job.changes) :]))
        uses.append(_data_use(maker.covered, table))
        if table.has_failed:
            break
    return made._replace(data_use=None if made.has_failed else next(filter(None, uses), ""))


def _data_use(covered: CoveredCase, table: StartTable) -> str | None:
    return None if covered.case.host is None or table.has_failed else data_use(covered, table)


def make_table(job: Job, rests_first: bool, least_again: int) -> StartTable:
    """Return the table of a case. rests_first, least_again: as for `TableMaker`. Another process can call this."""
    return TableMaker(CoveredCase(job), rests_first=rests_first, least_again=least_again).make()


def _with_clock(covered: CoveredCase, job: Job, error: Fraction) -> Job:
    """Return the case with another error of the controller's clock. If it has a host, the first round does not move."""
    changes = [f"controller.ppm={_decimal(error)}"]
    if covered.phases.is_relative:
        ticks = covered.phases.first_starts()["rounds"]
        first = ticks * (1 + error / 10**6) / covered.phases.ticks_per_second
        changes.append(f"controller.first={_decimal(Fraction(round(first * 10**DIGITS), 10**DIGITS))} s")
    return Job(job.file, (*job.changes, *changes), job.start_up, job.rounds)


def _decimal(value: Fraction) -> str:
    """Return a number whose denominator is a power of two, or a decimal number, as a decimal text without rounding."""
    digits = 0
    while (value * 10**digits).denominator != 1:
        digits += 1
    whole = value * 10**digits
    text = f"{abs(whole.numerator):0{digits + 1}d}"
    sign = "-" if value < 0 else ""
    return f"{sign}{text[: len(text) - digits]}.{text[len(text) - digits :] or '0'}"
