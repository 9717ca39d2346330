"""Comparison of two event lists: the first difference of each kind, and its effect on later events."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.replay.report import Comparison, Divergence, Happened, compare


def happened(text: str, late: int = 0) -> list[Happened]:
    """Return events at 0, 1/2, 1 ... seconds from words; `_` in a word is a blank."""
    return [Happened(word.replace("_", " "), Fraction(place + late, 2)) for place, word in enumerate(text.split())]


def test_equal_words_agree_whatever_their_times():
    assert compare(happened("START ACK STOP"), happened("START ACK STOP", late=3)) == Comparison(
        3, None, Fraction(3, 2)
    )
    assert compare([], []) == Comparison(0, None, Fraction(0))


def test_the_first_difference_has_both_times():
    first = Divergence(1, "ACK", "NACK", 0.5, 1.0, "ACK")
    outcome = compare(happened("START ACK STOP"), happened("START NACK STOP", late=1))
    assert outcome == Comparison(2, first, Fraction(1, 2), (first,))


def test_a_list_that_ends_early_is_a_difference():
    assert compare(happened("START ACK"), happened("START")).divergence == Divergence(
        1, "ACK", "nothing more", 0.5, None
    )
    assert compare(happened("START"), happened("START ACK")).divergence == Divergence(
        1, "nothing more", "ACK", None, 0.5
    )


@pytest.mark.parametrize(
    ("expected", "found", "ranked"),
    [
        # a wrong ACK and a wrong byte are paired with the right ones; the ACK is first, so it may be the cause
        ("START data_1 ACK data_2 ACK", "START data_1 NACK data_3 NACK", "ACK:2 byte:3"),
        ("START data_1 ACK data_2 ACK", "START data_9 ACK data_9 ACK", "byte:1"),
        # a STOP that should not be there ends the comparison
        ("START data_1 ACK data_2 ACK", "START data_1 STOP START data_3", "event:2"),
        ("START data_1 ACK data_2 ACK", "START data_9 STOP START data_3", "byte:1 event:2"),
        ("START ACK", "START cut_off_after_01", "event:1"),
        ("START data_1 ACK", "START cut_off_after_01 NACK", "event:1"),
        ("START data_1 ACK", "START STOP NACK", "event:1"),
    ],
)
def test_the_first_differences_of_each_kind_are_in_order_of_time(expected: str, found: str, ranked: str):
    outcome = compare(happened(expected), happened(found))
    assert " ".join(f"{part.kind}:{part.index}" for part in outcome.ranked) == ranked
    assert outcome.divergence is not None
    assert outcome.divergence.index == min(part.index for part in outcome.ranked)


@pytest.mark.parametrize(
    ("expected", "found", "agreed"),
    [
        ("START data_1 ACK data_2 ACK", "START data_9 ACK data_2 ACK", 4),
        ("START data_1 ACK data_2 ACK STOP", "START data_1 ACK STOP", 4),
        ("START ACK STOP START ACK STOP", "START NACK STOP START ACK STOP", 5),
        ("START data_1 ACK", "START data_1 ACK STOP START", 3),
        ("START", "STOP", 0),
    ],
)
def test_events_that_agree_are_counted_also_after_the_first_difference(expected, found, agreed):
    assert compare(happened(expected), happened(found)).agreed == agreed


def test_a_time_above_the_tolerance_is_ranked_last_and_is_not_the_first_divergence():
    expected, found = happened("START data_1 ACK"), happened("START data_2 ACK")
    found[2] = Happened("ACK", Fraction(11, 10))
    assert [part.kind for part in compare(expected, found, Fraction(1, 10)).ranked] == ["byte"]
    byte, timing = compare(expected, found, Fraction(1, 11)).ranked
    assert (byte.kind, byte.index) == ("byte", 1)
    assert timing == Divergence(2, "ACK", "ACK 100000.000 us later", 1.0, 1.1, "timing")
    assert compare(expected, expected[:2] + found[2:], Fraction(1, 11)).divergence is None


@pytest.mark.parametrize(
    ("off", "found"),
    [
        (Fraction(1, 10), None),
        (Fraction(-1, 10), None),
        (Fraction(11, 100), "ACK 110000.000 us later"),
        (Fraction(-11, 100), "ACK 110000.000 us earlier"),
    ],
)
def test_a_time_may_differ_by_up_to_the_tolerance_in_both_directions(off: Fraction, found: str | None):
    expected = happened("START ACK STOP")
    events = [expected[0], Happened("ACK", Fraction(1, 2) + off), Happened("STOP", 1 + 2 * off)]
    outcome = compare(expected, events, Fraction(1, 10))
    assert outcome.lag == 2 * abs(off)
    (timing,) = compare(expected[:2], events[:2], Fraction(1, 10)).ranked or (None,)
    assert (timing and timing.found) == found


def test_the_lag_is_that_of_events_before_the_first_that_differs():
    expected, found = happened("START data_1 ACK"), happened("START data_2 ACK")
    found[0], found[2] = Happened("START", Fraction(1, 100)), Happened("ACK", Fraction(9))
    assert compare(expected, found).lag == Fraction(1, 100)
