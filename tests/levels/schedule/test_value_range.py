"""Values that are known as fractions are those that are divided: the worst, the least and how many."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from periph_sim.levels.schedule.value_range import FAR, NO_VALUE, ValueRange


@given(st.lists(st.integers(-(10**9), 10**9), max_size=30), st.integers(1, 50), st.integers(0, 30), st.integers(0, 1))
def test_what_may_be_a_new_one_is_told_by_its_part(parts: list[int], den: int, takes: int, more: int):
    """takes, and one more at the most, is taken from each: what is not divided is neither worse nor less."""
    range_ = ValueRange()
    range_.den, range_.takes_least, range_.takes_most = den, takes, takes + more
    values = [-(-part // den) - takes - more * (part % 2) for part in parts]
    for part, value in zip(parts, values, strict=True):
        if part > range_.above or part <= range_.below:
            range_.take(value)
        else:
            range_.count += 1
    assert (range_.worst, range_.least, range_.count) == (
        max(values, default=NO_VALUE),
        min(values, default=FAR),
        len(values),
    )


def test_what_the_end_cuts_off_counts_where_it_is_more_and_is_no_least_value():
    range_ = ValueRange()
    range_.take_unfinished(5)
    assert (range_.worst, range_.least, range_.count) == (5, 5, 1)
    range_.take(9)
    range_.take_unfinished(8)
    assert (range_.worst, range_.least, range_.count) == (9, 5, 2)
    range_.take_unfinished(11)
    assert (range_.worst, range_.least, range_.count) == (11, 5, 3)
