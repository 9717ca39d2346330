"""A proof with closed tables: one for the case as it is, or one for each clock of a controller within a range.

case --clock_errors--> changed cases --TableMaker--> Part, Part, ... --> worst values, words, least distance of starts

Cases with rounds and frames have a PairMaker instead. The glossary in `periph_sim.proof` has the terms.
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
from .table_cases import check

DIGITS = 15  # decimal digits of a time in seconds, enough to round it to the intended tick
HELD = "held"  # the word for a budget that no run broke, and that the tables do not prove


class Part(NamedTuple):
    """One table of a proof.

    covered: its case. changes: the "key=value" texts by which it differs from the case of the proof.
    """

    covered: CoveredCase
    table: StartTable
    changes: tuple[str, ...]


class WorstRun(Struct, frozen=True):
    """The worst value of a budget, and the run that had it. Ticks are counted from the start of the run.

    worst: the worst value.
    changes: the "key=value" texts for the clock of the run; empty if the proof is for the clock of the case only.
    starts: the ticks of the starts before the value; in a case with rounds and frames, those of frames.
    until: the tick at which the run ends, which is before the next start.
    rounds: in a case with rounds and frames, the ticks of the starts of rounds; else None.
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
    """The worst value of a budget in all tables, the part that has it, and the number of the run in its table."""

    part: Part
    number: int
    verdict: Verdict

    def run(self) -> WorstRun:
        """Return the run up to the start after the worst value, or the whole run if the value has no instant."""
        table, per_second = self.part.table, self.part.covered.phases.ticks_per_second
        starts, rounds = table.starts[self.number], table.rounds[self.number] if table.rounds else None
        both = sorted([*starts, *(rounds or ())])
        at = both[-1] if self.verdict.at_s is None else round(self.verdict.at_s * per_second)
        after = [start for start in both[1:] if start > at]  # the first start is kept, even if the value is before it
        after = after if rounds is None else after[1:]  # the next start can be in the same group, so it is kept
        until = after[0] if after else both[-1] + table.apart
        before = None if rounds is None else tuple(start for start in rounds if start < until)
        begun = tuple(start for start in starts if start < until)
        return WorstRun(self.verdict, self.part.changes, begun, until - 1, before)


class TableProof(NamedTuple):
    """The closed tables of a case. If a table has failed, it is the last one, and nothing is proven.

    covered: the case.
    within: the tables hold for all clocks of the controller that differ from that of the case by at most this, in ppm;
        None for the clock of the case only.
    parts: the tables, one for each clock.
    rates: the tables hold for all bit rates of the host that differ from that of the case by at most this, in ppm; None
        for the rate of the case only.
    any_tick: True if rounds can start at any tick; False if they start with a cycle. It only matters for a case with
        rounds and frames.
    data_use: why the tables hold for the data of the case only; "" if they hold for any data; None if there is no
        host, or a table has failed.
    """

    covered: CoveredCase
    within: Fraction | None
    parts: list[Part]
    rates: Fraction | None = None
    any_tick: bool = False
    data_use: str | None = None

    @property
    def has_failed(self) -> bool:
        """True if a run of the last table broke a budget or failed in another way."""
        return self.parts[-1].table.has_failed

    @property
    def moved(self) -> str:
        """The kinds of the free starts: "rounds", "frames" or "rounds and frames"."""
        return BOTH if self.covered.phases.is_relative else self.covered.phases.moved

    @property
    def entries(self) -> int:
        """The number of entries that were run."""
        return sum(part.table.entries for part in self.parts)

    @property
    def entry_count(self) -> int:
        """The number of entries of all tables, including the groups within cells of groups, which are not run."""
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
        """The tick of the first start, counted from the start of the run; with `rests_first`, that of the first rest.

        With `rests_first`, the proof holds for a first start at any later tick.
        """
        if not self.rests_first:
            return self.covered.phases.first_start
        return max(part.table.first_rest for part in self.parts)

    @property
    def rests_first(self) -> bool:
        """True if the proof holds for any first start after `first`; False if it holds for `first` only."""
        return self.parts[0].table.rests_first

    def worst(self) -> dict[str, WorstInProof]:
        """Return the worst value of each budget in all tables, by its name."""
        found: dict[str, WorstInProof] = {}
        for part in self.parts:
            for number, outcome in enumerate(part.table.outcomes):
                for verdict in outcome.verdicts:
                    if verdict.name not in found or rank(verdict) < rank(found[verdict.name].verdict):
                        found[verdict.name] = WorstInProof(part, number, verdict)
        return found

    def not_proven(self) -> dict[str, str]:
        """Return the reason for each budget that the tables do not prove, such as {"slack": "its values ..."}."""
        found: dict[str, str] = {}
        for part in self.parts:
            found = part.table.not_proven(part.covered, self.apart, self.within or Fraction(0)) | found
        return found

    def following_data(self) -> list[str]:
        """Return the proven budgets that hold for the data of the case only, because their events are made of data."""
        if self.data_use is None:
            return []
        return follow_data(self.covered, [name for name, word in self.words().items() if word == PROVEN])

    def words(self) -> dict[str, str]:
        """Return the word for each covered budget, by its name: BROKEN, NOT_JUDGED, PROVEN or HELD."""
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

    within, rates: the ranges of clocks of the controller and of bit rates of the host, in ppm; None for no range.
    any_tick: True to prove rounds that start at any tick.
    on_progress: called with the fraction of the entries found so far that were run, 0 to 1.
    on_estimate: called with the number of tables, the number of entries in each, and the estimated CPU time in seconds.
    call_all: makes calls, possibly in other processes: of tables after the first one, or of groups.

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
    """Yield the case and the table of each job, for a case with only rounds or only frames.

    made: the proof, without tables. jobs: the case, for each clock. advance, estimate, call_all: see `prove`.
    """
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
    """Do the same as `_tables` for a case with rounds and frames."""
    covered = within_round(made.covered)
    ignored, reason = check(covered.case, with_pairs=True), covered.phases.not_exact(made.any_tick)
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
    """Make the table of a case. Worker processes call this.

    rests_first: True to make the first start free, too. least_again: the least number of entries that are run again.
    """
    return TableMaker(CoveredCase(job), rests_first=rests_first, least_again=least_again).make()


def _with_clock(covered: CoveredCase, job: Job, error: Fraction) -> Job:
    """Return the job with another error of the controller's clock, in ppm.

    In a case with rounds and frames, the first round still starts at the same time.
    """
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
