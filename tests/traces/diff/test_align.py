"""Runs that two sequences have in common, drawn as letters."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces.diff import align as module
from periph_sim.traces.diff.align import Run, align

LETTERS = st.text(alphabet="abc", max_size=30)


def aligned(a: str, b: str) -> tuple[str, str]:
    """Both texts, one column a pair, `.` where one has nothing."""
    top, bottom = "", ""
    at_a = at_b = 0
    for run in [*align([*map(ord, a)], [*map(ord, b)]), Run(len(a), len(b), 0)]:
        top += a[at_a : run.a] + "." * (run.b - at_b) + a[run.a : run.a + run.length]
        bottom += "." * (run.a - at_a) + b[at_b : run.b] + b[run.b : run.b + run.length]
        at_a, at_b = run.a + run.length, run.b + run.length
    return top, bottom


def longest_common(a: str, b: str) -> int:
    """The plain quadratic way."""
    above = [0] * (len(b) + 1)
    for one in a:
        row = [0]
        for place, other in enumerate(b):
            row.append(above[place] + 1 if one == other else max(above[place + 1], row[-1]))
        above = row
    return above[-1]


@pytest.mark.parametrize(
    ("a", "b", "top", "bottom"),
    [
        ("", "", "", ""),
        ("abc", "abc", "abc", "abc"),
        ("abc", "", "abc", "..."),
        ("", "abc", "...", "abc"),
        ("abdef", "abcdef", "ab.def", "abcdef"),
        ("abcdef", "abdef", "abcdef", "ab.def"),
        ("abxdef", "abydef", "abx.def", "ab.ydef"),
        ("xab", "aby", "xab.", ".aby"),
    ],
)
def test_drawn(a, b, top, bottom):
    assert aligned(a, b) == (top, bottom)


@given(LETTERS, LETTERS)
def test_runs_are_equal_in_order_and_as_many_as_can_be(a, b):
    runs = align([*map(ord, a)], [*map(ord, b)])
    assert all(a[run.a : run.a + run.length] == b[run.b : run.b + run.length] and run.length for run in runs)
    ends = [(run.a + run.length, run.b + run.length) for run in runs]
    assert all(end <= (run.a, run.b) and end[1] <= run.b for end, run in zip(ends, runs[1:], strict=False))
    assert sum(run.length for run in runs) == longest_common(a, b)


@given(LETTERS, LETTERS, st.integers(1, 4))
def test_with_a_bound_on_the_search_runs_are_still_equal_and_in_order(a, b, most):
    before, module.MOST_EDITS = module.MOST_EDITS, most
    try:
        top, bottom = aligned(a, b)
    finally:
        module.MOST_EDITS = before
    assert (top.replace(".", ""), bottom.replace(".", "")) == (a, b)
    assert all(one == other or "." in (one, other) for one, other in zip(top, bottom, strict=True))


def test_a_hundred_thousand_equal_items_with_two_missing_are_no_matter(monkeypatch):
    """A polling loop repeats itself; what is counted is comparisons of whole arrays, not seconds."""
    counted = []
    same = module.equal_from_start
    monkeypatch.setattr(module, "equal_from_start", lambda a, b: counted.append(1) or same(a, b))
    b = [1, 2] * 50_000
    a = [9, *b[:30_000], *b[30_001:]]
    assert sum(run.length for run in align(a, b)) == len(b) - 1
    assert len(counted) < 50
