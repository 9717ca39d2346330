"""Limits of budgets: values that pass and fail, combinations, rejected limits, and occurrences that are not over."""

from __future__ import annotations

import pytest

from periph_sim.timing.budget_plan import BadBudget
from periph_sim.timing.budget_schema import Budget
from periph_sim.timing.budgets import BudgetJudge
from periph_sim.timing.language.scope import Scope
from periph_sim.timing.measures.registry import MEASURES
from tests.timing.events_by_hand import feed, make, records
from tests.timing.judges import US, judged, judges, limit


@pytest.mark.parametrize(
    ("limits", "values", "verdict", "worst", "margin", "at_s", "which"),
    [
        ({"max": "60 us"}, (20.0, 50.0, 30.0), "pass", 50.0, 10.0, 1.0, "max"),
        ({"max": "60 us"}, (60.0,), "pass", 60.0, 0.0, 0.0, "max"),
        ({"max": "60 us"}, (20.0, 60.5), "fail", 60.5, -0.5, 1.0, "max"),
        ({"min": "10 us"}, (20.0, 12.0, 30.0), "pass", 12.0, 2.0, 1.0, "min"),
        ({"min": "10 us"}, (20.0, 9.0), "fail", 9.0, -1.0, 1.0, "min"),
        ({"min": "10 us", "max": "60 us"}, (19.0, 50.0), "pass", 19.0, 9.0, 0.0, "min"),
        ({"min": "10 us", "max": "60 us"}, (20.0, 55.0), "pass", 55.0, 5.0, 1.0, "max"),
        ({"min": "10 us", "max": "60 us"}, (9.0, 65.0), "fail", 65.0, -5.0, 1.0, "max"),
        ({"min": "10 us", "max": "10 us"}, (10.0,), "pass", 10.0, 0.0, 0.0, "max"),
        ({"exactly": "250 us"}, (250.0, 250.0), "pass", 250.0, 0.0, 0.0, "exactly"),
        ({"exactly": "250 us"}, (250.0, 251.0, 249.5), "fail", 251.0, -1.0, 1.0, "exactly"),
        ({"exactly": "250 us"}, (250.0, 251.0, 248.0), "fail", 248.0, -2.0, 2.0, "exactly"),
        ({"exactly": "250 us"}, (249.0, 251.0), "fail", 251.0, -1.0, 1.0, "exactly"),  # the longer one
        ({"p50": "20 us"}, (10.0, 20.0, 30.0, 40.0), "pass", 20.0, 0.0, 1.0, "p50"),
        ({"p50": "20 us"}, (40.0, 30.0, 20.0, 10.0, 50.0), "fail", 30.0, -10.0, 1.0, "p50"),
        ({"p95": "9 us"}, (*([1.0] * 19), 99.0), "pass", 1.0, 8.0, 0.0, "p95"),
        ({"p95": "9 us"}, (*([1.0] * 18), 99.0, 99.0), "fail", 99.0, -90.0, 18.0, "p95"),
        ({"p99": "9 us"}, (1.0, 99.0), "fail", 99.0, -90.0, 1.0, "p99"),
        ({"p99_9": "9 us"}, (*([1.0] * 999), 99.0), "pass", 1.0, 8.0, 0.0, "p99_9"),
        ({"p99_9": "9 us"}, (*([1.0] * 1000), 99.0, 99.0), "fail", 99.0, -90.0, 1000.0, "p99_9"),
        ({"max": "40 us", "p50": "20 us"}, (10.0, 39.0), "pass", 39.0, 1.0, 1.0, "max"),
        ({"max": "40 us", "p50": "10.5 us"}, (10.0, 39.0), "pass", 10.0, 0.5, 0.0, "p50"),
        ({"min": "9 us", "p50": "20 us"}, (10.0, 30.0), "pass", 10.0, 1.0, 0.0, "min"),
    ],
)
def test_the_nearest_limit_counts(limits, values, verdict, worst, margin, at_s, which):
    v = judged(limit("response", **limits), *values)
    assert (v.verdict, v.worst, v.margin, v.at_s, v.which) == (verdict, worst, margin, at_s, which)
    assert (v.unit, v.count) == ("us", len(values))


def test_values_are_tallied_only_for_percentiles():
    plain, counted = limit("response", max="1 us"), limit("response", p99="1 us")
    assert (plain.measure.tally is None, counted.measure.tally is None) == (True, False)
    assert plain.measure.kept is counted.measure.kept is None


