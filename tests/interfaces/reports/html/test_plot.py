"""Plots: bars, limits and marks lie on the paper, in the order of their values, and where the axis says."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.interfaces.reports.html.distribution import Plot, distribution, plot
from periph_sim.timing.values import Values

US = 3000


def plotted(numbers: list[int], unit: str = "time", **limits: int) -> Plot:
    data = np.array(numbers, np.int64)
    return plot(distribution(Values(unit, data, data, limits), 3))


@given(
    st.lists(st.integers(-(10**12), 10**12), min_size=1, max_size=40),
    st.lists(st.integers(-(10**12), 10**12), min_size=1, max_size=4),
    st.sampled_from(["time", "words"]),
)
def test_all_of_it_is_on_the_paper_and_in_order(numbers: list[int], limits: list[int], unit: str) -> None:
    found = plotted(numbers, unit, **{f"p{n}": limit for n, limit in enumerate(limits)})
    for bar in found.bars:
        assert found.left <= bar.x and bar.x + bar.width <= found.right + 1
        assert found.top <= bar.y and abs(bar.y + bar.height - found.bottom) < 0.02
    places = [bar.x for bar in found.bars]
    assert places == sorted(places)
    for rule in (*found.limits, found.worst):
        assert found.left <= rule.x <= found.right
    texts = [x for x, _ in found.across]
    assert texts == sorted(texts) and len(texts) >= 1


@given(st.lists(st.integers(0, 10**7), min_size=1, max_size=40), st.integers(0, 10**7))
def test_a_value_above_its_limit_is_drawn_behind_it(numbers: list[int], limit: int) -> None:
    found = plotted(numbers, max=limit)
    (rule,) = found.limits
    if max(numbers) > limit:
        assert found.worst.x >= rule.x
    elif max(numbers) < limit:
        assert found.worst.x <= rule.x


def test_a_bar_is_where_the_axis_says() -> None:
    found = plotted([5 * US, 25 * US, 45 * US], max=50 * US)
    axis = {text: x for x, text in found.across}
    assert list(axis) == ["10", "20", "30", "40", "50"]
    assert abs(found.worst.x - (axis["40"] + axis["50"]) / 2) < 0.02
    assert found.limits[0].x == axis["50"] and found.limits[0].text == "max 50 us"
    assert found.breaks == ()


def test_a_limit_far_away_stands_behind_a_break_of_the_axis() -> None:
    found = plotted([5 * US, 6 * US], max=60 * US)
    assert len(found.breaks) == 1
    assert found.bars[-1].x < found.breaks[0] < found.limits[0].x
    below = plotted([50 * US, 51 * US], min=1 * US)
    assert below.limits[0].x < below.breaks[0] < below.bars[0].x


def test_one_in_ten_thousand_is_seen() -> None:
    found = plotted([5 * US] * 10_000 + [45 * US])
    assert found.bars[-1].height > 10
    assert [bar.says for bar in found.bars] == ["5 to 6 us: 10000 values", "45 to 46 us: 1 value"]


def test_equal_values_are_a_bar_and_not_a_wall() -> None:
    found = plotted([5 * US] * 3)
    assert len(found.bars) == 1 and found.bars[0].width < 30
    assert found.summary == "3 values, all 5 us"


def test_limits_side_by_side_are_told_one_above_the_other() -> None:
    found = plotted([n * US for n in range(10, 100)], p95=60 * US, p99=62 * US, max=90 * US)
    assert [(rule.text, rule.row) for rule in found.limits] == [("p95 60 us", 0), ("p99 62 us", 1), ("max 90 us", 0)]


def test_a_count_stands_in_the_middle_of_its_bar() -> None:
    found = plotted([10, 11, 12], "words", max=13)
    middle = found.bars[-1].x + (found.bars[-1].width + 0.6) / 2
    assert abs(found.worst.x - middle) < 0.1
    assert found.bars[-1].says == "12 words: 1 value"
