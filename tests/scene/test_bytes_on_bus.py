"""The number of bytes on the I2C bus at each time of a run is equal to that of a counter on the wires."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim import Scene, load
from periph_sim.bus.i2c.line_observers import BusRecorder

TIMING = Path(__file__).parents[2] / "timing"


@pytest.mark.parametrize("changes", [["disable=bits"], []], ids=["by edges", "skipping"])
def test_bytes_are_counted_as_they_end_and_not_only_with_their_stop(changes: list[str]):
    scene = Scene(load(TIMING / "responder.toml", [*changes, "controller.first=100 us"]))
    counter = BusRecorder(scene.wires["SCL"], scene.wires["SDA"])
    counts = set()
    for _ in range(60):
        scene.run(Fraction(37, 1_000_000))
        assert scene.bytes_on_bus() == counter.bytes
        counts.add(counter.bytes)
    assert len(counts) > 10
