"""WaveDrom: bricks, read back brick by brick, are the edges."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given, settings

from periph_sim.traces import formats
from periph_sim.traces.capture.capture import changes, channel_of
from periph_sim.traces.formats import Capture
from tests.profiles import examples
from tests.traces.formats.strategies import captures


def picture(capture: Capture, path: Path) -> dict[str, object]:
    formats.write(capture, path)
    return json.loads(path.read_text(encoding="utf-8"))


def test_a_short_window(tmp_path: Path):
    lines = (
        channel_of("SCL", 0, [0, 4, 8, 12], [1, 0, 1, 0], 20),
        channel_of("SDA", 1, [0, 2, 6, 10], [1, 0, None, 1], 20),
    )
    shown = picture(Capture(Path("x"), formats.rate_of("4 MHz"), 20, lines), tmp_path / "x.wavedrom.json")
    assert shown == {
        "signal": [{"name": "SCL", "wave": "1.0.1.0..."}, {"name": "SDA", "wave": "10.x.1...."}],
        "config": {"skin": "narrowerer"},
        "foot": {"text": "10 bricks, 500 ns each"},
    }


@given(given=captures())
@settings(max_examples=examples(40), deadline=None)
def test_the_bricks_are_the_edges(tmp_path_factory: pytest.TempPathFactory, given: Capture):
    path = tmp_path_factory.mktemp("drom") / "x.wavedrom.json"
    try:
        shown = picture(given, path)
    except formats.BadCapture as error:
        assert " bricks of " in str(error) and not path.exists()
        return
    bricks = {len(lane["wave"]) for lane in shown["signal"]}
    assert len(bricks) == 1
    at, which, states = (column.tolist() for column in changes(given))
    size = min([b - a for a, b in pairwise(sorted({*at, given.length}))], default=1)
    for number, lane in enumerate(shown["signal"]):
        placed = [(place, letter) for place, letter in enumerate(lane["wave"]) if letter != "."]
        expected = [(p, "01x"[s]) for p, w, s in zip(at, which, states, strict=True) if w == number]
        assert [letter for _, letter in placed] == [letter for _, letter in expected]
        steps = {p // b for (p, _), (b, _) in zip(expected, placed, strict=True) if b}
        assert len(steps) <= 1 and all(step <= size for step in steps)


def test_a_long_window_is_refused(tmp_path: Path):
    many = channel_of("SCL", 0, range(5000), [n & 1 for n in range(5000)], 5000)
    far = channel_of("SCL", 0, [0, 1], [0, 1], 10**6)
    sparse = channel_of("SCL", 0, [0, 3, 900_001], [0, 1, 0], 10**6)
    way_out = "state a shorter one, as --window '100 us..150 us'"
    for line, found in ((many, "4999 edges, expected at most 1000"), (sparse, "1000000 bricks of 1 positions")):
        with pytest.raises(formats.BadCapture) as caught:
            formats.write(Capture(Path("x.sr"), None, 10**6, (line,)), tmp_path / "x.wavedrom.json")
        assert str(caught.value).startswith(f"x.sr, the window: found {found}") and str(caught.value).endswith(way_out)
    with pytest.raises(formats.BadCapture, match="1000000 bricks of 1 positions"):
        formats.write(Capture(Path("x.sr"), None, 10**6, (far,)), tmp_path / "x.wavedrom.json")
    assert list(tmp_path.iterdir()) == []
