"""Formatting of figures in tables and in sentences."""

from __future__ import annotations

import pytest

from periph_sim.timing.verdict import figure, in_words, instant, limit, simulated


@pytest.mark.parametrize(
    ("value", "unit", "column", "sentence"),
    [
        (5.0, "us", "5.000 us", "5.000 us"),
        (-999.9994, "us", "-999.999 us", "-999.999 us"),
        (22153.3333, "us", "22.153 ms", "22.153 ms"),
        (7, "count", "7", "7"),
        (12, "value", "12", "12"),
        (12, "words", "12", "12 words"),
        (3, "cycles", "3", "3 cycles"),
        (41.25, "%", "41.25 %", "41.25 %"),
        (1.6689, "%", "1.67 %", "1.67 %"),
        (5.82375, "LSB", "5.824 LSB", "5.824 LSB"),
    ],
)
def test_a_figure(value: float, unit: str, column: str, sentence: str):
    assert (figure(value, unit), in_words(value, unit)) == (column, sentence)


@pytest.mark.parametrize(
    ("which", "text"),
    [
        ("", "4 us"),
        ("max", "4 us"),
        ("min", "4 us"),
        ("exactly", "= 4 us"),
        ("p99", "p99 4 us"),
        ("p99_9", "p99.9 4 us"),
    ],
)
def test_a_limit_is_shown_with_its_kind(which: str, text: str):
    assert limit(4.0, "us", which) == text


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (3.4, "us", "3.4 us"),
        (17000.5, "us", "17.0005 ms"),
        (40_000.0, "us", "40 ms"),
        (0.0, "us", "0 us"),
        (40, "%", "40 %"),
        (12.5, "%", "12.5 %"),
        (100, "words", "100"),
        (0.25, "LSB", "0.25 LSB"),
    ],
)
def test_a_limit_has_no_trailing_zeros(value: float, unit: str, text: str):
    assert limit(value, unit, "max") == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0, "0 s"), (6.66667e-06, "6.667 us"), (0.0009999, "999.900 us"), (0.001, "0.001 s"), (1.25, "1.25 s")],
)
def test_the_length_of_a_run(seconds: float, text: str):
    assert simulated(seconds) == text


def test_a_missing_value_is_shown_as_a_dash():
    assert (figure(None, "us"), instant(None), instant(1.25)) == ("-", "-", "1.250000 s")
