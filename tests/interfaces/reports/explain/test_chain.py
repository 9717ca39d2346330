"""Chains of pins that the firmware moves: what is blamed, and where the time went.

- which part of the worst occurrence is blamed, beside the least critical one
- time that went into code without a name, which nothing was recorded of: told by what the firmware did next
- why a watched wire's edge was late: what moved it, and which line of the firmware; or that nothing did
"""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.firmware import start_pin
from periph_sim.interfaces.reports.explain.chain import Chain
from periph_sim.interfaces.reports.explain.explain import explain
from periph_sim.interfaces.reports.html.failure import failure
from periph_sim.processor.dsp import Dsp
from periph_sim.processor.image_files.assemble import SHIPPED
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene
from tests.records.scenes import line_of
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
    """Return the explanation of the length of the pulse that is nearest to this limit."""
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


# Code without a name ---------------------------------------------------------------------


def pulse(dsp: Dsp, cycles: int) -> None:
    start_pin(dsp, 34)
    dsp.set_pin(34)
    dsp.compute(cycles)
    dsp.clear_pin(34)


def computed(cycles: int) -> Chain:
    programs = {"dsp": Firmware("pulse", lambda dsp, settings: pulse(dsp, cycles), None)}
    budget = {"name": "high", "measure": "from edge GOOD rise to edge GOOD fall", "max": "100 ns"}
    made = case("1 ms", unit={"dsp": UNIT}, budget=[budget])
    return explain(made, Scene(made, programs=programs).run().budgets, programs=programs)["high"].chain


def test_a_long_computation_has_the_place_of_the_access_behind_it():
    blamed = computed(20_000).blamed
    assert blamed is not None and blamed.place is not None
    assert str(blamed) == "code before GPIO.GPBCLEAR written"
    assert f"{blamed.place.function}:{blamed.place.line}" == line_of(pulse, 4)


@pytest.mark.parametrize("cycles", [20, 150, 151, 20_000])
def test_the_parts_add_up_to_the_whole(cycles: int):
    chain = computed(cycles)
    assert sum(part.length for part in chain.parts) == chain.length


def test_a_short_one_has_none():
    """Code of 1 us is reported as other code, longer code by the access that follows it."""
    assert [str(part) for part in computed(130).parts] == ["other code", "hardware, after GPIO.GPBCLEAR written"]
    assert "code before GPIO.GPBCLEAR written" in map(str, computed(200).parts)


# Watched wires ----------------------------------------------------------------------------

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
