"""Distributions: every value is in one bin, whatever the values are; what is told of them is what numpy tells."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.interfaces.reports.html.distribution import MOST, distribution
from periph_sim.timing.values import Values

PER_NS = 3
TICKS = st.lists(st.integers(-(10**13), 10**13), min_size=1, max_size=60)


def values(numbers: list[int], unit: str = "time", **limits: int) -> Values:
    data = np.array(numbers, np.int64)
    return Values(unit, data, np.arange(len(data), dtype=np.int64), limits)


@given(TICKS)
def test_each_value_is_in_the_bin_that_is_said_to_hold_it(numbers: list[int]) -> None:
    found = distribution(values(numbers), PER_NS)
    size = {"ns": 1, "us": 10**3, "ms": 10**6, "s": 10**9}[found.unit] * PER_NS
    assert found.count == len(numbers)
    assert len(found.bins) <= MOST + 1
    for one in found.bins:
        begin, end = round(one.begin * size), round(one.end * size)
        assert sum(begin <= number < end for number in numbers) == one.count > 0
    assert found.least == min(numbers) / size and found.worst == max(numbers) / size


@given(TICKS)
def test_quantiles_are_values_that_were_measured_by_nearest_rank(numbers: list[int]) -> None:
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


def test_counts_have_a_bin_each_where_there_are_few() -> None:
    found = distribution(values([0, 1, 1, 12], "words", max=13), PER_NS)
    assert [(one.begin, one.end, one.count) for one in found.bins] == [(0, 1, 1), (1, 2, 2), (12, 13, 1)]
    assert found.counted and found.unit == "words" and found.limits == (("max", 13),)


def test_bins_of_times_begin_at_whole_multiples_of_a_round_width() -> None:
    found = distribution(values([15_003, 45_001, 75_700]), PER_NS)  # 5.001 to 25.23 us
    width = found.bins[0].end - found.bins[0].begin
    assert width == pytest.approx(0.5)
    assert [one.begin / width for one in found.bins] == pytest.approx([10, 30, 50])


def test_deviations_are_told_in_lsb_and_kept_in_millionths() -> None:
    found = distribution(values([0, 1_500_000, 5_823_750], "LSB", max=2_000_000), PER_NS)
    assert (found.unit, found.counted, found.least, found.worst) == ("LSB", False, 0, 5.82375)
    assert found.limits == (("max", 2.0),) and found.quantiles[0] == ("median", 1.5)
    assert found.bins[-1].begin <= 5.82375 < found.bins[-1].end
