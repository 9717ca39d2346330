"""Check, whenever a scene is at rest, whether all values of a budget's measure follow from single rounds.

    round --> rest --> round --> rest
               |                  |
          measures are observed at each rest

At each rest, a budget can get one of two properties. A closed table proves only budgets that have neither:

spanning: an occurrence of the measure has begun but is not over, such as a pair whose second event has not come yet. So
    its value also depends on the next round.
lacking: the round before the rest has given fewer values than the budget requires. A run could consist of such rounds
    only, and would then not judge the budget.

The glossary in `periph_sim.proof` has the other terms.
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

# Kinds of records of which a scene at rest makes none until the START of the next transfer, if no frame comes.
AFTER_START = frozenset([Kind.ACCESS, Kind.FLAG, Kind.IRQ, Kind.SPAN, Kind.BUS])


class MeasuresAtRest:
    """Observes the measures of a run at each rest.

    spanning: the names of the budgets with an occurrence that was not over at a rest.
    lacking: the names of the budgets that had too few measured values in a round (see the key `coverage` of budgets),
        or no verdict in the run.
    empty: a pair such as ("rounds", "response") for each budget that had no value after a round, and such as ("frames",
        "response") for each budget that had no value after a frame.

    Budgets in `empty` count as lacking, too. But in a case with rounds and frames, only those with both pairs do: it is
    sufficient that a budget has a value after each round, or a value after each frame.
    """

    def __init__(self, judges: Sequence[BudgetJudge], after_start: Collection[Kind] = AFTER_START) -> None:
        """after_start: kinds of records of which a scene at rest makes none until the START of the next transfer."""
        self.spanning: set[str] = set()
        self.lacking: set[str] = set()
        self.empty: set[tuple[str, str]] = set()
        self._judges = judges
        self._after_start = after_start
        self._before = [(0, 0)] * len(judges)  # for each judge, `measured` and `occasions` at the last rest

    def rest(self, now: int, starts: Collection[str] = ("rounds",)) -> None:
        """Observe the measures at the present rest. now: the present tick.

        starts: what has started since the last rest: "rounds", "frames", both or nothing.
        """
        for place, judge in enumerate(self._judges):
            measure, (values, _) = judge.measure, self._before[place]
            if lasts(measure, now, self._after_start):
                self.spanning.add(judge.budget.name)
            self._count(place, measure.measured, measure.occasions)
            # events are in the queue until it is known whether they are the last ones of a transfer
            waits = isinstance(measure, EventMeasure) and bool(measure._queue)
            if not waits and measure.series and measure.occasions is None and measure.measured == values:
                self.empty |= {(start, judge.budget.name) for start in starts}

    def finish(self, verdicts: Sequence[Verdict]) -> None:
        """Observe the verdicts after the end of the run, given in the order of the judges."""
        for place, verdict in enumerate(verdicts):
            self._count(place, verdict.measured, verdict.occasions)
            if verdict.count and not (verdict.passed or verdict.broken):
                self.lacking.add(verdict.name)

    def _count(self, place: int, measured: int, occasions: int | None) -> None:
        """Note a budget as lacking if it has too few values since the last rest. place: the index of its judge.

        measured: the number of values so far. occasions: the number of values that there should be; None for any.
        """
        budget, (values, asked) = self._judges[place].budget, self._before[place]
        if occasions is not None and measured - values < budget.coverage * (occasions - asked):
            self.lacking.add(budget.name)
        self._before[place] = measured, occasions or 0


def lasts(measure: Measure, now: int, after_start: Collection[Kind] = AFTER_START) -> bool:
    """Return True if an occurrence of a measure has begun, but may not end before the next round.

    The result is also True for occurrences of these kinds, which `Measure.unfinished` leaves out:

    - a pair that waits for its second event after the STOP of its transfer or round, unless the second event is of a
      kind in `after_start`: such an event comes after the next START, which is too late for the pair
    - an event of which it is not known yet whether it is the last one, as for "last interrupt of transfer"

    now: the present tick.
    after_start: kinds of records of which a scene at rest makes none until the START of the next transfer.
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
    """Return the names of the records about the schedule of rounds that a measure uses, such as {"due", "next"}."""
    if not isinstance(measure, EventMeasure):
        return set()
    return {one.what for one in events_of(measure) if one.kind is Kind.ROUND}


def events_of(measure: EventMeasure) -> list[Matcher]:
    """Return all events on which the values of a measure depend.

    They include events in clauses, and the begin and end of groups, such as the transfer of "1st edge of transfer".
    """
    each = [one for matcher in measure._all_matchers for one in matcher.each]
    groups = [one.group for one in each if one.group is not None]
    ends = [end for group in groups for end in (group.begin, group.end)]
    return each + [one for end in ends for one in end.each]
