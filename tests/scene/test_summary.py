"""What the result of a run says of all that happened in it."""

from __future__ import annotations

from fractions import Fraction

from periph_sim.scene.scene import Scene
from tests.scene.small import case


def test_ten_sentences_of_stuck_lines_are_shown_and_all_are_counted():
    scene = Scene(case(chip={"gyroscope": {"model": "itg3200", "values": {"fixed": [10, -20, 30]}}}))
    scene.stuck.sentences += [f"SDA is held low, {n}" for n in range(12)]
    result = scene.run(Fraction(0))
    assert result.stuck == scene.stuck.sentences[:10] and result.counts["stuck"] == 12
