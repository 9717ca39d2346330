"""Chains as text and JSON, and chains of pins that the firmware drives: what is blamed, and where the time was spent.

- which part of the worst occurrence is blamed, compared with the least critical one
- time in code without a name and without records, which is described by the access that follows it
- why a watched wire's edge was late: what caused it and at which line of the firmware, or that no edge occurred
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from periph_sim.firmware import start_pin
from periph_sim.interfaces.reports.explain.chain import Chain, FirmwarePlace, Part, Step, as_json, relative, text
from periph_sim.interfaces.reports.html.failure import failure
from periph_sim.processor.dsp import Dsp
from periph_sim.processor.image_files.assemble import SHIPPED
from periph_sim.timing.verdict import Verdict
from tests.interfaces.reports.explain.made import TIMEBASE, run_and_explain, steps_of
from tests.records.scenes import line_of
from tests.scene.small import case

MS = 150_000  # cycles
UNIT = {"firmware": "pulses", "modules": ["GPIO"], "pins": {"GOOD": 34}}


def pulses(dsp: Dsp) -> None:
    """Make pulses of 2.32 ms and 2.41 ms: `work` is equal in both, `rest` is longer in the second, `extra` is shorter.

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


def high(program: Callable[[Dsp], None], duration: str, **limits: str) -> Chain:
    """Return the explanation of the length of the pulse that is nearest to this limit."""
    budget = {"name": "high", "measure": "from edge GOOD rise to edge GOOD fall", **limits}
    return run_and_explain(case(duration, unit={"dsp": UNIT}, budget=[budget]), program)["high"].chain


@pytest.mark.parametrize(
    ("limits", "blamed", "why"),
    [
        # One pulse is within the first limit, none within the second.
        ({"max": "2.35 ms"}, "span rest", "100.000 us longer than in its least critical occurrence: span rest at"),
        ({"max": "1 ms"}, "span work", "Most of that time, 1.800 ms, went into span work at"),
        ({"min": "2.35 ms"}, "span rest", "100.000 us shorter than in its least critical occurrence: span rest at"),
        ({"min": "3 ms"}, "span work", "Most of that time, 1.800 ms, went into span work at"),
    ],
)
def test_the_least_critical_occurrence_decides_the_blame_only_if_it_is_within_the_limit(
    limits: dict[str, str], blamed: str, why: str
):
    chain = high(pulses, "8 ms", **limits)
    assert chain.more and str(chain.blamed) == blamed
    shown = failure(chain.verdict, False, chain, None, chain.timebase.per_second)
    assert shown is not None and chain.verdict.broken
    assert shown.why == why and shown.place.startswith("test_chain.py:")


# Code without a name ---------------------------------------------------------------------


def pulse(dsp: Dsp, cycles: int) -> None:
    start_pin(dsp, 34)
    dsp.set_pin(34)
    dsp.compute(cycles)
    dsp.clear_pin(34)


def computed(cycles: int) -> Chain:
    return high(lambda dsp: pulse(dsp, cycles), "1 ms", max="100 ns")


def test_a_long_computation_has_the_place_of_the_access_after_it():
    blamed = computed(20_000).blamed
    assert blamed is not None and blamed.place is not None
    assert str(blamed) == "code before GPIO.GPBCLEAR written"
    assert f"{blamed.place.function}:{blamed.place.line}" == line_of(pulse, 4)


@pytest.mark.parametrize("cycles", [20, 150, 151, 20_000])
def test_the_parts_add_up_to_the_length(cycles: int):
    chain = computed(cycles)
    assert sum(part.length for part in chain.parts) == chain.length


def test_a_short_computation_has_no_place():
    """Code of 1 us is reported as other code, longer code by the access that follows it."""
    assert [str(part) for part in computed(130).parts] == ["other code", "hardware, after GPIO.GPBCLEAR written"]
    assert "code before GPIO.GPBCLEAR written" in map(str, computed(200).parts)


# Watched wires ----------------------------------------------------------------------------

STROBE = {"kind": "edges", "edges": [["0 s", "rise"], ["499 us", "fall"]], "since": "first edge", "more": True}


@pytest.mark.parametrize(
    ("after", "steps"),
    [
        ("4.5 ms", ["TINT0 entered", "GPIO.GPATOGGLE written", "LED falls", "dsp: TINT0"]),
        ("5.3 ms", ["dsp: IDLE"]),  # no edge has occurred by the end of the run
    ],
)
def test_a_late_edge_is_traced_to_the_write_that_caused_it(after: str, steps: list[str]):
    unit = {"image": str(SHIPPED / "blink.asm"), "modules": ["GPIO", "TIMER0"], "pins": {"LED": 31}}
    watch = {"strobe": {**STROBE, "wire": "LED", "after": after, "tolerance": "1 ns"}}
    duration = "5.5 ms" if after == "4.5 ms" else "5.35 ms"
    blinks = case(duration, unit={"dsp": unit}, watch=watch)
    one = run_and_explain(blinks)["strobe"]
    assert not one.chain.verdict.passed
    assert [what[: len(step)] for what, step in zip(steps_of(one), steps, strict=True)] == steps
    if len(steps) > 1:
        place = one.chain.steps[1].place
        assert place is not None and place.line == 35


