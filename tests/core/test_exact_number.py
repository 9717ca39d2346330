"""Numbers in user input are parsed exactly, and texts that would take long to compute are refused at once."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.exact_number import MAX_EXPONENT, exact_number, short_time
from periph_sim.core.time import TimeError, seconds


@given(st.decimals(allow_nan=False, allow_infinity=False, places=9, min_value=-(10**20), max_value=10**20))
def test_decimals_are_exact(value):
    assert exact_number(f" {value} ") == Fraction(value)


@given(st.integers(-(10**12), 10**12), st.integers(-MAX_EXPONENT, MAX_EXPONENT))
def test_exponents_up_to_forty_are_exact(mantissa, exponent):
    assert exact_number(f"{mantissa}e{exponent}") == mantissa * Fraction(10) ** exponent


@given(st.integers(-(10**9), 10**9).filter(lambda exponent: abs(exponent) > MAX_EXPONENT), st.sampled_from("eE"))
def test_exponents_up_to_a_billion_are_refused(exponent, letter):
    with pytest.raises(ValueError, match="has an exponent beyond 40"):
        exact_number(f"1{letter}{exponent}")


@pytest.mark.parametrize(
    ("said", "texts"),
    [
        ("has an exponent beyond 40", ["1e0_0_9_9", "1e" + "9" * 5000, "1e-" + "9" * 5000]),
        ("has more than 40 digits", ["9" * 41, "9" * 5000, "0." + "1" * 5000, f"1/{'7' * 5000}"]),
        ("is not a number", ["", " ", "one", "1/0", "1e", "e5", "1 2", "nan", "inf", "0x10"]),
    ],
)
def test_other_texts_are_refused_in_a_short_sentence(said: str, texts: list[str]):
    for text in texts:
        with pytest.raises(ValueError, match=said) as error:
            exact_number(text)
        assert len(str(error.value)) < 120


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("50n s", "unit 'n s' is none of ns, us, ms, s, min, h, d; did you mean 50 ns?"),
        ("1.5u s", "unit 'u s' is none of ns, us, ms, s, min, h, d; did you mean 1.5 us?"),
        ("10 0ms", "unit '0ms' is none of ns, us, ms, s, min, h, d; did you mean 100 ms?"),
        ("3.e us", "'3.e' is not a number; write for instance 20"),
        ("2O ms", "'2O' is not a number; write 20"),
        ("l5 ms", "'l5' is not a number; write 15"),
        ("y ms", "'y' is not a number; write for instance 20"),
        ("1,5 ms", "'1,5' is not a number; write 1.5"),
        ("2o0 ms", "'2o0' is not a number; write 200"),
        ("1.2.3m s", "'1.2.3m' is not a number; write for instance 20"),
        ("5 ² ms", "unit '² ms' is none of ns, us, ms, s, min, h, d"),
    ],
)
def test_the_error_of_a_mistyped_time_suggests_the_correction(text, hint):
    with pytest.raises(TimeError) as error:
        seconds(text)
    assert str(error.value) == f"{text!r}: {hint}"


@pytest.mark.parametrize("text", ["1e999999999 s", "1e-99999999 s", "1e400s", "1/" + "3" * 60 + " s"])
def test_the_number_of_a_time_has_the_same_limits(text):
    with pytest.raises(TimeError, match=r"exponent beyond 40|more than 40 digits"):
        seconds(text)


@pytest.mark.parametrize("text", ["365251 d", "3.2e10 s", "-365251 d", "1e14 ms"])
def test_a_time_above_a_thousand_years_is_refused(text):
    with pytest.raises(TimeError, match="is longer than 365250 d, the longest time that can be given"):
        seconds(text)
    assert seconds("365250 d") == 365_250 * 86_400


def test_a_short_time_has_the_largest_unit_in_which_it_is_at_least_one():
    texts = [short_time(Fraction(ns)) for ns in (0, -999, 1000, 1_234_567, 10**9, 2 * 10**12)]
    assert texts == ["0 ns", "-999 ns", "1 us", "1.235 ms", "1 s", "2000 s"]
