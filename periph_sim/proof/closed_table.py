"""Closed table of a case that has only rounds or only frames. The glossary in `periph_sim.proof` has the terms.

    rest at a place --start at tick r of its orbit--> one round --> rest at another place

The states of a rest repeat, so there are only as many different starts of the next round as the orbit has ticks,
however long the scene rests. Each of these entries is run once. A run makes many rounds one after the other, each from
an entry that is still open, until no entry is open.

The proof needs that a scene continues equally from equal normal states. Some entries are therefore run again, after
other rounds and after a rest of another length. `Contradiction` is raised if their effects differ.

In the texts of this file, "round" also means a frame, in a case that has only frames.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from fractions import Fraction
from math import ceil
from random import Random
from time import process_time

from msgspec import Struct

from .free_run import FreeRun, NotClosed
from .measures_at_rest import MeasuresAtRest
from .normal_state import NormalState, digest, period_of
from .orbit_ways import first_step
from .stretch import CoveredCase, Outcome
from .table_cases import check

BOTH = "rounds and frames"  # the value of `moved` for a case with both rounds and frames
MAX_ENTRIES = 400_000
ROUNDS_A_RUN = 256  # maximum number of rounds in one run; it is doubled if a run has run no new entry
MOST_ROUNDS_A_RUN = 2**16
REVISITED = 20  # one in REVISITED entries is run again, but normally at least LEAST_REVISITED entries
LEAST_REVISITED = 200
TIMED = 20  # the time for the first TIMED entries gives the estimate for all
LONGER_RESTS = 3  # a rest is longer than necessary by a random number of periods: 0, 1 or 2


class Contradiction(Exception):
    """Error: two runs of one entry differ, so the normal state lacks something that matters: a defect of periph-sim."""


class RestPlace(Struct, frozen=True):
    """A place: the number of an orbit, and one of its ticks."""

    orbit: int
    tick: int


class TableEntry(Struct, frozen=True):
    """The effects of the round of an entry.

    after: the place of the rest after the round.
    length: the number of ticks from the start of the round to this rest.
    records: the digest of everything that was recorded in the round (`RoundDigest`).
    """

    after: RestPlace
    length: int
    records: int


class StartTable(Struct):
    """Summary of a table, which is closed, or whose last run has failed.

    orbits: for each orbit, the number of its entries.
    entries: the number of entries that were run.
    again: the number of entries that were run again.
    apart: the least distance of two starts for which the table holds, in ticks.
    first_rest: the tick of the first rest, counted from the start of the run.
    rests_first: True if the first start is free, too; False if it is always that of the case.
    outcomes: the outcomes of the runs.
    starts: for each run, the ticks of its starts, counted from the start of the run; in a case with rounds and frames,
        only those of frames.
    spanning: the names of budgets with an occurrence that lasts from one round into the next.
    lacking: the names of budgets that some rounds do not judge.
    rounds: for each run of a case with rounds and frames, the ticks of the starts of its rounds; else empty.
    data_use: the first use of the data of a frame that decides what the firmware does, as text; "" for none.
    """

    orbits: list[int]
    entries: int
    again: int
    apart: int
    first_rest: int
    rests_first: bool
    outcomes: list[Outcome]
    starts: list[list[int]]
    spanning: set[str]
    lacking: set[str]
    rounds: list[list[int]] = []
    data_use: str = ""

    @property
    def has_failed(self) -> bool:
        """True if the last run broke a budget or failed in another way."""
        return bool(self.outcomes and self.outcomes[-1].failures)

    def not_proven(self, covered: CoveredCase, apart: int, within: Fraction = Fraction(0)) -> dict[str, str]:
        """Return the reason for each budget that the table does not prove, such as {"data age": "its values ..."}.

        The table proves a budget if each of its values follows from one round, if all rounds are judged, and if the
        starts of the case are far enough apart.

        apart: the distance that the starts of the case must have, in ticks: `self.apart`, or more if other tables of
            the same proof need more.
        within: the greatest difference of the controller's clock from that of the case, in ppm, which makes the
            distance of starts smaller.
        """
        found: dict[str, str] = {}
        if covered.phases.least_distance(within) < apart:
            least = milliseconds(apart, covered.phases.ticks_per_second)
            reason = f"the case has starts that are less than {least} apart"
            return {budget.name: reason for budget in covered.case.budget}
        not_before, first = covered.not_before(), min(starts[0] for starts in self.starts)
        for name, further in covered.looks_further().items():
            if name in self.spanning:
                found[name] = "an occurrence of it lasts from one round to the next"
            elif not_before[name] > first:
                found[name] = "its `after` leaves out rounds of the table"
            elif name in self.lacking:
                found[name] = "a round has too few measured values, and a run of such rounds is not judged"
            elif further:
                found[name] = f"its values depend on {further[0]}"
        return found


class TableMaker:
    """Makes the table of a case. The constructor raises NotClosed if the case cannot have a table.

    on_progress: called with the number of entries that were run, divided by that of all entries found so far.
    on_estimate: called after TIMED entries, with the expected number of entries, and the estimated CPU time in seconds.
    on_run: called at the end of each run, with the run and the entries of its rounds. The first start of the case has
        no entry. If `on_run` is given, scenes keep all values of their budgets.
    rests_first: True to make the first start free, too. None means True if the starts of the case have jitter, else
        False.
    least_again: the least number of entries that are run again.
    entries: the effects of the entries that were run.
    first: the effects of the first round of the case, with which each run begins; None if the first start is free.
    """

    def __init__(
        self,
        covered: CoveredCase,
        on_progress: Callable[[float], None] | None = None,
        on_estimate: Callable[[int, float], None] | None = None,
        on_run: Callable[[FreeRun, Sequence[RestPlace]], None] | None = None,
        rests_first: bool | None = None,
        least_again: int = LEAST_REVISITED,
    ) -> None:
        self._covered = covered
        self._on_progress = on_progress
        self._on_estimate = on_estimate
        self._on_run = on_run
        self._least_again = least_again
        self._timed_from = 0.0  # the CPU time of this process when the first entry began
        self._ignored = check(covered.case)
        self._random = Random(1)
        self._rounds = ROUNDS_A_RUN  # maximum number of rounds in the next run
        self._places: dict[bytes, RestPlace] = {}  # the place of each state of rest, by the digest of the state
        self._open: list[list[int]] = []  # for each orbit, the ticks of its open entries, ascending
        self.entries: dict[RestPlace, TableEntry] = {}
        self.first: TableEntry | None = None
        is_free = covered.phases.jitter > 0 if rests_first is None else rests_first
        self.table = StartTable([], 0, 0, 0, 0, is_free, [], [], set(), set())

    def make(self) -> StartTable:
        """Run entries until the table is closed or a run has failed, and return it.

        Raise NotClosed if the table cannot be closed, and Contradiction if two runs of one entry differ.
        """
        table = self.table
        while not table.orbits or any(self._open):
            before = len(self.entries)
            self._run(again=0)
            if table.has_failed:
                return table
            if len(self.entries) == before:
                self._rounds *= 2
            if self._rounds > MOST_ROUNDS_A_RUN:
                raise NotClosed(f"a state is only reached after more than {MOST_ROUNDS_A_RUN:,} rounds")
        wanted = revisits(len(self.entries), self._least_again)
        while table.again < wanted and not table.has_failed:
            self._run(again=wanted)
        return table

    def _run(self, again: int) -> None:
        """Make one run of up to `_rounds` rounds.

        again: 0 to run open entries. Otherwise, random entries are run again, up to `again` of them in all runs.
        """
        run = FreeRun(self._covered, self._ignored, self._on_run is not None, self.table.rests_first)
        table = self.table
        measures = MeasuresAtRest(run.scene.limits)
        measures.rest(run.now, () if self.table.rests_first else ("rounds",))
        table.first_rest = run.now - run.scene.start
        place = self._place(run)
        if not self.table.rests_first:
            (first,) = run.frames or run.rounds  # only one of them moves
            table.apart = max(table.apart, table.first_rest - first + 1)
            self.first = TableEntry(place, run.now - run.scene.start - first, run.records.digest)
        begun: list[RestPlace] = []
        for _ in range(self._rounds):
            if again and table.again >= again:
                break
            tick = self._random.randrange(table.orbits[place.orbit]) if again else self._next_tick(place)
            if tick is None:
                break
            begun.append(RestPlace(place.orbit, tick))
            place = self._round(run, measures, place, tick)
        table.starts.append(run.frames or run.rounds)
        table.outcomes.append(self._covered.finish(run.scene))
        table.data_use = table.data_use or run.data_use
        measures.finish(table.outcomes[-1].verdicts)
        if self._on_run is not None:
            self._on_run(run, begun)
        table.spanning |= measures.spanning
        # a budget without a value in one round has no verdict in a run that repeats this round
        table.lacking |= measures.lacking | {name for _, name in measures.empty}

    def _next_tick(self, place: RestPlace) -> int | None:
        """Return the tick at which the next round starts, in the orbit of `place`, where the scene rests.

        If the orbit has open entries, it is the tick of the next one; else that of the first entry on a shortest way to
        an orbit with open entries. Return None if no way to an open entry is known.
        """
        here = self._open[place.orbit]
        if here:
            return here[bisect_right(here, place.tick) % len(here)]
        ways: dict[int, dict[int, int]] = {}  # `ways[orbit][after]` is the tick of an entry that leads there
        for at, entry in self.entries.items():
            ways.setdefault(at.orbit, {}).setdefault(entry.after.orbit, at.tick)
        return first_step(ways, place.orbit, lambda orbit: bool(self._open[orbit]))

    def _round(self, run: FreeRun, measures: MeasuresAtRest, place: RestPlace, tick: int) -> RestPlace:
        """Rest from `place` until `tick` of its orbit, and run a round that starts then. Return the place after it."""
        period = self.table.orbits[place.orbit]
        distance = (tick - place.tick) % period or period
        start = run.now + distance + period * self._random.randrange(LONGER_RESTS)
        run.start(**{self._covered.phases.moved: start})
        run.settle()
        records, settled = run.records.digest, run.now
        measures.rest(settled)
        after = self._place(run)
        self.table.apart = max(self.table.apart, settled - start + 1)
        entry, at = TableEntry(after, run.now - start, records), RestPlace(place.orbit, tick)
        known = self.entries.get(at)
        if known is not None:
            self.table.again += 1
            self._compare(at, known, entry)
            return after
        self.entries[at] = entry
        here = self._open[place.orbit]
        del here[bisect_left(here, tick)]
        self.table.entries += 1
        if self.table.entries == TIMED and self._on_estimate is not None:
            entries = self.table.orbits[0]
            self._on_estimate(entries * (1 + self.table.rests_first), self._estimate(entries))
        if self._on_progress is not None:
            self._on_progress(self.table.entries / sum(self.table.orbits))
        return after

    def _estimate(self, entries: int) -> float:
        """Return the CPU time for the table, in seconds. entries: the number of entries of the first orbit."""
        now = process_time()
        entry = (now - self._timed_from) / TIMED
        if not self.table.rests_first:
            return entry * (entries + revisits(entries, self._least_again))
        # The first orbit is that before any round. No round leads back to it, so each entry needs a new run.
        # All rounds are assumed to lead to one other orbit, of the same length.
        FreeRun(self._covered, self._ignored, self._on_run is not None, self.table.rests_first)
        return entry * (2 * entries + revisits(2 * entries, self._least_again)) + (process_time() - now) * entries

    def _compare(self, at: RestPlace, known: TableEntry, entry: TableEntry) -> None:
        """Raise Contradiction if the effects of an entry, `entry`, differ from those of its first run, `known`.

        The two runs can settle at different times. If the second one settles 5 ticks later, it must do so at a place
        that is 5 ticks later in the orbit.
        """
        period = self.table.orbits[known.after.orbit]
        tick = (known.after.tick + entry.length - known.length) % period
        if (known.after.orbit, tick, known.records) != (entry.after.orbit, entry.after.tick, entry.records):
            raise Contradiction(
                f"{self._covered.case.name}: two rounds from equal states differ (orbit {at.orbit}, tick {at.tick}: "
                f"{known} and {entry}); please report this as a defect of periph-sim"
            )

    def _place(self, run: FreeRun) -> RestPlace:
        """Return the place of the present rest, and add its orbit if it is new. Raise NotClosed if it has no orbit."""
        state = run.state()
        key = digest(state)
        if key not in self._places:
            self._add_orbit(run, key, state)
            key = digest(run.state())
        return self._places[key]

    def _add_orbit(self, run: FreeRun, key: bytes, state: NormalState) -> None:
        """Advance by one period, and add the states of this period as an orbit.

        If a state of another orbit is reached within the period, stop there, and add no orbit.

        state, key: the present state, and its digest.
        """
        period, cycle = period_of(run.scene), run.ticks_per_cycle
        table = self.table
        if sum(table.orbits) + period * cycle > MAX_ENTRIES:
            raise NotClosed(f"the table would have more than {MAX_ENTRIES:,} entries")
        keys = [key]
        for _ in range(period - 1):
            run.next_cycle()
            keys.append(digest(run.state()))
            if keys[-1] in self._places:
                return
        run.next_cycle()
        last = run.state()
        if digest(last) != key:
            raise run.not_repeating(state, last)
        keys = keys[: keys.index(key, 1)] if key in keys[1:] else keys
        self._places |= {each: RestPlace(len(table.orbits), number * cycle) for number, each in enumerate(keys)}
        table.orbits.append(len(keys) * cycle)
        self._open.append(list(range(len(keys) * cycle)))
        self._timed_from = self._timed_from or process_time()


def revisits(entries: int, least: int) -> int:
    """Return how many entries are run again: at least `least`, and one in REVISITED of these entries."""
    return max(least, entries // REVISITED)


def starts_text(moved: str, apart: str, any_tick: bool) -> str:
    """Return for which starts a table holds, such as "all sequences of rounds that start at least 4.4001 ms apart".

    moved: "rounds", "frames" or BOTH.
    apart: the least distance of two starts, as text.
    any_tick: True if rounds can start at any tick; False if they start with a cycle. It only matters for BOTH.
    """
    if moved != BOTH:
        return f"all sequences of {moved} that start at least {apart} apart"
    where = "" if any_tick else "with a cycle of the CPU, and "
    return f"all rounds that start {where}at least {apart} apart, and all frames that start at least as far apart"


def milliseconds(ticks: int, per_second: int) -> str:
    """Return ticks as text in ms, rounded up to a tenth of a microsecond."""
    return f"{ceil(Fraction(ticks * 10**7, per_second)) / 10**4:.4f} ms"
