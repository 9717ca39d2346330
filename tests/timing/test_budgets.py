"""Limits on measures: what passes, what fails, and what is refused before anything runs."""

from __future__ import annotations

import pytest

from periph_sim.timing.budget_plan import BadBudget
from periph_sim.timing.budget_schema import Budget
from periph_sim.timing.budgets import BudgetJudge
from periph_sim.timing.language.scope import Scope
from periph_sim.timing.measures.event import EventMeasure
from tests.timing.judges import US, judge, judged, judges

TEXT = "from edge SCL fall to edge SCL rise"


def limit(measure: str, **limits: str | int) -> BudgetJudge:
    return judge(Budget(name="b", measure=measure, **limits))


def alike(one: dict[str, str | int], other: dict[str, str | int]) -> tuple[BudgetJudge, BudgetJudge]:
    """Two budgets of one scene, on time of the same."""
    budgets = [Budget(name=name, measure=TEXT, **limits) for name, limits in (("a", one), ("b", other))]
    first, second = judges(budgets, Scope(wires=("SCL",)))
    return first, second


def test_budgets_on_the_same_have_one_measure_and_each_its_verdict():
    first, second = alike({"max": "3 us"}, {"p50": "1 us"})
    assert second.measure is first.measure and first.own_measures and not second.own_measures
    for n, value in enumerate((1, 2, 2)):
        first.measure.take(value * US, n * US)
    for of in (first, second):
        of.finish(10 * US)
    assert [(v.verdict, v.worst, v.count) for v in (first.verdict(), second.verdict())] == [
        ("pass", 2.0, 3),
        ("fail", 2.0, 3),
    ]


def test_what_the_end_cut_off_counts_once_for_budgets_on_the_same():
    first, second = alike({"max": "3 us"}, {"max": "9 us"})
    first.measure.happened(0, US, 0)
    for of in (first, second):
        of.finish(6 * US)
    assert [(v.verdict, v.worst, v.count) for v in (first.verdict(), second.verdict())] == [
        ("fail", 5.0, 1),
        ("pass", 5.0, 1),
    ]
    assert first.verdict().found == second.verdict().found != ""


@pytest.mark.parametrize(
    "other", [{"max": "9 us", "after": "1 ms"}, {"max": "9 us", "measure": "period of edge SCL fall"}]
)
def test_budgets_on_other_things_have_their_own_measures(other):
    budget = Budget(**{"name": "b", "measure": TEXT, **other})
    first, second = judges([Budget(name="a", measure=TEXT, max="3 us"), budget], Scope(wires=("SCL",)))
    assert second.measure is not first.measure and second.own_measures == [second.measure]


@pytest.mark.parametrize(
    ("limits", "values", "verdict", "worst", "margin", "at_s"),
    [
        ({"max": "60 us"}, (20.0, 50.0, 30.0), "pass", 50.0, 10.0, 1.0),
        ({"max": "60 us"}, (60.0,), "pass", 60.0, 0.0, 0.0),
        ({"max": "60 us"}, (20.0, 60.5), "fail", 60.5, -0.5, 1.0),
        ({"min": "10 us"}, (20.0, 12.0, 30.0), "pass", 12.0, 2.0, 1.0),
        ({"min": "10 us"}, (20.0, 9.0), "fail", 9.0, -1.0, 1.0),
        ({"min": "10 us", "max": "60 us"}, (19.0, 50.0), "pass", 19.0, 9.0, 0.0),
        ({"min": "10 us", "max": "60 us"}, (20.0, 55.0), "pass", 55.0, 5.0, 1.0),
        ({"min": "10 us", "max": "60 us"}, (9.0, 65.0), "fail", 65.0, -5.0, 1.0),
        ({"min": "10 us", "max": "10 us"}, (10.0,), "pass", 10.0, 0.0, 0.0),
    ],
)
def test_the_nearer_limit_counts(limits, values, verdict, worst, margin, at_s):
    v = judged(limit("response", **limits), *values)
    assert (v.verdict, v.worst, v.margin, v.at_s) == (verdict, worst, margin, at_s)
    assert (v.unit, v.count) == ("us", len(values))


def test_a_duration_that_was_never_measured_is_not_judged():
    v = limit("response", max="60 us").verdict()
    assert (v.verdict, v.worst, v.margin, v.count, v.at_s) == ("not judged", None, None, 0, None)


def test_a_fifo_that_nothing_ever_entered_is_not_judged_either():
    assert limit("fifo high-water", max=16).verdict().verdict == "not judged"


def test_zero_of_something_counted_is_a_value():
    v = limit("nacked", max=0).verdict()
    assert (v.verdict, v.worst, v.limit, v.margin, v.count, v.at_s) == ("pass", 0, 0, 0, 0, None)


def test_counts_are_judged_whole():
    of = limit("nacked", max=1)
    assert isinstance(of.measure, EventMeasure)
    of.measure.happened(0, 3 * US, 0)
    assert of.verdict().verdict == "pass"
    of.measure.happened(0, 6_000_000 * US, 0)
    v = of.verdict()
    assert (v.verdict, v.worst, v.limit, v.margin, v.unit, v.at_s) == ("fail", 2, 1, -1, "count", 3e-06)


def test_a_minimum_of_a_count():
    of = limit("nacked", min=1)
    assert of.verdict().verdict == "fail"
    assert isinstance(of.measure, EventMeasure)
    of.measure.happened(0, 0, 0)
    assert of.verdict().verdict == "pass"


def test_limits_between_two_ticks_are_rounded_to_the_nearest():
    assert judged(limit("response", max="100.1 ns"), 0.1).verdict == "pass"
    assert limit("response", max="1/6 ns").verdict().limit == 0.0003  # one tick of 1/3 ns, shown in us


@pytest.mark.parametrize(
    ("measure", "limits", "key", "sentence"),
    [
        ("respons", {"max": "1 us"}, "measure", "there is no measure 'respons'; did you mean response?"),
        (
            "nackd rounds",
            {"max": 0},
            "measure",
            "there is no measure 'nackd rounds'; did you mean nacked rounds or missed rounds?",
        ),
        ("response", {"max": 60}, "max", '60 has no unit; write for instance "60 ms"'),
        ("response", {"min": "60"}, "min", "'60' has no unit; write for instance 60 ms (ns, us, ms, s, min, h, d)"),
        ("response", {"max": "-1 us"}, "max", "'-1 us' is negative; a duration is 0 or more"),
        ("nacked", {"max": "3"}, "max", "'3', but 'nacked' is a number; write a whole number"),
        ("nacked", {"max": "3 us"}, "max", "'3 us', but 'nacked' is a number; write a whole number"),
        (
            "fifo high-water",
            {"max": "1 ms"},
            "max",
            "'1 ms', but 'fifo high-water' is a number of words; write a whole number",
        ),
        (
            "response",
            {"max": "10 us", "min": "11 us"},
            "min",
            "min 11 us is above max 10 us, so no run can keep both; raise max or lower min",
        ),
        (
            "nacked",
            {"max": 1, "min": 2},
            "min",
            "min 2 is above max 1, so no run can keep both; raise max or lower min",
        ),
    ],
)
def test_a_budget_that_cannot_be_kept_or_is_none_is_refused(measure, limits, key, sentence):
    with pytest.raises(BadBudget) as caught:
        limit(measure, **limits)
    assert (str(caught.value), caught.value.place[-1]) == (sentence, key)
