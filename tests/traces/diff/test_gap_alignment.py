"""Among equal transfers, time says which one is missing."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces.diff.event_names import Group
from tests.traces.diff.runs import diffed, group


def polls(count: int, period: int = 1000, jitter: list[int] | None = None) -> list[Group]:
    """A polling loop: the same transfer for ever."""
    moved = jitter or [0] * count
    return [
        group(f"START {at}, address 53 R {at + 10}, NACK {at + 90}, STOP {at + 95}")
        for at in (500 + period * number + moved[number] for number in range(count))
    ]


@pytest.mark.parametrize("gone", [1, 2, 7, 18, 19])
def test_the_missing_poll_is_the_one_whose_time_is_free(gone):
    a = polls(20)
    b = a[:gone] + a[gone + 1 :]
    found = diffed(a, b)
    assert [entry.a for entry in found.missing] == a[gone]
    assert not found.late and not found.change_points
    back = diffed(b, a)
    assert [entry.b for entry in back.inserted] == a[gone] and not back.late


def test_a_missing_first_poll_is_known_only_if_something_else_came_before():
    first = group("START 0, address 1E W 10, NACK 90, STOP 95")
    a = [first, *polls(5)]
    b = [first, *polls(5)[1:]]
    assert [entry.a for entry in diffed(a, b).missing] == a[1]


@given(st.integers(1, 28), st.lists(st.integers(-1, 1), min_size=30, max_size=30))
def test_sampling_jitter_does_not_matter(gone, jitter):
    a, b = polls(30), polls(30, jitter=jitter)
    found = diffed(a, b[:gone] + b[gone + 1 :])
    assert [entry.a for entry in found.missing] == a[gone] and not found.late


def test_an_added_poll_that_takes_its_time_moves_what_is_behind_it():
    """The loop makes one more round between two other transfers."""
    other = "START {0}, address 68 R {0}, ACK {0}, STOP {0}"
    a = [group(other.format(0)), *polls(4), group(other.format(4500))]
    b = [group(other.format(0)), *polls(5), group(other.format(5500))]
    found = diffed(a, b)
    assert [entry.b for entry in found.inserted] == b[5]
    assert [point.step for point in found.change_points] == [1000]


def test_where_both_explain_it_the_one_without_lateness_is_taken():
    """A capture that began a poll later: the first is missing, nothing is late."""
    other = group("START 3500, address 68 R 3510, ACK 3590, STOP 3595")
    a = [*polls(3), other]
    found = diffed(a, a[1:])
    assert [entry.a for entry in found.missing] == a[0] and found.offset == 0 and not found.late


def test_two_polls_missing_at_two_places():
    a = polls(40)
    b = [poll for number, poll in enumerate(a) if number not in (11, 30)]
    found = diffed(a, b)
    assert [entry.a for entry in found.missing] == a[11] + a[30] and not found.late
