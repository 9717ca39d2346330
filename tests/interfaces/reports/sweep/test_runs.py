"""The values of a key from one text: lists and exact ranges in the unit of the step."""

from __future__ import annotations

import pytest

from periph_sim.interfaces.reports.sweep.runs import values_of
from periph_sim.scene.case.model import BadCase


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("5", ["5"]),
        ("1, 2 ,5", ["1", "2", "5"]),
        ("100 kHz, 400 kHz", ["100 kHz", "400 kHz"]),
        ("228 us to 248 us, 3 us", ["228 us to 248 us", "3 us"]),  # a range of durations is a value of its own
        ('["a", "b"], ["b"]', ['["a", "b"]', '["b"]']),
        ("'a,b', \"c,d\"", ["'a,b'", '"c,d"']),
        ('{ x = "1,2", y = 3 }, z', ['{ x = "1,2", y = 3 }', "z"]),
        ("1 to 4 step 1", ["1", "2", "3", "4"]),
        ("0 to 7 step 3", ["0", "3", "6"]),
        ("-1 to 1 step 0.5", ["-1", "-0.5", "0", "0.5", "1"]),
        ("0 ms to 20 us step 10 us", ["0 us", "10 us", "20 us"]),
        ("1 ms to 1.002 ms step 1 us", ["1000 us", "1001 us", "1002 us"]),
        ("5 us to 6 us step 0.5us", ["5 us", "5.5 us", "6 us"]),
        ("100 kHz to 0.3 MHz step 100 kHz", ["100 kHz", "200 kHz", "300 kHz"]),
        ("0 % to 10 % step 5 %", ["0 %", "5 %", "10 %"]),
        ("3 to 3 step 1", ["3"]),
        ("-0.05 to -0.04 step 0.005", ["-0.05", "-0.045", "-0.04"]),
    ],
)
def test_a_text_is_split_into_values(text: str, values: list[str]) -> None:
    assert values_of("key", text) == values


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("1,,2", "--vary key=1,,2: a value is missing; write for instance key=1, 2, 5 or 0 to 10 step 2"),
        ("", "--vary key=: a value is missing"),
        ("0 ms to 1 ms step 5", "its units ms, ms and none do not match"),
        ("0 to 1 ms step 5 us", "its units none, ms and us do not match"),
        ("0 s to 1 h step 1 s", "its units s, h and s do not match"),
        ("0 to 10 step 0", "it has no values; the step must be above 0, the last above the first"),
        ("10 to 0 step 1", "it has no values"),
        ("a to 10 step 1", "'a' is not a number with a unit; write for instance 0 ms to 1 ms step 5 us"),
        ("0 s to 1 s step 1 ns", "it has 1000000001 values; give a larger step"),
    ],
)
def test_an_invalid_text_is_one_error_message(text: str, sentence: str) -> None:
    with pytest.raises(BadCase) as error:
        values_of("key", text)
    assert sentence in str(error.value) and "\n" not in str(error.value)
