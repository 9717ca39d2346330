"""The base class of measures: worst, least, values that are left out, unfinished values, percentiles."""

from __future__ import annotations

import pytest

from periph_sim.core.time import NO_TIME
from periph_sim.timing.measures.measure import Measure, Tally
from periph_sim.timing.verdict import Verdict
from tests.timing.events_by_hand import feed, make, records


class Waits(Measure):
    """A measure with values that are not over."""

    def __init__(self, *waiting: tuple[int, int]) -> None:
        super().__init__()
        self._waiting = [*waiting]

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        return self._waiting

    def unfinished_text(self) -> str:
        return "it waits"


def took(measure: Measure, *values: tuple[int, int]) -> Measure:
    for value, at in values:
        measure.take(value, at)
    return measure


def state(of: Measure) -> tuple[int, int, int, int, int]:
    return of.worst, of.worst_at, of.least, of.least_at, of.count


def test_the_first_of_equal_values_is_the_worst_and_the_least():
    assert state(took(Measure(), (5, 10), (5, 20))) == (5, 10, 5, 10, 2)
    assert state(took(Measure(), (5, 10), (7, 20), (3, 30), (7, 40), (3, 50))) == (7, 20, 3, 30, 5)
    assert state(took(Measure(), (-5, 10))) == (-5, 10, -5, 10, 1)
    assert state(took(Measure(), (0, 10), (-1, 20))) == (0, 10, -1, 20, 2)


def test_values_before_not_before_are_left_out():
    of = Measure()
    of.not_before = 20
    assert state(took(of, (9, 19), (1, 20), (2, 21))) == (2, 21, 1, 20, 2)
    assert of.occasions is None and of.measured == 2


def test_occasions_are_counted_from_not_before():
    class Asked(Measure):
        asked = "reads"

    of = Asked()
    of.not_before = 20
    for at, number in ((19, 5), (20, 1), (30, 3), (40, -2)):
        of.occasion(at, number)
    assert of.occasions == 2
    assert Asked().occasions == 0


@pytest.mark.parametrize(
    ("values", "waiting", "said", "worst", "least", "count", "cut_off"),
    [
        ([(5, 10)], [(5, 90)], "", (5, 10), (5, 10), 1, 0),
        ([(5, 10)], [(6, 90)], "it waits", (6, 90), (5, 10), 2, 1),
        ([], [(0, 90)], "it waits", (0, 90), (0, 90), 1, 1),
        ([], [(-3, 90)], "it waits", (-3, 90), (-3, 90), 1, 1),
        ([(-9, 1)], [(-3, 90)], "it waits", (-3, 90), (-9, 1), 2, 1),
        ([(5, 10)], [(8, 80), (7, 90)], "it waits", (8, 80), (5, 10), 3, 2),
        ([(5, 10)], [(8, 19)], "", (5, 10), (5, 10), 1, 0),  # began before not_before
        ([(5, 10)], [], "", (5, 10), (5, 10), 1, 0),
    ],
)
def test_an_unfinished_value_counts_if_it_exceeds_all_finished_ones(
    values, waiting, said: str, worst, least, count: int, cut_off: int
):
    of = took(Waits(*waiting), *values)
    of.not_before = 20 if waiting == [(8, 19)] else NO_TIME
    assert of.close(99) == said
    assert ((of.worst, of.worst_at), (of.least, of.least_at)) == (worst, least)
    assert (of.count, of.cut_off) == (count, cut_off)


def test_restriction_to_some_of_the_kept_values():
    of = took(Measure(), (1, 1))
    assert of.kept is None
    of = Measure()
    of.keep()
    of.occasions = 9
    took(of, (4, 10), (9, 20), (2, 30))
    of.cut_off = 1
    of.only(of.all_kept()[1] > 10)
    assert state(of)[:2] == (9, 20) and (of.count, of.cut_off, of.occasions) == (2, 0, None)
    assert [column.tolist() for column in of.all_kept()] == [[9, 2], [20, 30]]
    assert of.tally is None
    of.tally = Tally()
    of.only(of.all_kept()[1] > 20)
    assert of.tally.percentile(1000) == (2, 30)


def test_all_values_that_count_are_kept():
    of = Waits((7, 40))
    of.not_before = 10
    of.keep()
    took(of, (1, 9), (2, 10), (2, 11))
    of.close(99)
    assert [column.tolist() for column in of.all_kept()] == [[2, 2, 7], [10, 11, 40]]


def test_a_count_is_one_number_with_the_time_of_the_first_event():
    of = make("nacked")
    assert not of.silent and not of.series and state(of) == (0, NO_TIME, 0, NO_TIME, 0)
    feed(of, records("\n".join(f"{at} transfer I2C refused 1" for at in (7, 9, 9, 9))))
    assert state(of) == (4, 7, 4, 7, 4)


# Verdicts ---------------------------------------------------------------------------------------------------------


def verdict(word: str, **more: object) -> Verdict:
    return Verdict("b", "age", "us", 1, 2, 1, 5, word, 0.1, **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("of", "word", "passed", "broken"),
    [
        ("pass", "seen", True, False),
        ("fail", "broken", False, True),
        ("not judged", "not judged", False, False),
    ],
)
def test_the_word_of_a_verdict(of: str, word: str, passed: bool, broken: bool):
    made = verdict(of)
    assert (made.word, made.passed, made.broken) == (word, passed, broken)


@pytest.mark.parametrize(
    ("measured", "occasions", "counted"),
    [(0, None, "5"), (3, 3, "5"), (4, 3, "5"), (2, 3, "2 of 3"), (0, 1, "0 of 1"), (0, 0, "5")],
)
def test_a_verdict_shows_the_measured_part_of_the_occasions(measured: int, occasions: int | None, counted: str):
    assert verdict("pass", measured=measured, occasions=occasions).counted == counted
