"""The first difference of two event lists."""

from __future__ import annotations

from fractions import Fraction

from periph_sim.replay.compare import Comparison, Divergence, Happened, compare


def happened(text: str, late: int = 0) -> list[Happened]:
    return [Happened(word, Fraction(place + late, 2)) for place, word in enumerate(text.split())]


def test_equal_words_agree_whatever_their_times():
    assert compare(happened("START ACK STOP"), happened("START ACK STOP", late=3)) == Comparison(
        3, None, Fraction(3, 2)
    )
    assert compare([], []) == Comparison(0, None, Fraction(0))


def test_the_first_difference_is_told_with_both_times():
    outcome = compare(happened("START ACK STOP"), happened("START NACK STOP", late=1))
    assert outcome == Comparison(1, Divergence(1, "ACK", "NACK", 0.5, 1.0), Fraction(1, 2))


def test_a_list_that_ends_early_is_a_difference():
    assert compare(happened("START ACK"), happened("START")).divergence == Divergence(
        1, "ACK", "nothing more", 0.5, None
    )
    assert compare(happened("START"), happened("START ACK")).divergence == Divergence(
        1, "nothing more", "ACK", None, 0.5
    )
