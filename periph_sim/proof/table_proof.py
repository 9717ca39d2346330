"""A proof with closed tables: one for the case as it is, or one for each clock of a controller within a range.

case --clock_errors--> changed cases --TableMaker--> Part, Part, ... --> worst values, words, least distance of starts
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from decimal import Context, Inexact
from fractions import Fraction
from itertools import pairwise
from typing import Annotated, NamedTuple

from msgspec import Meta, Struct

from ..timing.verdict import NOT_JUDGED, PROVEN, SEEN, Verdict
from .calls import CallAll, call_here
from .clock_errors import clock_errors
from .closed_table import BOTH, LEAST_REVISITED, StartTable, TableMaker
from .cover import rank
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


class WorstRun(Struct, frozen=True):
    """The worst value of a budget, and the run in which it was seen. All ticks are from the start of the run.

    worst: the worst value of all starts.
    changes: the "key=value" texts of the run: its clock, if the proof is for a range of clocks.
    starts: the ticks of the starts up to the value; only those of frames if both rounds and frames are free.
    until: the tick at which the run ends, before a later start.
    rounds: if both rounds and frames are free, the ticks of the starts of rounds; else None.
    """

    worst: Verdict
    changes: tuple[str, ...]
    starts: tuple[int, ...]
    until: Annotated[int, Meta(ge=0)]
    rounds: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        each = (self.starts, self.rounds or ())
        missing = not any(each) or any(starts and starts[0] < 0 for starts in each)
        if missing or any(one >= two for starts in each for one, two in pairwise(starts)):
            raise ValueError("the starts of a worst value are missing, negative or not ascending")


class WorstInProof(NamedTuple):
    """The worst value of a budget in all tables, the table that has it, and the number of the run in this table."""

    part: Part
    number: int
    verdict: Verdict

    def run(self) -> WorstRun:
        """Return the run up to the worst value. If the worst value has no instant, return the whole run."""
        table, per_second = self.part.table, self.part.covered.phases.ticks_per_second
        starts, rounds = table.starts[self.number], table.rounds[self.number] if table.rounds else None
        both = sorted([*starts, *(rounds or ())])
        at = both[-1] if self.verdict.at_s is None else round(self.verdict.at_s * per_second)
        after = [start for start in both[1:] if start > at]  # the run has a start, even if the value is before it
        after = after if rounds is None else after[1:]  # the next start can belong to the same group
        until = after[0] if after else both[-1] + table.apart
        before = None if rounds is None else tuple(start for start in rounds if start < until)
        begun = tuple(start for start in starts if start < until)
        return WorstRun(self.verdict, self.part.changes, begun, until - 1, before)


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
            return self.covered.phases.first_start
        return max(part.table.first_rest for part in self.parts)

    @property
    def rests_first(self) -> bool:
        """True if the proof holds for any first start after `first`; False if it holds for `first` only."""
        return self.parts[0].table.rests_first

    def worst(self) -> dict[str, WorstInProof]:
        """Return a dictionary from each budget to its worst value in all tables."""
        found: dict[str, WorstInProof] = {}
        for part in self.parts:
            for number, outcome in enumerate(part.table.outcomes):
                for verdict in outcome.verdicts:
                    if verdict.name not in found or rank(verdict) < rank(found[verdict.name].verdict):
                        found[verdict.name] = WorstInProof(part, number, verdict)
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
            word = NOT_JUDGED if found is None else found.verdict.word
            if word in (SEEN, PROVEN):
                word = HELD if self.has_failed or budget.name in not_proven else PROVEN
            words[budget.name] = word
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
    made = TableProof(covered, within, [], rates, any_tick)

    def advance(done: float) -> None:
        if on_progress is not None:
            on_progress((len(made.parts) + done) / len(jobs))

    def estimate(entries: int, seconds: float) -> None:
        if on_estimate is not None and not made.parts:
            on_estimate(len(jobs), entries, seconds * len(jobs))

    tables = _pair_tables if covered.phases.is_relative else _tables
    for one, (case, table) in zip(jobs, tables(made, jobs, advance, estimate, call_all), strict=True):
        made.parts.append(Part(case, table, one.changes[len(job.changes) :]))
        advance(0)
        if table.has_failed:
            return made
    if covered.case.host is None:
        return made
    uses = (data_use(part.covered, part.table) for part in made.parts)
    return made._replace(data_use=next(filter(None, uses), ""))


def _tables(
    made: TableProof,
    jobs: Sequence[Job],
    advance: Callable[[float], None],
    estimate: Callable[[int, float], None],
    call_all: CallAll,
) -> Iterator[tuple[CoveredCase, StartTable]]:
    """Yield the case and the table of each job. made: the proof, without tables. For the others, see `prove`."""
    least_again = -(-LEAST_REVISITED // len(jobs))
    first = made.covered if made.within is None else CoveredCase(jobs[0])
    rests_first = None if made.within is None else True
    yield first, TableMaker(first, advance, estimate, None, rests_first, least_again).make()
    cases = (CoveredCase(job) for job in jobs[1:])
    yield from zip(cases, call_all(make_table, [(job, True, least_again) for job in jobs[1:]]), strict=True)


def _pair_tables(
    made: TableProof,
    jobs: Sequence[Job],
    advance: Callable[[float], None],
    estimate: Callable[[int, float], None],
    call_all: CallAll,
) -> Iterator[tuple[CoveredCase, StartTable]]:
    """Do the same as `_tables` for a case whose rounds and frames are free."""
    covered = within_round(made.covered)
    ignored, reason = check_pair(covered.case), covered.phases.not_exact(made.any_tick)
    if reason:
        raise NotClosed(reason)
    for job in jobs:
        maker = PairMaker(CoveredCase(job), job, ignored, advance, estimate, call_all, LEAST_REVISITED, made.any_tick)
        maker.explore()
        plan = None if made.rates is None else plan_rates(maker, ignored, made.rates)
        maker.estimate([len(starts) for _, starts in plan or ()])
        table = maker.make()
        if plan is not None and not table.has_failed:
            prove_rates(plan, maker, job, ignored, LEAST_REVISITED, call_all)
        yield maker.covered, table


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
    """Return a number whose denominator divides a power of ten as a decimal text without rounding."""
    exact = Context(prec=value.numerator.bit_length() + value.denominator.bit_length() + 1, traps=[Inexact])
    return f"{exact.divide(value.numerator, value.denominator):f}"
