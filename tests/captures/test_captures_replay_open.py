"""The real I2C captures in open loop: the F28335's slave would have driven the levels of the captures.

Its answers are ready for every SCL edge of every capture, including those at 400 kHz. Where SCL is low for longer than
usual in a capture, the module had released it long before.
"""

from __future__ import annotations

from functools import cache

import pytest

from periph_sim.replay.i2c_open_loop import I2cOpenReplay
from periph_sim.replay.report import Report
from periph_sim.scene.case.load import load as load_case
from tests.captures.test_captures_decode import load
from tests.captures.test_captures_replay_i2c import CANNOT, CASE, FIRST, NAMES, NOBODY, STYLES, lines
from tests.captures.where import needs_captures

FEW = 20  # transfers of the million edges


@cache
def run(name: str, style: str) -> Report:
    first = FEW if name in FIRST else None
    return I2cOpenReplay(load_case(CASE, list(STYLES[style])), load(name), *lines(name), first=first).run()


@pytest.mark.parametrize(
    ("name", "style"),
    [
        (name, style)
        for name in NAMES
        for style in ("polled", "interrupts")
        if name not in CANNOT and (name not in FIRST or style == "polled")
    ],
)
def test_the_slave_would_have_driven_the_captured_levels(name: str, style: str):
    report = run(name, style)
    assert report.divergences == [] and report.verdict == ("not judged" if name == NOBODY else "pass")
    assert report.agreed == report.events > 0
    assert report.late_worst_us == 0


@needs_captures
@pytest.mark.parametrize("name", CANNOT)
def test_the_first_divergence_is_the_same_as_in_closed_loop(name: str):
    first = run(name, "polled").first_divergence
    assert first is not None and (first.index, first.expected, first.found) == CANNOT[name]
