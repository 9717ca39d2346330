"""Percentiles of more values than are counted one by one: near enough, never too small, in memory that has an end."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from periph_sim.timing.measures.tally import Tally

CELLS = 16


@given(
    st.lists(st.integers(-40, 40) | st.integers(-(10**6), 10**6), min_size=1, max_size=200),
    st.sampled_from([1, 500, 950, 990, 999, 1000]),
)
def test_a_percentile_is_a_value_that_was_measured_near_the_exact_one(values, per_mille: int):
    of = Tally(CELLS)
    for place, value in enumerate(values):
        of.add(value, 10 * place)
        assert len(of) <= CELLS
    exact = min(v for v in values if 1000 * sum(other <= v for other in values) >= per_mille * len(values))
    found, at = of.percentile(per_mille)
    assert at == 10 * values.index(found)
    width = 0 if len(set(values)) <= CELLS else 4 * (max(values) - min(values)) // CELLS
    assert exact <= found <= exact + width


def test_values_from_all_over_do_not_widen_the_cells_each_time():
    of = Tally(CELLS)
    for place in range(20 * CELLS):
        of.add(place, place)
    assert CELLS // 4 < len(of) <= CELLS
    assert of.percentile(500) == (191, 191)  # of 160 to 191
