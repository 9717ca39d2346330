"""Joined conditions of a budget, typical values, and occurrences that the end of the run cuts off."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.timing.budget_plan import BadBudget
from periph_sim.timing.budget_schema import Budget
from periph_sim.timing.budgets import BudgetJudge, combine
from periph_sim.timing.measures.measure import Measure
from tests.timing.events_by_hand import ONE, feed, records
from tests.timing.judges import US, judge, limit

START = 7_000_000_000


def kept(*values: tuple[int, int]) -> Measure:
    """A measure that has kept these (value, tick)."""
    of = Measure()
    of.keep()
    for value, at in values:
        of.take(value, at)
    return of


PAIRS = st.lists(st.tuples(st.integers(0, 9), st.integers(0, 6)), max_size=9, unique_by=lambda pair: pair[1])


@given(st.lists(PAIRS, min_size=1, max_size=3))
def test_joined_measures_keep_only_occurrences_that_the_first_one_has(drawn: list[list[tuple[int, int]]]):
    measures = [kept(*values) for values in drawn]
    wanted = [at for _, at in drawn[0]]
    assert combine(measures) == [sum(at not in [a for _, a in values] for at in wanted) for values in drawn]
    for measure, values in zip(measures, drawn, strict=True):
        there = [pair for pair in values if pair[1] in wanted]
        if {at for _, at in there} != {*wanted}:
            there = []  # an occurrence without a value: nothing is proven
        assert [column.tolist() for column in measure.all_kept()] == [[v for v, _ in there], [at for _, at in there]]
        assert measure.count == len(there)


def both(**limits: object) -> BudgetJudge:
    """A budget that limits age to 2 us and stretch as given."""
    of = Budget.model_validate(
        {"name": "fresh", "measure": "age", "max": "2 us", "why": "so", "and": [{"measure": "stretch", **limits}]}
    )
    return judge(of, ONE, START)


def fed(of: BudgetJudge, ages: list[int], stretches: list[int]) -> BudgetJudge:
    """Add a value of each part every microsecond."""
    for part, values in zip(of.parts, (ages, stretches), strict=True):
        for place, value in enumerate(values):
            part.measure.take(value * US, START + place * US)
            part.measure.occasion(START + place * US)
    lacking = combine([part.measure for part in of.parts])
    assert lacking[0] == 0
    return of


def test_a_verdict_on_joined_conditions_lists_all_and_shows_the_broken_one():
    held = fed(both(max="5 us"), [1, 2], [3, 4]).verdict(START)
    assert (held.name, held.why, held.verdict, held.measure, held.worst) == ("fresh", "so", "pass", "age", 2.0)
    assert held.found == "age 2.000 us at 0.000001 s (max 2 us); stretch 4.000 us at 0.000001 s (max 5 us)"
    first = fed(both(max="5 us"), [3, 2], [9, 4]).verdict(START)
    assert (first.verdict, first.measure, first.worst, first.at_s) == ("fail", "age", 3.0, 0.0)
    second = fed(both(max="5 us"), [1, 2], [3, 6]).verdict(START)
    assert (second.name, second.verdict, second.measure, second.worst) == ("fresh", "fail", "stretch", 6.0)
    assert second.found == "age 2.000 us at 0.000001 s (max 2 us); stretch 6.000 us at 0.000001 s (max 5 us)"


def test_a_condition_without_a_value_for_one_occurrence_is_not_judged():
    of = both(max="5 us")
    for part, count in zip(of.parts, (2, 1), strict=True):
        for place in range(count):
            part.measure.take(US, START + place * US)
            part.measure.occasion(START + place * US)
    of.finish(START + 9 * US)
    found = of.verdict(START)
    assert (found.verdict, found.measure, found.worst) == ("not judged", "stretch", None)
    assert found.found == "age 1.000 us at 0.000000 s (max 2 us); 'stretch' has no value for 1 of 2 values of 'age'"


@pytest.mark.parametrize(
    ("measure", "other", "place", "which"),
    [("round", "age", ("measure",), "round"), ("age", "round", ("and", 0, "measure"), "round")],
)
def test_only_measures_of_reads_can_be_joined(measure: str, other: str, place: tuple[object, ...], which):
    table = {"name": "b", "measure": measure, "max": "1 us", "and": [{"measure": other, "max": "1 us"}]}
    with pytest.raises(BadBudget) as caught:
        judge(Budget.model_validate(table), ONE)
    assert caught.value.place == place
    assert str(caught.value) == (
        f"{which!r} is not measured read by read, so nothing can be joined to it; "
        "age, model age, stretch and value error are"
    )


def test_a_mistake_in_a_joined_condition_is_reported_with_its_place():
    table = {"name": "b", "measure": "age", "max": "1 us", "and": [{"measure": "stretch", "max": "1 parsec"}]}
    with pytest.raises(BadBudget) as caught:
        judge(Budget.model_validate(table), ONE)
    assert caught.value.place == ("and", 0, "max")


# Typical values -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("limits", "worst", "at_us"),
    [({"max": "9 us"}, 2.0, 1), ({"min": "1 us"}, 5.0, 2), ({"exactly": "5 us"}, 2.0, 1), ({"p50": "5 us"}, 2.0, 1)],
)
def test_the_typical_value_is_the_one_furthest_from_its_limit(limits: dict[str, str], worst: float, at_us: int):
    of = limit("stretch", start=START, **limits)
    for place, value in enumerate((3, 2, 5)):
        of.measure.take(value * US, START + place * US)
        of.measure.occasion(START)
    found = of.typical(START)
    assert (found.worst, found.at_s, found.margin) == (worst, pytest.approx(at_us * 1e-6), None)


def test_there_is_no_typical_value_of_fewer_than_two_values_or_of_one_number_per_run():
    of = limit("stretch", start=START, max="9 us")
    assert of.typical(START) is None
    of.measure.take(US, START)
    assert of.typical(START) is None
    of.measure.take(US, START)
    assert of.typical(START) is not None
    count = limit("overruns", start=START, max=9)
    for at in (1, 2):
        count.measure.happened(0, START + at, 0)
    assert count.typical(START) is None


# Occurrences that the end of the run cuts off -------------------------------------------------------------------------

WAITS = f"{START} edge SCL level 1"


@pytest.mark.parametrize(
    ("limits", "waited_us", "verdict"),
    [
        ({"max": "2 us"}, 2, "pass"),
        ({"max": "2 us"}, 3, "fail"),
        ({"min": "2 us"}, 1, "not judged"),  # it could still last longer
        ({"min": "2 us"}, 9, "not judged"),
        ({"exactly": "2 us"}, 1, "not judged"),
        ({"exactly": "2 us"}, 2, "not judged"),
        ({"exactly": "2 us"}, 3, "fail"),
        ({"p50": "2 us"}, 3, "fail"),
        ({"p50": "2 us"}, 2, "pass"),
        ({"min": "1 us", "max": "2 us"}, 3, "fail"),
    ],
)
def test_an_unfinished_only_value_is_judged_only_if_it_is_already_too_long(
    limits: dict[str, str], waited_us: int, verdict: str
):
    of = limit("from edge SCL rise to edge SCL fall", start=START, **limits)
    feed(of.measure, records(WAITS))
    of.finish(START + waited_us * US)
    found = of.verdict(START)
    assert (found.verdict, found.count) == (verdict, 1)
    assert found.worst == (None if verdict == "not judged" else waited_us)


@pytest.mark.parametrize(("at", "counts"), [(START + 3 * US - 1, 0), (START + 3 * US, 1), (START + 3 * US + 1, 1)])
def test_after_is_counted_from_the_begin_of_the_run(at: int, counts: int):
    of = limit("response", start=START, max="9 us", after="3 us")
    of.measure.take(US, at)
    assert of.measure.count == counts


def test_after_is_rejected_for_one_number_per_run():
    with pytest.raises(BadBudget, match="'bus load' is one number a run, so none of it can be left out") as caught:
        limit("bus load", start=START, max="9 %", after="3 us")
    assert caught.value.place[-1] == "after"
