"""Coordinates in the picture of costs and errors: a decade of cycles is 385 wide, one of errors 70 high."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import pytest

from periph_sim.imu.extremes import SWEEPS, ExtremesReport
from periph_sim.imu.extremes.plot import FOUNDED, GUESSED, picture

COSTS = {  # cycles from and to; guessed; error in LSB
    "right": (1000, 1000, False, None),
    "beside": (1010, 1010, False, 0.0),
    "coarse": (10_000, 100_000, True, 10.0),
    "middle": (10_000, 10_000, False, 0.1),
}


def drawn(*names: str) -> list[tuple[str, dict[str, str], str]]:
    """Return tag, attributes and text of each element of the picture; all of COSTS are drawn if no names are given."""
    given = {name: COSTS[name] for name in names or COSTS}
    costs = {name: SimpleNamespace(low=low, high=high, guessed=guess) for name, (low, high, guess, _) in given.items()}
    errors = {name: SimpleNamespace(largest=error) for name, (*_, error) in given.items() if error is not None}
    made: Any = SimpleNamespace(names=tuple(given), costs=costs, errors=errors)
    report: ExtremesReport = made
    root = ElementTree.fromstring(picture(report))
    return [(node.tag.rpartition("}")[2], dict(node.attrib), node.text or "") for node in root.iter()]


def words(parts: list[tuple[str, dict[str, str], str]]) -> dict[str, tuple[float, float, str]]:
    return {text: (float(a["x"]), float(a["y"]), a["text-anchor"]) for what, a, text in parts if what == "text"}


def test_points_and_bars():
    parts = drawn()
    points = [(float(a["cx"]), float(a["cy"]), a["fill"]) for what, a, _ in parts if what == "circle"]
    assert points == [
        (90.0, 480.0, FOUNDED),
        (91.66, 480.0, FOUNDED),  # 385 * log10(1.01)
        (667.5, 60.0, GUESSED),
        (475.0, 200.0, FOUNDED),
    ]
    bars = [a["d"] for what, a, _ in parts if what == "path" and a.get("stroke-width") == "3"]
    assert bars == [
        f"M{begin} L{end}"
        for begin, end in (
            ("90.0,480.0", "90.0,480.0"),
            ("91.66,480.0", "91.66,480.0"),
            ("475.0,60.0", "860.0,60.0"),
            ("475.0,200.0", "475.0,200.0"),
        )
    ]


def test_labels_are_beside_their_points_and_do_not_overlap():
    found = words(drawn())
    assert {name: found[name] for name in COSTS} == {
        "right": (96.0, 474.0, "start"),
        "beside": (97.66, 488.0, "start"),  # one line lower
        "coarse": (673.5, 54.0, "start"),
        "middle": (481.0, 194.0, "start"),
    }


def test_axes_and_their_labels():
    found = words(drawn())
    assert [found[text] for text in ("1000", "10000", "100000")] == [(x, 498.0, "middle") for x in (90, 475, 860)]
    errors = ("exact", "0.0001", "0.001", "0.01", "0.1", "1", "10")
    labels = {text: place for text, place in found.items() if place[2] == "end" and place[0] == 82}
    assert labels == {text: (82.0, 484.0 - 70 * n, "end") for n, text in enumerate(errors)}
    assert found["SYSCLKOUT cycles (estimated; orange: by a guess)"] == (450.0, 530.0, "middle")
    assert found["LSB, worst axis"] == (82.0, 46.0, "start")
    assert found["Error against cycles of one sample of nine axes"] == (450.0, 28.0, "middle")
    x, y, anchor = found["measured: 250 us"]
    assert (x, y, anchor) == (pytest.approx(90 + 385 * 1.574031 - 6, abs=0.01), 74.0, "end")  # log10(37 500) - 3


def test_the_axis_of_errors_has_two_labels_if_nothing_has_an_error():
    parts = drawn("right", "beside")
    assert {a["cy"] for what, a, _ in parts if what == "circle"} == {"480.0"}
    labels = {text: y for text, (x, y, _) in words(parts).items() if x == 82 and text != "LSB, worst axis"}
    assert labels == {"exact": 484.0, "0.0001": 64.0}


@pytest.mark.parametrize(
    ("name", "ordinary", "extreme"),
    [
        ("pitch through 90, as built", 87, 93),
        ("pitch through 90, corrected", 87, 93),
        ("yaw through 180, as built", 177, 183),
        ("yaw through 180, unwrapped", 177, 183),
        ("yaw beyond int16", 185, 191),
        ("yaw step in one sample", 0, 359),
        ("roll rate", 0, 8000),
        ("roll rate beyond frames", 0, 1_000_000),
        ("acceleration", 0, 32.767),
        ("Ts jitter", 0, 50),
    ],
)
def test_range_of_a_motion(name: str, ordinary: float, extreme: float):
    (sweep,) = [sweep for sweep in SWEEPS if sweep.name == name]
    assert (sweep.ordinary, sweep.extreme) == (ordinary, extreme)
