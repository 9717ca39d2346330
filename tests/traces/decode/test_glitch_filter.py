"""Pulses too short to be meant, drawn."""

from __future__ import annotations

import pytest
from hypothesis import given, settings

from periph_sim.traces.capture.capture import Capture
from periph_sim.traces.decode.glitch_filter import without_glitches
from tests.profiles import examples
from tests.traces.decode.drawing import drawn
from tests.traces.decode.random_lines import captures


@pytest.mark.parametrize(
    ("before", "shortest", "after"),
    [
        ("__-_______----____", 2, "__________----____"),
        ("__--_-____----____", 3, "__________----____"),
        ("___---______---___", 3, "___---______---___"),
        ("__-_------___-____", 3, "____------________"),  # the last edge of a bounce stays
        ("-_----_-_-_-______", 2, "------------______"),
        ("-_", 9, "-_"),  # what is before the first edge and behind the last is no pulse
        ("-_-", 9, "---"),
        ("--__--", 1, "--__--"),
        ("------", 4, "------"),
    ],
)
def test_short_pulses_go_with_both_edges(before: str, shortest: int, after: str):
    line = without_glitches(drawn(f"X {before}").channel("X"), shortest)
    expected = drawn(f"X {after}").channel("X")
    assert (line.initial, line.edges.tolist(), line.levels.tolist()) == (
        expected.initial,
        expected.edges.tolist(),
        expected.levels.tolist(),
    )


@given(captures(("X",)))
@settings(max_examples=examples(40), deadline=None)
def test_no_pulse_that_is_left_is_short_and_the_end_is_the_same(capture: Capture):
    line = capture.channel("X")
    line = without_glitches(line, 4)
    assert all(b - a >= 4 for a, b in zip(line.edges[:-1].tolist(), line.edges[1:].tolist(), strict=True))
    assert len(line.edges) % 2 == len(capture.channel("X").edges) % 2
    again = without_glitches(line, 4)
    assert again.edges.tolist() == line.edges.tolist()
