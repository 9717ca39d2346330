"""Tables as text: widths, breaks between words, numbers that stay whole."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.text_table import columns, paragraph, text_table, together

WORDS = st.lists(st.text("abcdef.:-", min_size=1, max_size=12), max_size=12).map(" ".join)


def test_a_table_that_fits():
    assert text_table(("budget", "seen"), [("response", "5 us"), ("age", "40.2 ms")], right=(1,)) == [
        " budget       seen",
        " ─────────────────",
        " response     5 us",
        " age       40.2 ms",
    ]


def test_titles_are_broken_before_cells():
    assert text_table(("kind", "worst later"), [("repeated START", "+3 us")], right=(1,), width=22) == [
        " kind            worst",
        "                 later",
        " ─────────────────────",
        " repeated START  +3 us",
    ]


def test_a_cell_goes_on_below_within_its_column():
    assert text_table(("what", "count"), [("SDA fall of START", "7")], right=(1,), width=18) == [
        " what        count",
        " ─────────────────",
        " SDA fall        7",
        " of START",
    ]


def test_numbers_are_never_broken():
    rows = [("name", "12 345 678 us")]
    assert " 12 345 678 us" in text_table(("n", "t"), rows, right=(1,), width=10)[-1]


def test_a_wide_column_sets_off_where_a_cell_goes_on():
    assert columns([("#12", "a read of I2CSTR that saw XRDY\n  [recorded: in it]")], width=32) == [
        "  #12  a read of I2CSTR that saw",
        "         XRDY",
        "         [recorded: in it]",
    ]


def test_an_empty_column_takes_no_room():
    assert columns([("1", "", "a"), ("22", "", "b")], right=(0,)) == ["   1  a", "  22  b"]


def test_no_rows_are_no_lines():
    assert columns([]) == []
    assert text_table(("a",), []) == [" a", " ─"]


def test_a_place_in_brackets_is_not_broken():
    lines = paragraph(f"{'written ' * 8}{together('[imu_hil.py:112 (batch_read)]')}")
    assert lines[1] == "  [imu_hil.py:112 (batch_read)]"


@given(st.lists(st.tuples(WORDS, WORDS, st.integers(0, 10**9).map(str)), max_size=6))
def test_no_word_is_lost_and_no_line_is_longer_than_80(rows):
    lines = text_table(("one", "the other", "count"), rows, right=(2,))
    assert max(map(len, lines)) <= 80
    told = "".join(lines[2:]).replace(" ", "")
    given_letters = "".join(part for row in rows for part in row).replace(" ", "")
    assert sorted(told.replace("─", "")) == sorted(given_letters)
    assert all(row[2] in "\n".join(lines) for row in rows)


def test_a_column_with_nothing_in_it_has_no_width() -> None:
    assert text_table(("name", "", "count"), [("a", "", "3")], {2}) == [
        " name    count",
        " ─────────────",
        " a           3",
    ]


def test_names_are_broken_last():
    rows = [("InitPeripheralClocks", "7", "DSP2833x_SysCtrl.c:235")]
    assert text_table(("function", "calls", "begins at"), rows, right=(1,), width=46, names=(0,)) == [
        " function              calls  begins at",
        " ─────────────────────────────────────────────",
        " InitPeripheralClocks      7  DSP2833x_SysCtrl",
        "                              .c:235",
    ]
