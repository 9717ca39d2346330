"""What is told of the bus, of windows made by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from periph_sim.explain.bus_chain import stuck
from periph_sim.explain.evidence import Evidence
from periph_sim.traces.capture.capture import channel_of_edges
from tests.explain.made import drawn
from tests.scene.small import case

CASE = case(unit={"dsp": {"firmware": "given", "modules": ["I2C-A"]}})


@pytest.mark.parametrize(
    ("scl", "sda", "falls"),
    [
        ([40], [10, 30], ["SCL falls, and stays low"]),
        ([40, 50], [45], ["SDA falls, and stays low"]),
        ([40, 50], [60], ["SDA falls, and stays low"]),  # in the very tick
        ([40, 50], [61], []),
        ([40], [20], ["SDA falls, and stays low", "SCL falls, and stays low"]),
    ],
)
def test_a_stuck_bus_is_told_by_the_lines_that_are_low_then(scl: list[int], sda: list[int], falls: list[str]):
    """Edges of lines that begin high; reported at 60."""
    window = drawn("wait AAS 0 -", begin=60, end=60)
    channels = tuple(
        channel_of_edges(name, i, 1, np.array(at)) for i, (name, at) in enumerate((("SCL", scl), ("SDA", sda)))
    )
    evidence = Evidence(replace(window, edges=replace(window.edges, channels=channels)), CASE)
    assert [step.what for step in stuck(evidence).steps if "falls" in step.what] == falls