US = TIMEBASE.per_second // 1_000_000
LOOP = FirmwarePlace("batch_read", 106, Path.cwd() / "firmware" / "imu_hil.py")
RECORDED = FirmwarePlace("sci_received", 60, None)
VERDICT = Verdict("stretch", "stretch", "us", 97.953, 50, -47.953, 9, "fail", 0.105195)
CHAIN = Chain(
    VERDICT,
    TIMEBASE,
    100 * US,
    steps=(
        Step(-190 * US, "repeated START"),
        Step(-2 * US, "SCIRXINTA entered", 12_345 * US, LOOP),
        Step(100 * US, "SCL rises", place=RECORDED),
    ),
    parts=(Part("code", "", 60 * US, 2, LOOP), Part("span", "frame", 40 * US, place=RECORDED)),
    typical=75 * US,
    more=(Part("span", "frame", 40 * US, place=RECORDED), Part("code", "", -15 * US, 2)),
)
HEAD = "stretch 97.953 us, at most 50.000 us allowed, at 0.105195 s"


def test_a_chain_is_formatted_as_lines():
    assert text(CHAIN) == [
        HEAD,
        "    -190.000 us             repeated START",
        "      -2.000 us  12.345 ms  SCIRXINTA entered [imu_hil.py:106 (batch_read)]",
        "     100.000 us             SCL rises [sci_received:60]",
        "  made up of",
        "    60.000 us  60.0 %  other code, 2 times [imu_hil.py:106 (batch_read)]",
        "    40.000 us  40.0 %  span frame [sci_received:60]",
        "  +25.000 us against 75.000 us, its least critical occurrence",
        "    +40.000 us  span frame",
        "    -15.000 us  other code",
    ]


@pytest.mark.parametrize(
    ("ticks", "typical", "message"),
    [(15 * US, 15 * US, "0.000 us"), (2, 1, "+0.000 us"), (1, 2, "-0.000 us"), (15 * US, None, "+15.000 us")],
)
def test_only_a_longer_occurrence_has_a_plus_sign(ticks: int, typical: int | None, message: str):
    shown = text(replace(CHAIN, length=ticks, typical=typical, steps=(), parts=()))[1]
    usual = f"{float(CHAIN.us(typical or 0)):.3f} us"
    assert shown == f"  {message} against {usual}, its least critical occurrence"


@pytest.mark.parametrize(("us", "message"), [(9999, "9999.000 us"), (10_000, "10.000 ms"), (-10_000, "-10.000 ms")])
def test_lengths_of_ten_milliseconds_or_more_are_in_milliseconds(us: int, message: str):
    assert text(replace(CHAIN, steps=(Step(us * US, "SCL rises"),)))[1] == f"    {message}  SCL rises"


def test_the_six_largest_of_many_parts_are_listed():
    lengths = (1, 7, 3, -6, 5, 2, 4)
    shown = text(replace(CHAIN, steps=(), parts=(), more=tuple(Part("span", f"s{n}", n * US) for n in lengths)))
    assert [line.rpartition(" ")[2] for line in shown[2:]] == ["s7", "s-6", "s5", "s4", "s3", "s2"]
    assert shown[2:4] == ["    +7.000 us  span s7", "    -6.000 us  span s-6"]


@pytest.mark.parametrize(
    ("changes", "head"),
    [
        ({"which": "min"}, HEAD.replace("most", "least")),
        ({"which": "exactly"}, HEAD.replace("at most", "exactly")),
        ({"which": "p99_9"}, HEAD.replace("at most", "p99.9 at most")),
        ({"unit": "count", "worst": 3, "limit": 2, "at_s": None}, "stretch 3, at most 2 allowed, at -"),
        ({"worst": None}, "stretch: nothing was measured"),
    ],
)
def test_the_heading_describes_the_limit_by_its_key(changes: dict[str, object], head: str):
    bare = Chain(replace(VERDICT, **changes), TIMEBASE, 0, ())  # type: ignore[arg-type]
    assert text(bare) == [head]


def test_a_chain_is_converted_to_json():
    file = {"file": "firmware/imu_hil.py"}
    assert as_json(CHAIN) == {
        "steps": [
            {"at_us": -190.0, "what": "repeated START"},
            {"at_us": -2.0, "what": "SCIRXINTA entered", "length_us": 12345.0, "function": "batch_read", "line": 106}
            | file,
            {"at_us": 100.0, "what": "SCL rises", "function": "sci_received", "line": 60},
        ],
        "parts": [
            {"what": "other code", "length_us": 60.0, "count": 2, "function": "batch_read", "line": 106} | file,
            {"what": "span frame", "length_us": 40.0, "count": 1, "function": "sci_received", "line": 60},
        ],
        "length_us": 100.0,
        "typical_us": 75.0,
        "more": [
            {"what": "span frame", "length_us": 40.0, "count": 1, "function": "sci_received", "line": 60},
            {"what": "other code", "length_us": -15.0, "count": 2},
        ],
        "assumes": [],
    }
    bare = as_json(Chain(VERDICT, TIMEBASE, 1, (Step(0, "SCL rises", 0),)))  # 0.333 ns
    assert (bare["length_us"], bare["typical_us"]) == (0.0003, None)
    assert bare["steps"] == [{"at_us": 0.0, "what": "SCL rises", "length_us": 0.0}]


def test_a_file_outside_the_folder_keeps_its_whole_path():
    assert relative(Path("/elsewhere/imu_hil.py")) == Path("/elsewhere/imu_hil.py")
