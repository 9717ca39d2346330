"""Timing diagrams as SVG are parsed again: waves, boxes and marks are at the positions of their times."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces.drawing.svg_diagram import (
    BLUE,
    GUTTER,
    MARGIN,
    WIDTH,
    WRONG,
    Box,
    Lane,
    Mark,
    Tick,
    nice_step,
    timing_diagram,
)

INSIDE = WIDTH - GUTTER - MARGIN
US = 1e-6


def elements(svg: str, kind: str) -> list[ElementTree.Element]:
    root = ElementTree.fromstring(svg)
    return [element for element in root.iter() if element.tag.rpartition("}")[2] == kind]


def texts(svg: str) -> list[str]:
    return ["".join(element.itertext()) for element in elements(svg, "text")]


def wave(svg: str) -> str:
    """The levels of the only wave, `_` and `-`, with one character for a twentieth of the window."""
    (path,) = [element for element in elements(svg, "path") if "stroke-linejoin" in element.attrib]
    points = [(float(x), float(y)) for x, y in re.findall(r"([\d.]+),([\d.]+)", path.attrib["d"])]
    high = min(y for _, y in points)
    drawn = ""
    for place in range(20):
        x = GUTTER + (place + 0.5) / 20 * INSIDE
        y = next(before[1] for before, after in pairwise(points) if before[0] <= x <= after[0])
        drawn += "-" if y == high else "_"
    return drawn


@pytest.mark.parametrize(
    ("initial", "edges", "drawn"),
    [
        (1, ((5, 0), (10, 1), (15, 0)), "-----_____-----_____"),
        (0, ((10, 1),), "__________----------"),
        (1, ((-7, 0), (-3, 1), (10, 0)), "----------__________"),
        (0, ((-5, 1), (10, 0), (25, 1)), "----------__________"),
    ],
)
def test_a_wave_has_its_edges_at_their_times(initial, edges, drawn):
    """The window is 0 to 20 us. Earlier edges only set the level at its begin."""
    lane = Lane("SCL", "capture", BLUE, initial, tuple((at * US, level) for at, level in edges))
    assert wave(timing_diagram([lane], (0, 20 * US))) == drawn


def test_lanes_groups_and_boxes_have_their_texts():
    lanes = [
        Lane("bytes", "capture", BLUE, boxes=(Box(0, 9 * US, "50 read"), Box(9 * US, 10 * US, "too narrow a box"))),
        Lane("W I2CDXR", "firmware", ticks=(Tick(3 * US, "E4"), Tick(30 * US, "FF"))),
    ]
    shown = texts(timing_diagram(lanes, (0, 20 * US), title="a title", axis="0 is the START"))
    for text in ("a title", "capture", "bytes", "50 read", "firmware", "W I2CDXR", "E4", "us, 0 is the START"):
        assert text in shown
    assert not {"too narrow a box", "too", "FF"} & set(shown), "no room, or outside of the window"


def test_wrong_boxes_and_marks_are_drawn_as_wrong():
    boxes = (Box(0, 5 * US, "E4", wrong=True), Box(6 * US, 9 * US, "A"), Box(9.5 * US, 9.8 * US, "E6 not E7", True))
    lane = Lane("bytes", "replay", BLUE, boxes=boxes)
    svg = timing_diagram([lane], (0, 10 * US), [Mark(2 * US, "expected E5", wrong=True), Mark(7 * US, "agreed")])
    strokes = [element.attrib.get("stroke") for element in elements(svg, "rect")]
    assert strokes.count(WRONG) == 2 and strokes.count(BLUE) == 1
    lines = [element.attrib for element in elements(svg, "path") if "stroke-dasharray" in element.attrib]
    assert len(lines) == 1, "only the mark that is not wrong is dashed"
    assert {"expected E5", "agreed", "E6"} <= set(texts(svg)), "the found value is shown even if there is little room"


def test_marks_outside_the_window_are_not_drawn():
    lane = Lane("SCL", "capture", BLUE, 1)
    assert "gone" not in timing_diagram([lane], (0, 10 * US), [Mark(11 * US, "gone")])


def test_markup_characters_are_escaped():
    lane = Lane("a<b & c", "capture", BLUE, 1)
    assert "a<b & c" in texts(timing_diagram([lane], (0, 1)))


@pytest.mark.parametrize(("lanes", "window"), [([], (0, 1)), ([Lane("SCL", "", BLUE, 1)], (1, 1))])
def test_a_diagram_without_lanes_or_time_is_rejected(lanes, window):
    with pytest.raises(ValueError, match="expected a lane and a later end"):
        timing_diagram(lanes, window)


@pytest.mark.parametrize(
    ("length", "unit", "numbers"),
    [(20 * US, "us", ["0", "2", "20"]), (3e-9, "ns", ["0", "0.5", "3"]), (0.08, "ms", ["0", "10", "80"])],
)
def test_the_axis_has_a_unit_and_rounded_numbers(length, unit, numbers):
    shown = texts(timing_diagram([Lane("SCL", "capture", BLUE, 1)], (0, length)))
    assert unit in shown and set(numbers) <= set(shown)


@given(st.floats(1e-9, 1e3))
def test_steps_of_the_axis_are_round_numbers_and_few(length: float):
    step = nice_step(length)
    digits = f"{step:.6e}".partition("e")[0]
    assert float(digits) in (1, 2, 5, 10) and 2 <= length / step <= 10.1


def test_equal_input_gives_equal_output():
    lanes = [Lane("SCL", "capture", BLUE, 1, ((1 * US, 0),))]
    assert timing_diagram(lanes, (0, 5 * US)) == timing_diagram(lanes, (0, 5 * US))
