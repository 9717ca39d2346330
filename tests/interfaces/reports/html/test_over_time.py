"""Values over the run: how they are thinned out, which are always kept, and where they are drawn."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.interfaces.reports.html.over_time import COLUMNS, MOST, SHOWN, shown_violations, time_plot
from tests.interfaces.reports.html.made import US, run_of

MS = 1000 * US


def test_few_values_are_all_kept_at_their_instants() -> None:
    over = run_of([5, 7, 6], max=10)
    assert [(c.at, c.low, c.high) for c in over.columns] == [
        (MS, 5 * US, 5 * US),
        (2 * MS, 7 * US, 7 * US),
        (3 * MS, 6 * US, 6 * US),
    ]
    assert (over.count, over.violation_count, over.violations) == (3, 0, ())


@given(st.lists(st.integers(0, 50), min_size=1, max_size=600), st.integers(0, 50))
def test_thinning_out_keeps_the_extremes_and_all_violations(numbers: list[int], limit: int) -> None:
    over = run_of(numbers, max=limit)
    assert len(over.columns) <= COLUMNS
    assert (
        min(c.low for c in over.columns) == min(numbers) * US and max(c.high for c in over.columns) == max(numbers) * US
    )
    assert over.violation_count == sum(n > limit for n in numbers)
    assert list(over.violations) == [((i + 1) * MS, n * US) for i, n in enumerate(numbers) if n > limit][:MOST]


@pytest.mark.parametrize(
    ("limits", "which", "beyond"),
    [
        ({"max": 6}, "max", [7]),
        ({"min": 6}, "min", [5]),
        ({"exactly": 6}, "exactly", [5, 7]),
        ({"p50": 6}, "p50", []),  # some values may be above a percentile that holds
    ],
)
def test_violations_depend_on_the_key_of_the_limit(limits: dict[str, int], which: str, beyond: list[int]) -> None:
    assert [value // US for _, value in run_of([5, 7, 6], which=which, **limits).violations] == beyond


def test_waves_of_the_first_violations_and_of_the_worst_others_are_kept() -> None:
    over = run_of([11, 12, 13, 14, 90, 15, 80, 16, 17, 70, 18], max=10)
    kept = [value // US for _, value in shown_violations(over, worst_at=5 * MS)]  # 90 is the worst
    assert kept == [11, 12, 13, 15, 80, 70] and len(kept) == SHOWN
    assert shown_violations(run_of([5], max=10), 0) == ()


def test_values_and_limits_are_drawn_to_the_scale_of_the_axis() -> None:
    plot = time_plot(run_of([10, 20, 30], max=40), 1000 * MS)
    heights = {text: y for y, text in plot.up}
    assert list(heights) == ["0 us", "20 us", "40 us"] and heights["0 us"] == 100
    (limit,) = plot.lines
    assert (limit.text, limit.y) == ("max 40 us", heights["40 us"])
    assert plot.values.count("M") == 3 and plot.values.startswith("M10 ") and plot.broken == ""
    assert [text for _, text in plot.across] == ["0.00 s", "0.02 s", "0.04 s", "0.06 s", "0.08 s", "0.10 s"]
    assert [x for x, _ in plot.across] == [0, 20, 40, 60, 80, 100]


def test_many_violations_are_red_over_the_whole_run() -> None:
    over = run_of([5] * 500 + [11] * 2500, max=10)
    red = [float(part.split(" ")[0]) for part in time_plot(over, 1000 * MS).broken.split("M")[1:]]
    assert over.violation_count == 2500 and len(over.violations) == MOST
    assert len(red) > 0.8 * COLUMNS and red == sorted(red)


def test_a_distant_limit_is_stated_and_not_drawn() -> None:
    (limit,) = time_plot(run_of([5, 6], max=600), 1000 * MS).lines
    assert (limit.y, limit.above) == (None, True)
    (limit,) = time_plot(run_of([500, 501], which="min", min=1), 1000 * MS).lines
    assert (limit.y, limit.above) == (None, False)


def test_the_summary_counts_values_and_violations() -> None:
    assert time_plot(run_of([5, 6], max=5), 1000 * MS).summary == "2 values over the run, 1 beyond a limit"
    assert time_plot(run_of([5], max=5), 1000 * MS).summary == "1 value over the run, none beyond a limit"


@given(st.lists(st.integers(-50, 50), min_size=1, max_size=40), st.integers(-50, 50))
def test_everything_is_inside_of_the_plot(numbers: list[int], limit: int) -> None:
    plot = time_plot(run_of(numbers, max=limit), 1000 * MS)
    places = [y for y, _ in plot.up] + [line.y for line in plot.lines if line.y is not None]
    places += [float(part.split(" ")[1].split("v")[0]) for part in plot.values.split("M")[1:]]
    assert all(0 <= y <= 100 for y in places)
    assert plot.up
