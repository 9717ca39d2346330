"""What the result of a run says of all that happened in it."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from tests.scene.small import case


def test_ten_sentences_of_stuck_lines_are_shown_and_all_are_counted():
    scene = Scene(case(chip={"gyroscope": {"model": "itg3200", "values": {"fixed": [10, -20, 30]}}}))
    scene.stuck.sentences += [f"SDA is held low, {n}" for n in range(12)]
    result = scene.run(Fraction(0))
    assert result.stuck == scene.stuck.sentences[:10] and result.counts["stuck"] == 12


def result(counts: dict[str, int], wire_bytes: int = 0) -> Result:
    return Result("x", "pass", "edge", 1.0, 1.0, 0, wire_bytes, 0, [], counts, [], [], [])


@pytest.mark.parametrize(
    ("counts", "wire_bytes", "text"),
    [
        ({}, 200, ""),
        ({"byte_level": 0}, 0, ""),
        ({"byte_level": 200}, 200, "100.0 % of the I2C bytes at byte level"),
        ({"byte_level": 0}, 200, "0.0 % of the I2C bytes at byte level"),
        ({"sci_frames": 60, "sci_frames_passed": 59}, 0, "98.3 % of the SCI frames at byte level"),
        (
            {"byte_level": 3, "sci_frames": 4, "sci_frames_passed": 1},
            4,
            "75.0 % of the I2C bytes and 25.0 % of the SCI frames at byte level",
        ),
    ],
)
def test_how_much_went_at_byte_level(counts: dict[str, int], wire_bytes: int, text: str):
    assert result(counts, wire_bytes).share_above_edges == text


def test_what_is_not_said_of_a_run_is_nothing():
    plain = result({})
    assert (plain.wrong, plain.first_wrong, plain.estimated, plain.sci_bytes_sent) == ({}, "", [], 0)
