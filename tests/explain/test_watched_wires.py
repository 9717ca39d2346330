"""Why a watched wire's edge was late: what moved it, and which line of the firmware; or that nothing did."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.explain.explain import explain
from periph_sim.image.assemble import SHIPPED
from periph_sim.scene.scene import Scene
from tests.scene.small import case

STROBE = {"kind": "edges", "edges": [["0 s", "rise"], ["499 us", "fall"]], "since": "first edge", "more": True}


@pytest.mark.parametrize(
    ("after", "steps"),
    [
        ("4.5 ms", ["TINT0 entered", "GPIO.GPATOGGLE written", "LED falls", "dsp: TINT0"]),
        ("5.3 ms", ["dsp: IDLE"]),  # by the run's end no edge has come
    ],
)
def test_the_edge_is_traced_to_the_write_that_made_it(after: str, steps: list[str]):
    unit = {"image": str(SHIPPED / "blink.asm"), "modules": ["GPIO", "TIMER0"], "pins": {"LED": 31}}
    watch = {"strobe": {**STROBE, "wire": "LED", "after": after, "tolerance": "1 ns"}}
    duration = "5.5 ms" if after == "4.5 ms" else "5.35 ms"
    blinks = case(duration, unit={"dsp": unit}, watch=watch)
    scene = Scene(blinks)
    [verdict] = scene.run(blinks.duration).budgets
    assert not verdict.passed
    chain = explain(blinks, [verdict], scene.typical(), Fraction(blinks.duration))["strobe"].chain
    told = [step.what for step in chain.steps]
    assert [what[: len(step)] for what, step in zip(told, steps, strict=True)] == steps
    if len(steps) > 1:
        place = chain.steps[1].place
        assert place is not None and place.line == 35
