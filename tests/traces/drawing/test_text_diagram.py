"""Timing diagrams as text, compared with drawings and with the levels that they show."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces.drawing.svg_diagram import Box, Lane, Mark, Tick
from periph_sim.traces.drawing.text_diagram import text_diagram

WINDOW = (0.0, 32e-6)
US = 1e-6


def drawn(*lanes: Lane, marks: tuple[Mark, ...] = (), window: tuple[float, float] = WINDOW, axis: str = "") -> str:
    """A diagram with 8 columns of names and 32 columns of one microsecond each."""
    return "\n".join(text_diagram(lanes, window, marks, axis, 40))


def wave(initial: int, *edges: float) -> Lane:
    """A lane whose level changes at each of these times, in microseconds."""
    return Lane("SCL", "", initial=initial, edges=tuple((at * US, 1 - (initial + n) % 2) for n, at in enumerate(edges)))


def picture(text: str) -> str:
    """Return a drawing of a test without its indentation and its first line."""
    return "\n".join(line.removeprefix("    |") for line in text.splitlines()[1:])


AXIS = """
    |        +····+····+····+····+····+····+·
    |        0    5    10   15   20   25   30
    |        us"""


@pytest.mark.parametrize(
    ("lane", "rows"),
    [
        (
            wave(1, 4, 8.5, 12),
            """
    |SCL     ────┐   ┌───┐
    |            └───┘   └───────────────────""",
        ),
        (
            wave(0, -9, -3, 2, 31),
            """
    |SCL       ┌────────────────────────────┐
    |        ──┘                            └""",
        ),
        (
            wave(1, 4.0, 4.4, 10.1, 10.3, 10.6),  # a pulse within a column, and three edges within another
            """
    |SCL     ────░─────░
    |            ░     ░─────────────────────""",
        ),
        (
            Lane(
                "SDA", "", boxes=(Box(0, 14 * US, "68 write"), Box(14 * US, 15 * US, "A"), Box(20 * US, 24 * US, "1D"))
            ),
            """
    |SDA     [- 68 write -]A     [1D]""",
        ),
        (
            Lane("SDA", "", boxes=(Box(0, 4 * US, "68 write"), Box(5 * US, 6 * US, "1D"), Box(30 * US, 99 * US, "P"))),
            """
    |SDA      68  |                        P""",
        ),
        (
            Lane("SDA", "", boxes=(Box(8 * US, 16 * US, "1D", True), Box(-9 * US, -1 * US, "early"))),
            """
    |SDA             [ 1D!  ]""",
        ),
        (
            Lane("flags", "", ticks=(Tick(3 * US, "41"), Tick(4 * US, "42"), Tick(10 * US, "43"), Tick(31 * US, "44"))),
            """
    |flags      ||42   |43                  |""",
        ),
    ],
)
def test_lanes(lane: Lane, rows: str) -> None:
    assert drawn(lane) == picture(rows + AXIS)


def test_marks_are_at_their_column_and_within_the_width() -> None:
    marks = (Mark(30 * US, "ends, 26 us later"), Mark(4 * US, "begins"), Mark(50 * US, "never"))
    assert drawn(wave(1, 4), marks=marks, axis="after START") == picture("""
    |            v begins
    |                    ends, 26 us later v
    |SCL     ────┐
    |            └───────────────────────────
    |        +····+····+····+····+····+····+·
    |        0    5    10   15   20   25   30
    |        us, after START""")


def test_longer_names_move_the_waves() -> None:
    lines = text_diagram([Lane("GPIO34_MODEL", "", initial=1)], WINDOW, width=40)
    assert lines[0] == "GPIO34_MODEL  " + "─" * 26


@pytest.mark.parametrize(
    ("lanes", "window", "width", "said"),
    [
        ((), (0.0, 1.0), 80, "a diagram of 0 lanes from 0.0 s to 1.0 s; expected a lane and a later end"),
        ((wave(1),), (1.0, 1.0), 80, "a diagram of 1 lanes from 1.0 s to 1.0 s; expected a lane and a later end"),
        ((wave(1),), (0.0, 1.0), 27, "a diagram 27 wide; expected 28 or more for these lanes"),
    ],
)
def test_invalid_diagrams_are_rejected(
    lanes: tuple[Lane, ...], window: tuple[float, float], width: int, said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        text_diagram(lanes, window, width=width)


@given(
    st.integers(0, 1),
    st.lists(st.floats(-5, 40), max_size=40).map(sorted),
    st.lists(st.tuples(st.floats(-5, 40), st.floats(0, 20), st.text("AB 1", max_size=9)), max_size=9),
    st.integers(28, 120),
)
def test_any_lanes_fit_into_the_width_and_end_at_the_last_level(
    initial: int, edges: list[float], boxes: list[tuple[float, float, str]], width: int
) -> None:
    lanes = [
        wave(initial, *edges),
        Lane("bytes", "", boxes=tuple(Box(at * US, (at + more) * US, text) for at, more, text in boxes)),
    ]
    marks = [Mark(at * US, text) for at, _, text in boxes]
    lines = text_diagram(lanes, WINDOW, marks, "on", width)
    assert all(len(line) <= width and line == line.rstrip() for line in lines)
    upper, lower = next((a, b) for a, b in pairwise(lines) if a.startswith("SCL"))
    last = [row.ljust(width)[width - 1] for row in (upper, lower)]
    final = (initial + sum(at < 32 for at in edges)) % 2
    assert last in {1: (["─", " "], ["┌", "┘"], ["░", "░"]), 0: ([" ", "─"], ["┐", "└"], ["░", "░"])}[final]
