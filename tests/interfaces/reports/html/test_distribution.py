"""Distributions: every value is in exactly one bin, and quantiles equal those of numpy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.interfaces.reports.html.distribution import MOST, PAPER, Plot, distribution, plot
from periph_sim.timing.budgets import Values

PER_NS = 3
TICKS = st.lists(st.integers(-(10**13), 10**13), min_size=1, max_size=60)


def values(numbers: list[int], unit: str = "time", **limits: int) -> Values:
    data = np.array(numbers, np.int64)
    return Values(unit, data, np.arange(len(data), dtype=np.int64), limits)


@given(TICKS)
def test_each_value_is_in_the_bin_with_its_range(numbers: list[int]) -> None:
    found = distribution(values(numbers), PER_NS)
    size = {"ns": 1, "us": 10**3, "ms": 10**6, "s": 10**9}[found.unit] * PER_NS
    assert found.count == len(numbers)
    assert len(found.bins) <= MOST + 1
    for one in found.bins:
        begin, end = round(one.begin * size), round(one.end * size)
        assert sum(begin <= number < end for number in numbers) == one.count > 0
    assert found.least == min(numbers) / size and found.worst == max(numbers) / size


@given(TICKS)
def test_quantiles_are_measured_values_of_nearest_rank(numbers: list[int]) -> None:
    found = dict(distribution(values(numbers, "words"), 1).quantiles)
    wanted = np.percentile(numbers, [50, 95, 99], method="inverted_cdf")
    assert list(found.values()) == wanted.tolist()


@pytest.mark.parametrize(
    ("ticks", "unit", "worst"),
    [
        (2997, "ns", 999.0),
        (3000, "us", 1.0),
        (2_999_997, "us", 999.999),
        (3_000_000, "ms", 1.0),
        (10**13, "s", 10**13 / 3e9),
    ],
)
def test_the_unit_suits_the_largest_value(ticks: int, unit: str, worst: float) -> None:
    found = distribution(values([0, ticks]), PER_NS)
    assert (found.unit, found.worst) == (unit, pytest.approx(worst))


def test_each_of_few_counts_has_a_bin() -> None:
    found = distribution(values([0, 1, 1, 12], "words", max=13), PER_NS)
    assert [(one.begin, one.end, one.count) for one in found.bins] == [(0, 1, 1), (1, 2, 2), (12, 13, 1)]
    assert found.counted and found.unit == "words" and found.limits == (("max", 13),)


def test_bins_of_times_begin_at_whole_multiples_of_a_round_width() -> None:
    found = distribution(values([15_003, 45_001, 75_700]), PER_NS)  # 5.001 to 25.23 us
    width = found.bins[0].end - found.bins[0].begin
    assert width == pytest.approx(0.5)
    assert [one.begin / width for one in found.bins] == pytest.approx([10, 30, 50])


def test_deviations_are_shown_in_lsb_and_kept_in_millionths() -> None:
    found = distribution(values([0, 1_500_000, 5_823_750], "LSB", max=2_000_000), PER_NS)
    assert (found.unit, found.counted, found.least, found.worst) == ("LSB", False, 0, 5.82375)
    assert found.limits == (("max", 2.0),) and found.quantiles[0] == ("median", 1.5)
    assert found.bins[-1].begin <= 5.82375 < found.bins[-1].end


US = 3000


def plotted(numbers: list[int], unit: str = "time", **limits: int) -> Plot:
    data = np.array(numbers, np.int64)
    return plot(distribution(Values(unit, data, data, limits), 3))


@given(
    st.lists(st.integers(-(10**12), 10**12), min_size=1, max_size=40),
    st.lists(st.integers(-(10**12), 10**12), min_size=1, max_size=4),
    st.sampled_from(["time", "words"]),
)
def test_all_bars_and_marks_are_inside_of_the_plot_and_in_order(
    numbers: list[int], limits: list[int], unit: str
) -> None:
    found = plotted(numbers, unit, **{f"p{n}": limit for n, limit in enumerate(limits)})
    for bar in found.bars:
        assert PAPER["left"] <= bar.x and bar.x + bar.width <= PAPER["right"] + 1
        assert PAPER["top"] <= bar.y and abs(bar.y + bar.height - PAPER["bottom"]) < 0.02
    places = [bar.x for bar in found.bars]
    assert places == sorted(places)
    for rule in (*found.limits, found.worst):
        assert PAPER["left"] <= rule.x <= PAPER["right"]
    texts = [x for x, _ in found.across]
    assert texts == sorted(texts) and len(texts) >= 1


@given(st.lists(st.integers(0, 10**7), min_size=1, max_size=40), st.integers(0, 10**7))
def test_a_value_above_its_limit_is_drawn_to_the_right_of_it(numbers: list[int], limit: int) -> None:
    found = plotted(numbers, max=limit)
    (rule,) = found.limits
    if max(numbers) > limit:
        assert found.worst.x >= rule.x
    elif max(numbers) < limit:
        assert found.worst.x <= rule.x


def test_a_bar_is_at_its_value_on_the_axis() -> None:
    found = plotted([5 * US, 25 * US, 45 * US], max=50 * US)
    axis = {text: x for x, text in found.across}
    assert list(axis) == ["10", "20", "30", "40", "50"]
    assert abs(found.worst.x - (axis["40"] + axis["50"]) / 2) < 0.02
    assert found.limits[0].x == axis["50"] and found.limits[0].text == "max 50 us"
    assert found.breaks == ()


def test_a_distant_limit_is_drawn_after_a_break_of_the_axis() -> None:
    found = plotted([5 * US, 6 * US], max=60 * US)
    assert len(found.breaks) == 1
    assert found.bars[-1].x < found.breaks[0] < found.limits[0].x
    below = plotted([50 * US, 51 * US], min=1 * US)
    assert below.limits[0].x < below.breaks[0] < below.bars[0].x


def test_one_value_in_ten_thousand_is_visible() -> None:
    found = plotted([5 * US] * 10_000 + [45 * US])
    assert found.bars[-1].height > 10
    assert [bar.says for bar in found.bars] == ["5 to 6 us: 10000 values", "45 to 46 us: 1 value"]


def test_equal_values_are_one_narrow_bar() -> None:
    found = plotted([5 * US] * 3)
    assert len(found.bars) == 1 and found.bars[0].width < 30
    assert found.summary == "3 values, all 5 us"


def test_labels_of_close_limits_are_one_above_the_other() -> None:
    found = plotted([n * US for n in range(10, 100)], p95=60 * US, p99=62 * US, max=90 * US)
    assert [(rule.text, rule.row) for rule in found.limits] == [("p95 60 us", 0), ("p99 62 us", 1), ("max 90 us", 0)]


def test_a_count_is_in_the_middle_of_its_bar() -> None:
    found = plotted([10, 11, 12], "words", max=13)
    middle = found.bars[-1].x + (found.bars[-1].width + 0.6) / 2
    assert abs(found.worst.x - middle) < 0.1
    assert found.bars[-1].says == "12 words: 1 value"
