"""Which part of the worst occurrence is blamed, beside the least critical one."""

from __future__ import annotations

import pytest

from periph_sim.explain.chain import Chain
from periph_sim.explain.explain import explain
from periph_sim.firmware import start_pin
from periph_sim.processor.dsp import Dsp
from periph_sim.reports.html.failure import failure
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene
from tests.scene.small import case

MS = 150_000  # cycles
UNIT = {"firmware": "pulses", "modules": ["GPIO"], "pins": {"GOOD": 34}}


def pulses(dsp: Dsp, settings: object) -> None:
    """Pulses of 2.32 ms and 2.41 ms: work is of one length, rest is longer in the second, and extra is shorter.

    GOOD  __|~~ work 1.8 ~~ rest 0.5 ~ extra 0.02 ~|_____|~~ work 1.8 ~~ rest 0.6 ~~ extra 0.01 ~|____
    """
    start_pin(dsp, 34)
    for rest, extra in ((MS // 2, MS // 50), (MS * 6 // 10, MS // 100)):
        dsp.set_pin(34)
        with dsp.span("work"):
            dsp.compute(MS * 18 // 10)
        with dsp.span("rest"):
            dsp.compute(rest)
        with dsp.span("extra"):
            dsp.compute(extra)
        dsp.clear_pin(34)
        dsp.compute(MS)


def high(**limits: str) -> Chain:
    """Why the pulse nearest to this limit is as long as it is."""
    programs = {"dsp": Firmware("pulses", pulses, None)}
    budget = {"name": "high", "measure": "from edge GOOD rise to edge GOOD fall", **limits}
    made = case("8 ms", unit={"dsp": UNIT}, budget=[budget])
    scene = Scene(made, programs=programs)
    verdicts = scene.run().budgets
    return explain(made, verdicts, scene.typical(), programs=programs)["high"].chain


@pytest.mark.parametrize(
    ("limits", "blamed", "why"),
    [
        ({"max": "2.35 ms"}, "span rest", "Longer than typical by 100.000 us: span rest at"),  # one pulse keeps it
        ({"max": "1 ms"}, "span work", "Most of that time, 1.800 ms, went into span work at"),  # none does
        ({"min": "2.35 ms"}, "span rest", "Shorter than typical by 100.000 us: span rest at"),
        ({"min": "3 ms"}, "span work", "Most of that time, 1.800 ms, went into span work at"),
    ],
)
def test_only_a_typical_occurrence_that_keeps_the_limit_says_what_is_to_blame(
    limits: dict[str, str], blamed: str, why: str
):
    chain = high(**limits)
    assert chain.more and str(chain.blamed) == blamed
    told = failure(chain.verdict, False, chain, None, chain.timebase.per_second)
    assert told is not None and chain.verdict.broken
    assert told.why == why and told.place.startswith("test_chain.py:")
