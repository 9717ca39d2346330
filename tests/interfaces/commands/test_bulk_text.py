"""Columns of characters against Python's own formatting, and times against exact fractions."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.interfaces.commands.bulk_text import AT_ONCE, BLANK, NONE, Digits, Literal, Sparse, Words, text
from periph_sim.interfaces.commands.decoded_text import Clock

NUMBERS = st.lists(st.integers(0, 10**18) | st.integers(0, 20_000), min_size=1, max_size=30)


def lines(*columns: Digits | Literal | Words | Sparse, count: int) -> list[str]:
    return b"".join(text([*columns, Literal("\n")], count)).decode().splitlines()


@given(NUMBERS, st.integers(0, 12))
@settings(max_examples=80, deadline=None)
def test_numbers_are_formatted_as_python_formats_them(values: list[int], decimals: int):
    def written(value: int) -> str:
        digits = str(value).rjust(decimals + 1, "0")
        return f"{digits[:-decimals]}.{digits[-decimals:]}" if decimals else digits

    expected = [written(value) for value in values]
    widest = max(map(len, expected))
    given_values = np.array(values, np.int64)
    assert lines(Digits(given_values, decimals, NONE), count=len(values)) == expected
    assert lines(Digits(given_values, decimals, BLANK), count=len(values)) == [e.rjust(widest) for e in expected]
    assert lines(Digits(given_values, decimals, BLANK, 25), count=len(values)) == [e.rjust(25) for e in expected]


def test_the_word_of_a_code_is_computed_once():
    asked = []

    def word(code: int) -> str:
        asked.append(code)
        return "x" * code

    codes = np.arange(3 * AT_ONCE + 5) % 3
    assert lines(Literal("<"), Words(codes, word), Literal(">"), count=len(codes)) == [
        f"<{'x' * (n % 3)}>" for n in codes
    ]
    assert asked == [0, 1, 2]


def test_only_some_lines_have_a_sparse_column():
    where = np.array([1, AT_ONCE - 1, AT_ONCE, AT_ONCE + 2])
    heads = Sparse([Literal("#"), Digits(np.array([7, 8, 9, 10]), 0, NONE)], where)
    found = lines(heads, Literal("."), count=AT_ONCE + 3)
    assert {n: line for n, line in enumerate(found) if line != "."} == {
        1: "#7.",
        AT_ONCE - 1: "#8.",
        AT_ONCE: "#9.",
        AT_ONCE + 2: "#10.",
    }


@given(
    st.lists(st.integers(0, 10**13), min_size=1, max_size=5),
    st.sampled_from([1, 3, 1000, 9600, 500_000, 4_000_000, 24_000_000, 125_000_000, 10**9, 3 * 10**9, 10**12]),
)
@settings(max_examples=80, deadline=None)
def test_times_are_exact_or_rounded_and_never_too_large(positions: list[int], rate: int):
    clock = Clock.for_rate(Fraction(rate), max(positions) + 1)
    for position, units in zip(positions, clock.units(np.array(positions)).tolist(), strict=True):
        off = abs(Fraction(units, 10**clock.decimals) - Fraction(position, rate))
        exact = (Fraction(10**11, rate)).denominator == 1 and max(positions) < 10**11
        assert off == 0 if exact else off <= Fraction(1, 2 * 10**clock.decimals)


@pytest.mark.parametrize(("rate", "decimals"), [(1, 0), (4_000_000, 8), (500_000, 6), (24_000_000, 12), (10**9, 9)])
def test_times_have_as_many_decimals_as_the_sample_period(rate: int, decimals: int):
    assert Clock.for_rate(Fraction(rate)).decimals == decimals
