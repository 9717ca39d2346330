"""Phrases of messages: counts with nouns, shortened texts, texts on one line."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.phrases import counted, one_line, shorten


def test_one_is_singular_and_all_others_are_plural():
    assert [counted(number, "I2C byte") for number in (0, 1, 2)] == ["0 I2C bytes", "1 I2C byte", "2 I2C bytes"]


@given(st.text(), st.integers(40, 300))
def test_a_shortened_text_is_not_longer_than_its_limit(text: str, most: int):
    short = shorten(text * 20, most)
    assert len(short) <= most
    assert short == text * 20 or short.endswith(f"({len(text * 20)} characters)")


def test_both_ends_of_a_shortened_text_are_kept():
    assert shorten("9" * 300) == "9" * 300
    short = shorten("begin" + "9" * 5000 + "end")
    assert short.startswith("begin999") and short.endswith("999end (5008 characters)") and " ... " in short


def test_one_line_shows_unprintable_characters_as_escapes():
    assert one_line("25 °C, 'so'") == "25 °C, 'so'"
    assert one_line("a\nb\x1b[2J\u2028c") == "a\\nb\\x1b[2J\\u2028c"
