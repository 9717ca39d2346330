"""Check, whenever a scene is at rest, whether each value of a measure follows from one round.

round --> rest --> round        a pair that waits for its second event lasts into the next round
      |        |                a round with too few measured values can be repeated until a run is not judged
   measure at rest
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from ..core.records import Kind
from ..timing.budgets import BudgetJudge
from ..timing.language.matcher import Matcher
from ..timing.measures.event import EventMeasure
from ..timing.measures.margin import Margin
from ..timing.measures.measure import Measure
from ..timing.measures.pair import FIRST, SECOND, Between
from ..timing.verdict import Verdict

# Kinds of records that a scene at rest does not make before the START of the next transfer, if no frame comes.
AFTER_START = frozenset([Kind.ACCESS, Kind.FLAG, Kind.IRQ, Kind.SPAN, Kind.BUS])


class MeasuresAtRest:
    """Observes the measures of a run at each rest.

    spanning: the names of the budgets with an occurrence that was not over at a rest.
    lacking: the names of the budgets for which a round had too few measured values, or whose values the run did not
        judge.
    empty: pairs (kind of start, name of a budget). The kind is "rounds" or "frames". A pair is added if the budget had
        no value after a start of this kind.

    The budgets in `empty` are lacking under these conditions:

    - `closed_table` regards each of them as lacking.
    - `pair_table`, for cases with both rounds and frames, regards a budget as lacking only if it is in pairs with both
      kinds. It is sufficient that a budget has a value after each round, or that it has a value after each frame.
    """

    def __init__(self, judges: Sequence[BudgetJudge], after_start: Collection[Kind] = AFTER_START) -> None:
        """after_start: kinds of records that a scene at rest does not make before the START of the next transfer."""
        self.spanning: set[str] = set()
        self.lacking: set[str] = set()
        self.empty: set[tuple[str, str]] = set()
        self._judges = judges
        self._after_start = after_start
        self._before = [(0, 0)] * len(judges)  # for each judge, `measured` and `occasions` at the last rest

    def rest(self, now: int, starts: Collection[str] = ("rounds",)) -> None:
        """Observe the measures at tick `now`, at which the scene is at rest.

        starts: the kinds of starts since the last rest, "rounds", "frames" or both; empty if nothing has started yet.
        """
        for place, judge in enumerate(self._judges):
            measure, (values, _) = judge.measure, self._before[place]
            if lasts(measure, now, self._after_start):
                self.spanning.add(judge.budget.name)
            self._count(place, measure.measured, measure.occasions)
            # events wait in the queue until it is known which of them is the last one of its group
            waits = isinstance(measure, EventMeasure) and bool(measure._queue)
            if not waits and measure.series and measure.occasions is None and measure.measured == values:
                self.empty |= {(start, judge.budget.name) for start in starts}

    def finish(self, verdicts: Sequence[Verdict]) -> None:
        """Observe the verdicts after the end of the run. They are in the order of the judges."""
        for place, verdict in enumerate(verdicts):
            self._count(place, verdict.measured, verdict.occasions)
            if verdict.count and not (verdict.passed or verdict.broken):
                self.lacking.add(verdict.name)

    def _count(self, place: int, measured: int, occasions: int | None) -> None:
        budget, (values, asked) = self._judges[place].budget, self._before[place]
        if occasions is not None and measured - values < budget.coverage * (occasions - asked):
            self.lacking.add(budget.name)
        self._before[place] = measured, occasions or 0


def lasts(measure: Measure, now: int, after_start: Collection[Kind] = AFTER_START) -> bool:
    """Return True if an occurrence of a measure has begun, and may end in the next round.

    after_start: as for `MeasuresAtRest`.

    `Measure.unfinished` does not report all such occurrences. It leaves out pairs whose transfer or round has had its
    STOP, and events that wait until it is known whether they are the last ones of their group.
    """
    if measure.unfinished(now) or (isinstance(measure, Margin) and measure.holds_byte):
        return True
    if isinstance(measure, EventMeasure) and any(one is not None and one.lasts(now) for one in measure._groups):
        return True
    if not isinstance(measure, Between):
        return False
    if measure._rule is not None and measure._rule.lasts(now):
        return True
    ends = {one.kind for one in measure.matchers[SECOND].each}
    if not ends <= set(after_start) and any(waiting.all() for waiting in measure._of_unit.values()):
        return True
    begun = 0
    for event in measure._queue:
        if event.place == FIRST:
            begun += 1
        elif event.place == SECOND:
            begun = begun - 1 if begun and measure.pairing == "in order" else 0
    return begun > 0


def round_events(measure: Measure) -> set[str]:
    """Return the records about the schedule of rounds that a measure uses, such as "due" and "next"."""
    if not isinstance(measure, EventMeasure):
        return set()
    return {one.what for one in events_of(measure) if one.kind is Kind.ROUND}


def events_of(measure: EventMeasure) -> list[Matcher]:
    """Return all events on which the values depend: also those of clauses, and those that begin and end groups."""
    each = [one for matcher in measure._all_matchers for one in matcher.each]
    groups = [one.group for one in each if one.group is not None]
    ends = [end for group in groups for end in (group.begin, group.end)]
    return each + [one for end in ends for one in end.each]
