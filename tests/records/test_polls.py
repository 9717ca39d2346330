"""Reconstruction of skipped polls: the length of a pass, gaps that can be filled, and those that cannot."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.records.races import PlaceRaces, distances, races
from tests.records.scenes import CYCLE, by_hand, flag, read
from tests.records.test_races import RRDY


def place(*rows: tuple[Any, ...], name: str = "f:1") -> PlaceRaces:
    return next(one for one in races(by_hand(*rows, end=1_000_000)).places if one.place == name)


def sides(of: PlaceRaces) -> tuple[int | None, int | None, int, int]:
    """Cycles before and after the nearest change, and the numbers of reconstructed polls and of unfilled waits."""
    return of.before and of.before.cycles, of.after and of.after.cycles, of.polls, of.unplaced


def wait(first: int, passes: int, change: int, at: int = 1000) -> PlaceRaces:
    """A wait: two recorded passes of `first` cycles, a change, and the read that saw it after `passes` passes."""
    return place(
        read(at), read(at + first), flag(at + change, "RRDY", 1), read(at + first * passes, RRDY), read(900_000)
    )


@pytest.mark.parametrize(("length", "filled"), [(3, False), (4, True), (5, True), (400, True), (401, False)])
def test_a_pass_takes_four_to_four_hundred_cycles(length: int, filled: bool):
    of = wait(length, 400, 20 * length + 1)
    assert not filled or sides(of)[:2] == (1, length - 1)
    assert (of.polls, of.unplaced) == ((2, 0) if filled else (0, 1))


@pytest.mark.parametrize(
    ("change", "before", "after", "polls"),
    [
        (21, 1, 9, 2),  # between the polls at 20 and 30
        (30, 10, 0, 2),  # the poll in the same cycle saw it
        (31, 1, 9, 2),
        (11, 1, 9, 1),  # the poll before the change is recorded
        (99, 9, 1, 1),  # the poll that saw the change is recorded
        (95, 5, 5, 1),
    ],
)
def test_the_polls_next_to_a_change_are_on_the_grid_of_the_passes(change: int, before: int, after: int, polls: int):
    assert sides(wait(10, 10, change)) == (before, after, polls, 0)


def test_a_change_before_the_first_or_after_the_last_read_is_in_no_wait():
    of = place(flag(5, "RRDY", 1), read(10), read(20), flag(700, "RRDY", 0))
    assert sides(of) == (680, 5, 0, 0)


def test_several_changes_in_one_wait_are_each_between_their_own_polls():
    of = place(read(0), read(10), flag(33, "RRDY", 1), flag(58, "RRDY", 0), read(100))
    assert (sides(of), of.histogram) == ((3, 2, 4, 0), (0, 4, 3, 0, 0, 0))


def test_a_poll_next_to_several_changes_counts_once_with_the_nearest():
    """
    period of 10       80    90           100   110
    flags in one tick        BB AAS SDIR        polls at 80 and 90: 2 polls
    a poll between           BB           AAS   polls at 80, 90 and 100
    """
    at_once = [flag(85, name, 1) for name in ("BB", "AAS", "SDIR")]
    of = place(read(0), read(10), *at_once, read(500))
    assert (sides(of), of.histogram) == ((5, 5, 2, 0), (0, 2, 2, 1, 0, 0))
    assert [of.tolist() for of in distances(by_hand(read(0), read(10), *at_once, read(500)))[:2]] == [
        [85, 75, 5, 5, 415],
        [0, 10 * CYCLE, 80 * CYCLE, 90 * CYCLE, 500 * CYCLE],
    ]
    of = place(read(0), read(10), flag(85, "BB", 1), flag(92, "AAS", 1), read(500))
    assert (sides(of), of.histogram) == ((2, 5, 3, 0), (0, 3, 2, 1, 0, 0))  # 5, 2 and 8 cycles


def test_the_nearest_change_of_a_poll_may_be_one_that_another_poll_is_next_to():
    """
    polls at 0, 7 of a pass of 20    40   47          60
    changes                          BB               AAS    47 is next to AAS only, but nearer to BB
    """
    reads = [read(at) for at in (0, 7, 20, 27)]
    of = distances(by_hand(*reads, flag(40, "BB", 1), flag(60, "AAS", 1), read(200), read(207)))
    polls = dict(zip((of[1] // CYCLE).tolist(), of[0].tolist(), strict=True))
    assert (polls[40], polls[47], polls[60]) == (0, 7, 0)


@pytest.mark.parametrize(("waits", "filled"), [(2, False), (3, True)])
def test_three_waits_with_one_recorded_pass_each_give_the_length_of_a_pass(waits: int, filled: bool):
    """Only the first and the last read of each wait are recorded, 600, 900 and 1500 cycles apart; a pass is 300."""
    rows: list[tuple[Any, ...]] = []
    at = 0
    for apart in (600, 900, 1500)[:waits]:
        rows += [read(at), flag(at + 301, "RRDY", 1), read(at + apart, RRDY)]
        at += apart + 5000
        rows.append((at - 1000, rows[0][1], "dsp", "W I2C-A.I2CCNT", 1, "g:1", 0))
    of = place(*rows)
    assert (of.unplaced, of.polls > 0) == ((0, True) if filled else (waits, False))


def test_two_reads_of_a_pass_keep_their_offsets():
    """Reads at 0 and 7 of each pass of 20."""
    of = place(read(0), read(7), read(20), read(27), flag(65, "RRDY", 1), read(200), read(207))
    assert sides(of) == (5, 2, 2, 0)  # polls at 60 and 67


def test_gaps_are_not_filled_if_the_passes_disagree():
    """If 3 of 4 distances are multiples of the pass of 10 cycles, these are too few. 4 of 5 are enough."""
    agree = [read(at) for at in (0, 10, 20, 27)]
    assert sides(place(*agree, flag(60, "RRDY", 1), read(97)))[2:] == (0, 1)
    more = [read(at) for at in (0, 10, 20, 30, 37)]
    assert sides(place(*more, flag(70, "RRDY", 1), read(107))) == (3, 7, 2, 0)


def test_an_unfilled_wait_with_several_changes_is_counted_once():
    of = place(*(read(at) for at in (0, 10, 20, 30)), flag(53, "RRDY", 1), flag(78, "RRDY", 0), read(121))
    assert (of.unplaced, of.polls) == (1, 0)


def test_reads_at_two_places_do_not_belong_to_one_wait():
    rows = [read(0), read(10), read(13, place="g:2"), flag(33, "RRDY", 1), read(100)]
    assert sides(place(*rows)) == (23, 67, 0, 0)
    assert sides(place(*rows, name="g:2")) == (20, None, 0, 0)


def test_distances_are_counted_by_decades():
    rows = [flag(100_000, "RRDY", 1), *(read(100_000 + away, place=f"p:{away}") for away in (
        0, 1, 9, 10, 99, 100, 999, 1000, 9999, 10_000, 99_999))]  # fmt: skip
    found = races(by_hand(*rows, end=1_000_000))
    decades = {of.place: of.histogram.index(1) for of in found.places}
    assert [*decades.values()] == [0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]
    assert [of.closest for of in found.places] == [0, 1, 9, 10, 99, 100, 999, 1000, 9999, 10_000, 99_999]


def test_the_first_of_equal_distances_is_reported_and_places_without_a_change_are_last():
    rows = [
        read(10, place="z:1"),
        flag(15, "RRDY", 1),
        read(90, place="a:1"),
        flag(95, "NACK", 1),
        read(99, place="z:1"),
    ]
    found = races(by_hand(read(1, 0, place="q:0"), *rows))
    assert [of.place for of in found.places] == ["z:1", "a:1", "q:0"]
    (z, a, _) = found.places
    assert z.before is not None and (z.before.cycles, z.before.field, z.before.tick) == (5, "RRDY", 200)
    assert z.after is not None and (z.after.cycles, z.after.field) == (4, "NACK")
    assert a.before is not None and (a.before.cycles, a.before.field) == (5, "NACK")
