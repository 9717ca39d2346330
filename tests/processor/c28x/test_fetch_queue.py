"""Fetches of 64 bits in 6 cycles each, and reads of data that take turns with them, cycle by cycle.

units       0 |    1    |    2    |    3    |      4 when the first of its place is executed
cycle       5 6        11        17        23
"""

from __future__ import annotations

import pytest

from periph_sim.processor.c28x.pipeline import DEPTH, FetchQueue

WAITS = 5


def begun(depth: int = DEPTH) -> FetchQueue:
    """A jump to address 0, whose first instruction is executed in cycle 5."""
    queue = FetchQueue()
    queue.begin(0, 0, 2, WAITS, WAITS, depth)
    assert queue.wait(0, 0, 1) == 5
    return queue


def there(queue: FetchQueue, unit: int) -> int:
    """The cycle from which on an instruction of this unit can be executed, if all before it were by cycle 5."""
    return queue.wait(0, 4 * unit, 4 * unit + 1)


@pytest.mark.parametrize(("unit", "cycle"), [(1, 11), (2, 17), (3, 23)])
def test_units_come_one_behind_the_other(unit: int, cycle: int):
    assert there(begun(), unit) == cycle


@pytest.mark.parametrize(
    ("cycle", "waits", "unit", "later"),
    [
        (8, 3, 1, 11),  # waits for unit 1
        (8, 3, 2, 23),  # which unit 2 is fetched behind
        (10, 1, 2, 23),
        (11, 0, 2, 23),  # between the two
        (12, 5, 2, 17),  # waits for unit 2
        (12, 5, 3, 29),
        (23, 0, 3, 23),  # all that comes ahead is there
    ],
)
def test_a_read_waits_for_the_fetch_under_way_and_the_next_one_for_the_read(
    cycle: int, waits: int, unit: int, later: int
):
    queue = begun()
    assert queue.read(cycle, WAITS) == waits
    assert there(queue, unit) == later


def test_a_read_directly_behind_another_comes_before_the_next_fetch():
    queue = begun()
    assert (queue.read(8, WAITS), queue.read(17, WAITS)) == (3, 0)
    assert there(queue, 2) == 29


def test_a_fetch_that_waits_for_its_place_waits_for_the_read_too():
    """Unit 4 takes the place of unit 0, which is executed to cycle 31; the read is over in 36."""
    queue = begun()
    assert queue.read(30, WAITS) == 0
    assert queue.wait(31, 1, 4) == 0
    assert there(queue, 4) == 42


def test_with_half_the_places_the_third_unit_waits_for_the_first():
    queue = begun(DEPTH // 2)
    assert queue.wait(31, 1, 4) == 0
    assert there(queue, 1) == 11
    assert there(queue, 2) == 31 + 6
