"""Tolerances are times with a unit, or numbers of cycles."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.core.tolerance import Cycles, Tolerance, in_cycles, in_seconds, parse_tolerance

KNOWN = "ns, us, ms, s, min, h, d"


@pytest.mark.parametrize(
    ("text", "tolerance"),
    [
        ("3 us", Fraction(3, 1_000_000)),
        ("0s", Fraction(0)),
        ("20 cycles", Cycles(Fraction(20))),
        ("1 cycle", Cycles(Fraction(1))),
        (" 1/2cycles ", Cycles(Fraction(1, 2))),
    ],
)
def test_a_tolerance_is_a_time_or_a_number_of_cycles(text: str, tolerance: Tolerance):
    assert parse_tolerance(text) == tolerance


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("5", f"'5' has no unit; write for instance 5 ms ({KNOWN}) or 5 cycles"),
        ("", f"'' has no unit; write for instance 20 ms ({KNOWN}) or 20 cycles"),
        ("5 cyles", f"'5 cyles': unit 'cyles' is none of {KNOWN}, cycles; did you mean 5 cycles?"),
        ("5 msec", f"'5 msec': unit 'msec' is none of {KNOWN}, cycles; did you mean 5 ms?"),
        ("x", f"'x' is no length of time; write for instance 20 ms ({KNOWN}) or 20 cycles"),
        ("-5 µs", "'-5 µs' is negative; a duration is 0 or more"),
        ("-5 cycles", "-5 cycles is negative; a tolerance is 0 or more"),
        ("2O cycles", "'2O' is not a number; write 20"),
        ("2O ms", "'2O ms': '2O' is not a number; write 20"),
    ],
)
def test_the_error_of_a_wrong_tolerance_names_all_units(text: str, sentence: str):
    with pytest.raises(ValueError) as error:
        parse_tolerance(text)
    assert str(error.value) == sentence


def test_cycles_and_seconds_are_converted_by_the_frequency():
    second, ten = Fraction(1), Cycles(Fraction(10))
    assert (in_seconds(ten, Fraction(100)), in_seconds(second, Fraction(100))) == (Fraction(1, 10), 1)
    assert (in_cycles(ten, Fraction(100)), in_cycles(second, Fraction(100))) == (10, 100)
