"""Proof for every start: a table of states and starts. Each entry is run, and each run ends in a state of the table.

    rest in state s, next start in r ticks --one round is run--> rest in state s'

Between two rounds (or frames) the scene is at *rest*: no event is due, and the firmware waits in a loop. The state of
the scene (`normal_state`) then repeats with a period, because the clocks and the passes of the loop repeat. The states
of one period are an *orbit*. So there are only as many different starts of the next round as a period has ticks,
however long the scene rests. An *entry* of the table is an orbit and one of its ticks. A round that starts there is run
once, and ends in a state of an orbit again. If all entries of all orbits were run, the table is *closed*: whatever the
distances between starts are, each round proceeds exactly as in one of the runs.

This is true if a scene continues equally from equal normal states. Some entries are therefore run again, after other
rounds and after a rest of another length, and compared with the first run; `Contradiction` is raised if they differ.
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

BOTH = "rounds and frames"  # the word for the starts if both rounds and frames are free
MAX_ENTRIES = 400_000
ROUNDS_A_RUN = 256  # maximum number of rounds in one run; it is doubled if a run has run no new entry
MOST_ROUNDS_A_RUN = 2**16
REVISITED = 20  # one in REVISITED entries is run again, but normally at least LEAST_REVISITED entries
LEAST_REVISITED = 200
TIMED = 20  # the CPU time of the first TIMED entries gives the estimate for all
LONGER_RESTS = 3  # rests are longer than necessary by a random number of periods below this


class Contradiction(Exception):
    """Error: two runs from equal normal states differ, so the normal state is incomplete: a defect of periph-sim."""


class RestPlace(Struct, frozen=True):
    """A state of rest: the number of its orbit, and its tick in the orbit."""

    orbit: int
    tick: int


class TableEntry(Struct, frozen=True):
    """The result of the run of an entry.

    after: the state of rest after the round.
    length: number of ticks from the start of the round to this state.
    records: the digest of the round (`RoundDigest`).
    """

    after: RestPlace
    length: int
    records: int


class StartTable(Struct):
    """A table of states of rest and starts. When it is finished, it is closed, or the last run has failed.

    orbits: for each orbit, the number of its entries: its ticks or, in a table of `pair_table`, its groups.
    entries: the number of entries that were run.
    again: the number of entries that were run again.
    apart: the least distance of two starts for which the table holds, in ticks.
    first_rest: the tick of the first rest, from the start of the run.
    rests_first: True if the table has entries for any first start after this rest; False if it has only the first start
        of the case.
    outcomes: the outcomes of the runs.
    starts: for each run, its starts, in ticks from the start of the run; only those of frames if both rounds and frames
        are free.
    spanning, lacking: the names of budgets, see `MeasuresAtRest`.
    rounds: if both rounds and frames are free, the starts of rounds of each run; else empty.
    data_use: as `FreeRun.data_use`, for all runs.
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
        return bool(self.outcomes and self.outcomes[-1].failures)

    def not_proven(self, covered: CoveredCase, apart: int, within: Fraction = Fraction(0)) -> dict[str, str]:
        """Return the budgets that the table does not prove, as a dictionary from the name of each to the reason.

        The table proves a budget if each of its values follows from one round, if all rounds are judged, and if the
        starts of the case are far enough apart.

        apart: the least distance of two starts for which it must prove them, in ticks: at least `self.apart`.
        within: as for `Phases.least_distance`.
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

    on_progress: called with the fraction of the known entries that have been run, 0 to 1.
    on_estimate: called after TIMED entries, with the expected number of entries, and an estimate of the CPU time in
        seconds.
    on_run: called at the end of each run, with the run and the places at which its rounds began. If a run begins with
        the first round of the case, the place of this round is left out. With `on_run`, scenes keep all values of their
        budgets.
    rests_first: as for `FreeRun`. None means True if the starts of the case have jitter, else for False.
    least_again: the least number of entries that are run again.
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
        self._timed_from = 0.0  # the CPU time at which the first entry was begun
        self._ignored = check(covered.case)
        self._random = Random(1)
        self._rounds = ROUNDS_A_RUN  # maximum number of rounds in the next run
        self._places: dict[bytes, RestPlace] = {}  # from the digest of a state of rest to its place
        self._open: list[list[int]] = []  # for each orbit, the ticks of the entries that were not run yet, ascending
        self.entries: dict[RestPlace, TableEntry] = {}  # by the place at the start of the round
        self.first: TableEntry | None = None  # the first round, equal in all runs; None with `rests_first`
        is_free = covered.phases.jitter > 0 if rests_first is None else rests_first
        self.table = StartTable([], 0, 0, 0, 0, is_free, [], [], set(), set())

    def make(self) -> StartTable:
        """Return the table, once it is closed or a run has failed.

        Raise NotClosed if it cannot be closed. Raise Contradiction if two runs of an entry differ.
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

        again: 0 to run entries that were not run yet. Otherwise, random entries are run, until `again` entries of the
            table have been run again.
        """
        run = FreeRun(self._covered, self._ignored, self._on_run is not None, self.table.rests_first)
        table = self.table
        measures = MeasuresAtRest(run.scene.limits)
        measures.rest(run.now, () if self.table.rests_first else ("rounds",))
        table.first_rest = run.now - run.scene.start
        place = self._place(run)
        if not self.table.rests_first:
            table.apart = max(table.apart, table.first_rest - self._starts(run)[0] + 1)
            first = self._starts(run)[0]
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
        table.starts.append(self._starts(run))
        table.outcomes.append(self._covered.finish(run.scene))
        table.data_use = table.data_use or run.data_use
        measures.finish(table.outcomes[-1].verdicts)
        if self._on_run is not None:
            self._on_run(run, begun)
        table.spanning |= measures.spanning
        # a run in which no round has a value of a budget does not judge this budget
        table.lacking |= measures.lacking | {name for _, name in measures.empty}

    def _starts(self, run: FreeRun) -> list[int]:
        return run.frames if self._covered.phases.moved == "frames" else run.rounds

    def _next_tick(self, place: RestPlace) -> int | None:
        """Return the tick of the next entry to run, from the orbit of `place`.

        This is an open entry, which was not run yet, or else an entry on the way to an open one. Return None if no open
        entry can be reached.
        """
        here = self._open[place.orbit]
        if here:
            return here[bisect_right(here, place.tick) % len(here)]
        ways: dict[int, dict[int, int]] = {}  # as in `first_step`; a step is the tick of an entry
        for at, entry in self.entries.items():
            ways.setdefault(at.orbit, {}).setdefault(entry.after.orbit, at.tick)
        return first_step(ways, place.orbit, lambda orbit: bool(self._open[orbit]))

    def _round(self, run: FreeRun, measures: MeasuresAtRest, place: RestPlace, tick: int) -> RestPlace:
        """Run a round that starts at `tick` of the orbit of `place`, the present place. Return the place after it."""
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
        """Return the estimated CPU time in seconds. entries: the number of entries of the first orbit."""
        now = process_time()
        entry = (now - self._timed_from) / TIMED
        if not self.table.rests_first:
            return entry * (entries + revisits(entries, self._least_again))
        # No round leads back to the first orbit, so each of its entries needs a run of its own. After the rounds, the
        # table has one more orbit, which is assumed to be as long.
        FreeRun(self._covered, self._ignored, self._on_run is not None, self.table.rests_first)
        return entry * (2 * entries + revisits(2 * entries, self._least_again)) + (process_time() - now) * entries

    def _compare(self, at: RestPlace, known: TableEntry, entry: TableEntry) -> None:
        """Raise Contradiction if two runs of an entry differ.

        If the second run is longer, its state of rest must be later in the orbit by the difference of the lengths.
        """
        period = self.table.orbits[known.after.orbit]
        tick = (known.after.tick + entry.length - known.length) % period
        if (known.after.orbit, tick, known.records) != (entry.after.orbit, entry.after.tick, entry.records):
            raise Contradiction(
                f"{self._covered.case.name}: two rounds from equal states differ (orbit {at.orbit}, tick {at.tick}: "
                f"{known} and {entry}); please report this as a defect of periph-sim"
            )

    def _place(self, run: FreeRun) -> RestPlace:
        """Return the place of the present state of rest. Raise NotClosed if this state does not repeat."""
        state = run.state()
        key = digest(state)
        if key not in self._places:
            self._add_orbit(run, key, state)
            key = digest(run.state())
        return self._places[key]

    def _add_orbit(self, run: FreeRun, key: bytes, state: NormalState) -> None:
        """Advance by one period, and add the orbit that consists of the states of this period.

        If a state of a known orbit is reached within the period, stop in this state, and add no orbit.

        key, state: the digest of the present state, and the present state.
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
    """Return how many entries of a table with this number of entries are run again: at least `least`."""
    return max(least, entries // REVISITED)


def starts_text(moved: str, apart: str, any_tick: bool) -> str:
    """Return a phrase that says for which starts a table holds.

    moved: "rounds", "frames" or BOTH. apart: the least distance of two starts, as text. any_tick: as in `TableProof`.
    """
    if moved != BOTH:
        return f"all sequences of {moved} that start at least {apart} apart"
    where = "" if any_tick else "with a cycle of the CPU, and "
    return f"all rounds that start {where}at least {apart} apart, and all frames that start at least as far apart"


def milliseconds(ticks: int, per_second: int) -> str:
    """Return ticks as text in ms, rounded up to a tenth of a microsecond."""
    return f"{ceil(Fraction(ticks * 10**7, per_second)) / 10**4:.4f} ms"