def test_the_memory_of_a_percentile_grows_only_with_different_values():
    of = limit("response", p50="10 us").measure
    for at in range(10_000):
        of.take(at % 7, at)
    assert of.tally is not None and len(of.tally) == 7
    assert of.tally.percentile(500) == (3, 3)


def test_two_percentiles_can_have_the_same_limit():
    """The lower percentile adds no restriction then, but is allowed."""
    of = limit("response", p50="11 us", p99="11 us")
    assert judged(of, 10.0, 11.0).passed


@pytest.mark.parametrize("name", [n for n in MEASURES if not make(n).series])
def test_one_number_per_run_has_no_percentiles(name: str):
    with pytest.raises(BadBudget, match="is one number a run and has no percentiles; write max") as caught:
        limit(name, p99=1)
    assert caught.value.place[-1] == "p99"


def test_a_share_of_the_time_is_judged_and_shown_in_percent():
    of = limit("bus load", max="40 %", min="12.5%")
    feed(of.measure, records("0 bus c START 0\n13 bus c STOP 0"))
    of.measure.finish(100)
    v = of.verdict()
    assert (v.unit, v.worst, v.limit, v.margin, v.verdict, v.which) == ("%", 13.0, 12.5, 0.5, "pass", "min")


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
        (
            "response",
            {"exactly": "1 us", "max": "2 us"},
            "exactly",
            "exactly says all that max could; leave one of them out",
        ),
        (
            "response",
            {"exactly": "1 us", "min": "2 us", "p95": "2 us"},
            "exactly",
            "exactly says all that min and p95 could; leave one of them out",
        ),
        (
            "response",
            {"max": "10 us", "p99": "11 us"},
            "p99",
            "p99 11 us is above max 10 us, which no value may exceed; lower p99 or leave it out",
        ),
        (
            "response",
            {"min": "10 us", "p50": "9 us"},
            "min",
            "min 10 us is above p50 9 us, so no run can keep both; raise p50 or lower min",
        ),
        (
            "response",
            {"p50": "12 us", "p99_9": "11 us"},
            "p50",
            "p50 12 us is above p99_9 11 us, which says more already; lower p50 or leave it out",
        ),
        ("response", {"p95": 3}, "p95", '3 has no unit; write for instance "3 ms"'),
        (
            "response",
            {"exactly": "3"},
            "exactly",
            "'3' has no unit; write for instance 3 ms (ns, us, ms, s, min, h, d)",
        ),
        ("cpu load", {"max": 40}, "max", "40, but 'cpu load' is a part of the time; write for instance '40 %'"),
        (
            "bus load",
            {"max": "140 %"},
            "max",
            "'140 %', but 'bus load' is a part of the time; write for instance '40 %'",
        ),
        ("bus load", {"max": "x %"}, "max", "'x %', but 'bus load' is a part of the time; write for instance '40 %'"),
        ("cpu load", {"p50": "4 %"}, "p50", "'cpu load' is one number a run and has no percentiles; write max"),
        ("missed rounds", {"max": -1}, "max", "-1, but 'missed rounds' is never negative; write 0 or more"),
        ("count of frame", {"min": -1}, "min", "-1, but 'count of frame' is never negative; write 0 or more"),
        ("count of frame", {"max": "4"}, "max", "'4', but 'count of frame' is a number; write a whole number"),
        (
            "count of span modle begin",
            {"max": 0},
            "max",
            "a span's name is free text, so that none was seen proves nothing; limit what the run does instead",
        ),
        (
            "from edge SLC rise to frame",
            {"max": "1 us"},
            "measure",
            "there is no wire 'SLC'; did you mean SCL?",
        ),
        (
            "perod of frame",
            {"max": "1 us"},
            "measure",
            "there is no measure 'perod of frame'; did you mean period of EV",
        ),
        (
            "response",
            {"max": "1 us", "after": "300000 d"},
            "after",
            "a time of 3e+05 d is too long: with ticks of 1/",
        ),
    ],
)
def test_limits_that_contradict_each_other_or_their_measure_are_rejected(measure, limits, key, sentence):
    with pytest.raises(BadBudget) as caught:
        limit(measure, **limits)
    assert caught.value.place[-1] == key
    assert str(caught.value).startswith(sentence)


