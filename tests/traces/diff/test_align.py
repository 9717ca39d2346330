"""Alignment of two sequences: common runs of letters, and of transfers in a polling loop."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces.diff import align as module
from periph_sim.traces.diff.align import Run, align
from periph_sim.traces.diff.matching import Group
from tests.traces.diff.runs import diffed, group

LETTERS = st.text(alphabet="abc", max_size=30)


def aligned(a: str, b: str) -> tuple[str, str]:
    """Both texts with one column per pair, and `.` where one of them has no letter."""
    top, bottom = "", ""
    at_a = at_b = 0
    for run in [*align([*map(ord, a)], [*map(ord, b)]), Run(len(a), len(b), 0)]:
        top += a[at_a : run.a] + "." * (run.b - at_b) + a[run.a : run.a + run.length]
        bottom += "." * (run.a - at_a) + b[at_b : run.b] + b[run.b : run.b + run.length]
        at_a, at_b = run.a + run.length, run.b + run.length
    return top, bottom


def longest_common(a: str, b: str) -> int:
    """Length of the longest common subsequence, by the simple quadratic algorithm."""
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
def test_common_runs_are_aligned(a, b, top, bottom):
    assert aligned(a, b) == (top, bottom)


@given(LETTERS, LETTERS)
def test_runs_are_equal_in_order_and_of_maximal_length(a, b):
    runs = align([*map(ord, a)], [*map(ord, b)])
    assert all(a[run.a : run.a + run.length] == b[run.b : run.b + run.length] and run.length for run in runs)
    ends = [(run.a + run.length, run.b + run.length) for run in runs]
    assert all(end <= (run.a, run.b) and end[1] <= run.b for end, run in zip(ends, runs[1:], strict=False))
    assert sum(run.length for run in runs) == longest_common(a, b)


@given(LETTERS, LETTERS, st.integers(1, 4))
def test_with_a_limited_search_runs_are_equal_and_in_order(a, b, most):
    before, module.MOST_EDITS = module.MOST_EDITS, most
    try:
        top, bottom = aligned(a, b)
    finally:
        module.MOST_EDITS = before
    assert (top.replace(".", ""), bottom.replace(".", "")) == (a, b)
    assert all(one == other or "." in (one, other) for one, other in zip(top, bottom, strict=True))


def test_a_hundred_thousand_items_are_aligned_with_few_comparisons(monkeypatch):
    """A polling loop repeats itself. The test counts comparisons of whole arrays, not seconds."""
    counted = []
    same = module.equal_from_start
    monkeypatch.setattr(module, "equal_from_start", lambda a, b: counted.append(1) or same(a, b))
    b = [1, 2] * 50_000
    a = [9, *b[:30_000], *b[30_001:]]
    assert sum(run.length for run in align(a, b)) == len(b) - 1
    assert len(counted) < 50


def polls(count: int, period: int = 1000, jitter: list[int] | None = None) -> list[Group]:
    """A polling loop, which makes the same transfer `count` times."""
    moved = jitter or [0] * count
    return [
        group(f"START {at}, address 53 R {at + 10}, NACK {at + 90}, STOP {at + 95}")
        for at in (500 + period * number + moved[number] for number in range(count))
    ]


@pytest.mark.parametrize("gone", [1, 2, 7, 18, 19])
def test_the_missing_poll_is_the_one_whose_time_has_no_transfer(gone):
    a = polls(20)
    b = a[:gone] + a[gone + 1 :]
    found = diffed(a, b)
    assert [entry.a for entry in found.missing] == a[gone]
    assert not found.late and not found.change_points
    back = diffed(b, a)
    assert [entry.b for entry in back.inserted] == a[gone] and not back.late


def test_a_missing_first_poll_is_found_if_another_transfer_is_before_it():
    first = group("START 0, address 1E W 10, NACK 90, STOP 95")
    a = [first, *polls(5)]
    b = [first, *polls(5)[1:]]
    assert [entry.a for entry in diffed(a, b).missing] == a[1]


@given(st.integers(1, 28), st.lists(st.integers(-1, 1), min_size=30, max_size=30))
def test_the_missing_poll_is_found_in_spite_of_sampling_jitter(gone, jitter):
    a, b = polls(30), polls(30, jitter=jitter)
    found = diffed(a, b[:gone] + b[gone + 1 :])
    assert [entry.a for entry in found.missing] == a[gone] and not found.late


def test_an_added_poll_delays_the_transfers_after_it():
    """The loop has one more poll between two other transfers."""
    other = "START {0}, address 68 R {0}, ACK {0}, STOP {0}"
    a = [group(other.format(0)), *polls(4), group(other.format(4500))]
    b = [group(other.format(0)), *polls(5), group(other.format(5500))]
    found = diffed(a, b)
    assert [entry.b for entry in found.inserted] == b[5]
    assert [point.step for point in found.change_points] == [1000]


def test_a_missing_poll_is_preferred_to_a_delay_as_the_explanation():
    """The second capture began one poll later, so the first poll is missing and no transfer is late."""
    other = group("START 3500, address 68 R 3510, ACK 3590, STOP 3595")
    a = [*polls(3), other]
    found = diffed(a, a[1:])
    assert [entry.a for entry in found.missing] == a[0] and found.offset == 0 and not found.late


def test_two_missing_polls_are_found():
    a = polls(40)
    b = [poll for number, poll in enumerate(a) if number not in (11, 30)]
    found = diffed(a, b)
    assert [entry.a for entry in found.missing] == a[11] + a[30] and not found.late
