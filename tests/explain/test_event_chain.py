"""What is told around events, of windows made by hand."""

from __future__ import annotations

from periph_sim.explain.event_chain import whole
from periph_sim.explain.evidence import Evidence
from periph_sim.traces.capture.capture import Span
from tests.explain.made import drawn
from tests.scene.small import case

CASE = case(unit={"dsp": {"firmware": "given", "modules": ["I2C-A"]}})


def test_a_load_is_told_by_all_of_the_last_part_of_the_run():
    """Its last tick is 149, which is 199 behind the first."""
    (step,) = whole(Evidence(drawn("span model 0 99", kept=(Span(-50, 150),)), CASE)).steps
    assert (step.at, step.length) == (-50, 199)
    assert step.what == "the last 0.066 us of the run: other code 0.033 us, span model 0.033 us"
