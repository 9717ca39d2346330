"""Tables as text: widths of columns, and line breaks between words but not inside numbers."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.text_table import columns, paragraph, text_table, together

WORDS = st.lists(st.text("abcdef.:-", min_size=1, max_size=12), max_size=12).map(" ".join)


TABLES = {
    "it fits": (
        lambda: text_table(("budget", "seen"), [("response", "5 us"), ("age", "40.2 ms")], right=(1,)),
        [
            " budget       seen",
            " ─────────────────",
            " response     5 us",
            " age       40.2 ms",
        ],
    ),
    "titles are broken before cells": (
        lambda: text_table(("kind", "worst later"), [("repeated START", "+3 us")], right=(1,), width=22),
        [
            " kind            worst",
            "                 later",
            " ─────────────────────",
            " repeated START  +3 us",
        ],
    ),
    "a cell goes on below within its column": (
        lambda: text_table(("what", "count"), [("SDA fall of START", "7")], right=(1,), width=18),
        [
            " what        count",
            " ─────────────────",
            " SDA fall        7",
            " of START",
        ],
    ),
    "a column with nothing in it has no width": (
        lambda: text_table(("name", "", "count"), [("a", "", "3")], {2}),
        [
            " name    count",
            " ─────────────",
            " a           3",
        ],
    ),
    "names are broken last": (
        lambda: text_table(
            ("function", "calls", "begins at"),
            [("InitPeripheralClocks", "7", "DSP2833x_SysCtrl.c:235")],
            right=(1,),
            width=46,
            names=(0,),
        ),
        [
            " function              calls  begins at",
            " ─────────────────────────────────────────────",
            " InitPeripheralClocks      7  DSP2833x_SysCtrl",
            "                              .c:235",
        ],
    ),
    "a wide column sets off where a cell goes on": (
        lambda: columns([("#12", "a read of I2CSTR that saw XRDY\n  [recorded: in it]")], width=32),
        [
            "  #12  a read of I2CSTR that saw",
            "         XRDY",
            "         [recorded: in it]",
        ],
    ),
    "an empty column takes no room": (
        lambda: columns([("1", "", "a"), ("22", "", "b")], right=(0,)),
        ["   1  a", "  22  b"],
    ),
    "no rows are no lines": (lambda: columns([]), []),
    "no rows have titles": (lambda: text_table(("a",), []), [" a", " ─"]),
}


@pytest.mark.parametrize("case", TABLES)
def test_the_lines_of_a_table(case: str):
    table, lines = TABLES[case]
    assert table() == lines


def test_numbers_are_never_broken():
    rows = [("name", "12 345 678 us")]
    assert " 12 345 678 us" in text_table(("n", "t"), rows, right=(1,), width=10)[-1]


def test_a_place_in_brackets_is_not_broken():
    lines = paragraph(f"{'written ' * 8}{together('[imu_hil.py:112 (batch_read)]')}")
    assert lines[1] == "  [imu_hil.py:112 (batch_read)]"


@given(st.lists(st.tuples(WORDS, WORDS, st.integers(0, 10**9).map(str)), max_size=6))
def test_no_word_is_lost_and_no_line_is_longer_than_80(rows):
    lines = text_table(("one", "the other", "count"), rows, right=(2,))
    assert max(map(len, lines)) <= 80
    letters = "".join(lines[2:]).replace(" ", "")
    given_letters = "".join(part for row in rows for part in row).replace(" ", "")
    assert sorted(letters.replace("─", "")) == sorted(given_letters)
    assert all(row[2] in "\n".join(lines) for row in rows)
