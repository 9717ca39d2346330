"""Limits besides max and min: exactly, percentiles, parts of the time; which go together, and what still waits."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.timing.budget_plan import PER_MILLE, BadBudget
from periph_sim.timing.budget_schema import Budget
from periph_sim.timing.budgets import BudgetJudge
from periph_sim.timing.measures.registry import MEASURES
from tests.timing.events_by_hand import ONE, make, records, tell
from tests.timing.judges import judge, judged


def limit(measure: str, **limits: str | int) -> BudgetJudge:
    return judge(Budget(name="b", measure=measure, **limits), ONE)


@pytest.mark.parametrize(
    ("limits", "values", "verdict", "worst", "margin", "at_s", "which"),
    [
        ({"exactly": "250 us"}, (250.0, 250.0), "pass", 250.0, 0.0, 0.0, "exactly"),
        ({"exactly": "250 us"}, (250.0, 251.0, 249.5), "fail", 251.0, -1.0, 1.0, "exactly"),
        ({"exactly": "250 us"}, (250.0, 251.0, 248.0), "fail", 248.0, -2.0, 2.0, "exactly"),
        ({"exactly": "250 us"}, (249.0, 251.0), "fail", 251.0, -1.0, 1.0, "exactly"),  # of two as far off, the longer
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
    assert v.count == len(values)


@given(st.lists(st.integers(0, 50), min_size=1, max_size=60), st.sampled_from(list(PER_MILLE)))
def test_a_percentile_is_the_least_value_that_so_many_do_not_exceed(values: list[int], key: str):
    of = limit("response", **{key: "1 us"})
    for at, value in enumerate(values):
        of.measure.take(value, at)
    assert of.measure.tally is not None
    found, at = of.measure.tally.percentile(PER_MILLE[key])
    assert values[at] == found

    def enough(level: int) -> bool:
        return 1000 * sum(v <= level for v in values) >= PER_MILLE[key] * len(values)

    assert enough(found) and not enough(found - 1)


def test_values_are_counted_only_where_a_percentile_is_asked_for():
    plain, counted = limit("response", max="1 us"), limit("response", p99="1 us")
    assert (plain.measure.tally is None, counted.measure.tally is None) == (True, False)
    assert plain.measure.kept is counted.measure.kept is None


def test_memory_of_a_percentile_grows_with_different_values_only():
    of = limit("response", p50="10 us").measure
    for at in range(10_000):
        of.take(at % 7, at)
    assert of.tally is not None and len(of.tally) == 7
    assert of.tally.percentile(500) == (3, 3)


def test_two_percentiles_may_have_the_same_limit():
    """Half of the values say less then, and are counted all the same."""
    of = limit("response", p50="11 us", p99="11 us")
    assert judged(of, 10.0, 11.0).passed


@pytest.mark.parametrize("name", [n for n in MEASURES if not make(n).series])
def test_one_number_a_run_has_no_percentiles(name: str):
    with pytest.raises(BadBudget, match="is one number a run and has no percentiles; write max") as caught:
        limit(name, p99=1)
    assert caught.value.place[-1] == "p99"


def test_a_part_of_the_time_is_judged_and_shown_in_percent():
    of = limit("bus load", max="40 %", min="12.5%")
    tell(of.measure, records("0 bus c START 0\n13 bus c STOP 0"))
    of.measure.finish(100)
    v = of.verdict()
    assert (v.unit, v.worst, v.limit, v.margin, v.verdict, v.which) == ("%", 13.0, 12.5, 0.5, "pass", "min")


@pytest.mark.parametrize(
    ("measure", "limits", "key", "sentence"),
    [
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
def test_limits_that_contradict_each_other_or_their_measure_are_refused(measure, limits, key, sentence):
    with pytest.raises(BadBudget) as caught:
        limit(measure, **limits)
    assert caught.value.place[-1] == key
    assert str(caught.value).startswith(sentence)


def test_an_event_that_never_matched_is_not_judged_and_says_so():
    v = limit("from edge SCL rise to edge SCL fall", max="1 us").verdict()
    assert (v.verdict, v.worst, v.margin, v.count) == ("not judged", None, None, 0)
    assert v.found == "no event matched 'edge SCL rise' and 'edge SCL fall'"


def test_a_count_of_nothing_is_a_value_but_of_a_name_that_is_free_text():
    assert limit("count of note duty", max=0).verdict().verdict == "pass"
    v = limit("count of span modle begin", max=5).verdict()
    assert (v.verdict, v.found) == ("not judged", "no event matched 'span modle begin'; the run had no span")


ASKED = "1000 edge SCL level 1\n2000 edge SCL level 0\n3000 edge SCL level 1"


@pytest.mark.parametrize(
    ("limits", "end", "verdict", "worst", "count"),
    [
        ({"max": "1 us"}, 6001, "fail", 1.0003, 2),  # 3001 ticks, and the edge may never come
        ({"max": "1 us"}, 6000, "pass", 1.0, 2),  # it could come now
        ({"max": "1 us"}, 3999, "pass", 0.3333, 1),  # less than the one that came: it says nothing
        ({"exactly": "1/3 us"}, 4001, "fail", 0.3337, 2),
        ({"min": "0.1 us"}, 900_000, "pass", 0.3333, 2),
    ],
)
def test_what_still_waits_at_the_end_and_has_waited_too_long_is_broken(limits, end, verdict, worst, count):
    of = limit("from edge SCL rise to edge SCL fall", **limits)
    tell(of.measure, records(ASKED))
    of.finish(end)
    v = of.verdict()
    assert (v.verdict, v.worst, v.count) == (verdict, worst, count)
    said = "'edge SCL rise' still waited for 'edge SCL fall' when the run ended"
    assert v.found == (said if count == 2 else "")