def test_an_event_that_never_matched_is_not_judged():
    v = limit("from edge SCL rise to edge SCL fall", max="1 us").verdict()
    assert (v.verdict, v.worst, v.margin, v.count) == ("not judged", None, None, 0)
    assert v.found == "no event matched 'edge SCL rise' and 'edge SCL fall'"


def test_a_count_of_zero_is_a_value_unless_the_name_is_free_text():
    assert limit("count of note duty", max=0).verdict().verdict == "pass"
    v = limit("count of span modle begin", max=5).verdict()
    assert (v.verdict, v.found) == ("not judged", "no event matched 'span modle begin'; the run had no span")


ASKED = "1000 edge SCL level 1\n2000 edge SCL level 0\n3000 edge SCL level 1"


@pytest.mark.parametrize(
    ("limits", "end", "verdict", "worst", "count"),
    [
        ({"max": "1 us"}, 6001, "fail", 1.0003, 2),  # 3001 ticks, and the edge has not occurred
        ({"max": "1 us"}, 6000, "pass", 1.0, 2),  # the edge could occur at this tick
        ({"max": "1 us"}, 3999, "pass", 0.3333, 1),  # shorter than the finished one: no effect
        ({"exactly": "1/3 us"}, 4001, "fail", 0.3337, 2),
        ({"min": "0.1 us"}, 900_000, "pass", 0.3333, 2),
    ],
)
def test_an_unfinished_wait_that_is_too_long_breaks_the_budget(limits, end, verdict, worst, count):
    of = limit("from edge SCL rise to edge SCL fall", **limits)
    feed(of.measure, records(ASKED))
    of.finish(end)
    v = of.verdict()
    assert (v.verdict, v.worst, v.count) == (verdict, worst, count)
    said = "'edge SCL rise' still waited for 'edge SCL fall' when the run ended"
    assert v.found == (said if count == 2 else "")


# Budgets of one scene, and budgets without a value --------------------------------------------------------------------

TEXT = "from edge SCL fall to edge SCL rise"


def alike(one: dict[str, str | int], other: dict[str, str | int]) -> tuple[BudgetJudge, BudgetJudge]:
    """Judges of two budgets of one scene on the same measure."""
    budgets = [Budget(name=name, measure=TEXT, **limits) for name, limits in (("a", one), ("b", other))]
    first, second = judges(budgets, Scope(wires=("SCL",)))
    return first, second


def test_budgets_on_the_same_events_share_a_measure_and_have_separate_verdicts():
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


def test_an_occurrence_cut_off_by_the_end_counts_once_for_budgets_on_the_same_events():
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
def test_budgets_with_another_measure_or_time_have_separate_measures(other):
    budget = Budget(**{"name": "b", "measure": TEXT, **other})
    first, second = judges([Budget(name="a", measure=TEXT, max="3 us"), budget], Scope(wires=("SCL",)))
    assert second.measure is not first.measure and second.own_measures == [second.measure]


def test_a_duration_that_was_never_measured_is_not_judged():
    v = limit("response", max="60 us").verdict()
    assert (v.verdict, v.worst, v.margin, v.count, v.at_s) == ("not judged", None, None, 0, None)


def test_a_fifo_that_never_received_a_word_is_not_judged():
    assert limit("fifo high-water", max=16).verdict().verdict == "not judged"


def test_a_count_of_zero_is_judged():
    v = limit("nacked", max=0).verdict()
    assert (v.verdict, v.worst, v.limit, v.margin, v.count, v.at_s) == ("pass", 0, 0, 0, 0, None)


def test_counts_are_judged_as_whole_numbers():
    of = limit("nacked", max=1)
    of.measure.happened(0, 3 * US, 0)
    assert of.verdict().verdict == "pass"
    of.measure.happened(0, 6_000_000 * US, 0)
    v = of.verdict()
    assert (v.verdict, v.worst, v.limit, v.margin, v.unit, v.at_s) == ("fail", 2, 1, -1, "count", 3e-06)


def test_a_minimum_of_a_count():
    of = limit("nacked", min=1)
    assert of.verdict().verdict == "fail"
    of.measure.happened(0, 0, 0)
    assert of.verdict().verdict == "pass"


def test_limits_between_two_ticks_are_rounded_to_the_nearest_tick():
    assert judged(limit("response", max="100.1 ns"), 0.1).verdict == "pass"
    assert limit("response", max="1/6 ns").verdict().limit == 0.0003  # one tick of 1/3 ns, shown in us
