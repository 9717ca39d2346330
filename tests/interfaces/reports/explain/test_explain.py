"""Chains of real runs: lengths add up, steps are in the records, and they name the right line of the firmware."""

from __future__ import annotations

import json
import linecache
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from periph_sim.interfaces.reports.explain.chain import Chain, as_json, text
from periph_sim.interfaces.reports.explain.explain import chain_of
from periph_sim.processor.dsp import Dsp
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene
from periph_sim.timing.budget_schema import Budget
from periph_sim.timing.measures.registry import MEASURES, Sentence
from periph_sim.timing.verdict import Verdict
from periph_sim.traces.capture.capture import Channel, Span
from tests.interfaces.reports.explain.made import drawn, explain
from tests.interfaces.reports.explain.test_fault_evidence import explained
from tests.interfaces.reports.explain.test_master_explained import REQUESTS, SCRIPT
from tests.interfaces.reports.explain.test_master_explained import chain as chain_of_master
from tests.scene.runs import TIMING
from tests.scene.small import case
from tests.unwrapped import unwrapped

SETTING = "unit.dsp.settings."
LATE = (f"{SETTING}frame_cost=200 us", "host.first=4.24 ms")  # the service routine runs during the gyroscope's read


def chains(case: Case, length: Fraction) -> dict[str, Chain]:
    scene = Scene(case)
    result = scene.run(length)
    return {name: one.chain for name, one in explain(case, result.budgets, scene.typical(), length).items()}


@cache
def chains_of(name: str, *changes: str, length: Fraction = Fraction(1, 8)) -> dict[str, Chain]:
    return chains(load(TIMING / f"{name}.toml", list(changes)), length)


def measured(measure: str, *changes: str, name: str = "imu_hil_published", limit: str = 'max = "1 s"') -> Chain:
    """Return the chain of an additional budget of a case."""
    key, _, value = limit.partition(" = ")
    budget = Budget.model_validate({"name": "asked", "measure": measure, key: json.loads(value)})
    case = load(TIMING / f"{name}.toml", list(changes)).model_copy(update={"budget": (budget,)})
    return chains(case, Fraction(1, 10))["asked"]


def said(chain: Chain) -> str:
    return unwrapped("\n".join(text(chain)))


def line_of(chain: Chain, what: str) -> str:
    """Return the source line of the first step that begins with this text."""
    place = next(step.place for step in chain.steps if step.what.startswith(what))
    assert place is not None and place.file is not None
    return linecache.getline(str(place.file), place.line).strip()


def test_a_stretch_is_explained_from_the_flag_to_the_write_that_ends_it():
    chain = chains_of("imu_hil_published", *LATE)["stretch"]
    shown = [step.what for step in chain.steps]
    assert shown == [
        "repeated START, gyroscope (0x68 R)",
        "SCI-A.SCIFFRX.RXFFINT set (the request that set it)",
        shown[2],
        "span frame",
        "address acknowledged",
        "SCL falls, pulled low by controller (the last input that had taken effect)",
        "I2C-A.I2CSTR.XRDY set (the last change of what it read)",
        "byte 1: 0x00 ACK",
        "SCL held low by dsp: span frame, begun 102.520 us before",
        "I2C-A.I2CSTR read, 0x5610 (XRDY = 1) (the read before it that saw the newest change)",
        "I2C-A.I2CDXR written, 0x0003, for which SCL was held 97.800 us",
        "SCL rises",
    ]
    assert shown[2].startswith("SCIRXINTA entered, preempting the wait for I2C-A.I2CSTR.XRDY or SCD at imu_hil.py:")
    assert line_of(chain, "SCIRXINTA") == "def sci_received(self) -> None:"
    assert line_of(chain, "I2C-A.I2CDXR written") == "i2c.I2CDXR.all = next(buffer)"
    assert chain.blamed is not None and chain.blamed.what == "frame"
    assert chain.typical == 0 and sum(part.length for part in chain.more) == chain.length


def test_a_stretch_that_the_run_cuts_off_does_not_end_with_a_rise():
    hang = (f"{SETTING}frame_cost=200 us", "host.first=4 ms")
    chain = chains_of("imu_hil_published", *hang, length=Fraction(12, 1000))["stretch"]
    assert chain.steps[-1].what == "SCL is still low: the run ends"


def test_an_undelayed_response_is_the_low_time_of_the_controller():
    chain = chains_of("imu_hil_published")["response"]
    assert [(str(part), part.length) for part in chain.parts] == [("bits of gyroscope", 15000)]
    assert [step.what for step in chain.steps[-2:]] == [
        "I2C-A.I2CDXR written, 0x0000, 4.773 us before SCL is released",
        "SCL rises",
    ]


def test_a_round_consists_of_its_transfers_its_gaps_and_holds_of_scl():
    chain = chains_of("imu_hil_published", *LATE)["round complete"]
    names = {str(part): part.length for part in chain.parts}
    for chip in ("gyroscope", "accelerometer", "magnetometer"):
        assert names[f"bits of {chip}"] == 840 * 3000  # 84 bits, independent of the time that SCL was held between them
    assert names["bus free between two transfers"] == 2 * 50 * 3000
    assert any(step.what == "SCL held low by dsp: span frame, begun 102.520 us before" for step in chain.steps)


def test_a_nack_is_explained_by_the_own_address_of_the_module():
    chain = chains_of("late_model")["nacked rounds"]
    assert "I2COAR = 0x00 written, 5094.447 us before the NACK" in said(chain)
    assert chain.blamed is not None and str(chain.blamed) == "span model"
    later = chains_of("wrong_order")["nacked rounds"]
    assert "I2COAR = 0x53 written, 900.400 us too late" in said(later)
    assert line_of(later, "I2COAR = 0x53") == "i2c.I2COAR.all = address"
    assert later.blamed is not None and str(later.blamed) == "wait for I2C-A.I2CSTR.AAS"


def test_a_hang_names_the_read_modify_write_that_cleared_the_flag():
    """SCD = 1 writes back the whole register and clears SDIR, which was set a moment before."""
    chain = chains_of("imu_hil_drift", f"{SETTING}frame_cost=200 us", length=Fraction(9, 20))["missed rounds"]
    cleared = "I2C-A.I2CSTR.SDIR cleared by I2C-A.I2CSTR written, 0x5638"
    assert line_of(chain, cleared) == "i2c.I2CSTR.SCD = 1"
    assert line_of(chain, "wait for I2C-A.I2CSTR.SDIR begins, and goes on") == "dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)"


def test_old_data_is_explained_by_the_round_that_it_missed():
    chain = chains_of("imu_hil_published", *LATE)["data age"]
    steps = [step.what.partition(",")[0] for step in chain.steps]
    assert steps == [
        "RX: 0x03 is over",
        "SCI-A.SCIFFRX.RXFFINT set (the request that set it)",
        "SCIRXINTA entered",
        "span frame",
        "magnetometer (0x1E R)",
        "span model",
        "span frame",
        "repeated START",
    ]
    assert chain.steps[-1].what == "repeated START, magnetometer (0x1E R), whose cause is not recorded"


FROM = "from flag I2C-A.I2CSTR.SDIR rise to access W I2C-A.I2CDXR"


def test_two_events_are_explained_with_their_causes_and_the_time_between():
    chain = measured(FROM)
    steps = [step.what for step in chain.steps]
    assert any(step.startswith("SCL falls, pulled low by controller (") for step in steps)
    assert steps.index("I2C-A.I2CSTR.SDIR set") < len(steps) - 1
    assert steps[-1].startswith("I2C-A.I2CDXR written, ")
    assert line_of(chain, "I2C-A.I2CDXR written") == "i2c.I2CDXR.all = next(buffer)"
    assert sum(part.length for part in chain.parts) == chain.length > 0


def test_an_interrupt_request_that_is_not_taken_is_explained():
    chain = measured("interrupt latency SCIRXINTA", f"{SETTING}mask_during_i2c=true", "host.first=4.24 ms")
    assert "the CPU does not take it, and no other routine is served: interrupts are off" in said(chain)
    assert str(chain.parts[0]) == "wait for I2C-A.I2CSTR.XRDY or SCD"
    prompt = measured("interrupt latency SCIRXINTA", "host.first=4.24 ms")
    assert "interrupts are off" not in said(prompt)


@pytest.mark.parametrize(
    ("measure", "limit", "changes", "shown"),
    [
        ("period of bus START", 'max = "1 s"', (), ["controller: START (gyroscope)"]),
        ("jitter of bus START", 'max = "1 s"', (), [" 890.000 us controller: START (magnetometer): a period of"]),
        ("count of bus address read", "max = 1", (), ["controller: 0x68 R ACK (gyroscope)"]),
        ("level of SCI-A.SCIFFRX.RXFFST", "max = 1", (), ["SCI-A.SCIFFRX.RXFFST = 0xc"]),
        ("time in model", 'max = "1 s"', (), ["span model begins"]),
        ("each time in wire SCL low", 'max = "1 s"', (), ["SCL falls, pulled low by controller"]),
        ("cpu load", 'max = "90 %"', (), ["of the run: wait for I2C-A.I2CSTR.AAS"]),
        ("bus load", 'max = "90 %"', (), ["of the run: "]),
        ("slack", 'min = "1 us"', (), ["the next round is due"]),
        ("value error of gyroscope", "max = 3000", (), ["byte 2: 0x00 ACK, written"]),
        ("from edge MODEL rise to edge MODEL fall", 'max = "1 s"', (), ["MODEL rises"]),
        (
            "fifo high-water",
            "max = 1",
            (f"{SETTING}model_cost=18 ms", f"{SETTING}fifo_level=13"),
            ["dsp: wait for I2C-A.I2CSTR.AAS", "13 words in the FIFO", "SCIRXBUF read, 0."],
        ),
        (
            "overruns",
            "max = 0",
            (f"{SETTING}frame_cost=30 ms", "host.period=2 ms"),
            ["SCI-A.SCIFFRX.RXFFOVF set", "dsp: span frame"],
        ),
        (
            "stuck",
            "max = 9",
            (f"{SETTING}frame_cost=200 us", "controller.stuck_after=2 ms", "host.first=4 ms"),
            ["SCL falls, and stays low", "SDIR cleared by I2C-A.I2CSTR written"],
        ),
    ],
)
def test_every_form_of_measure_is_explained(measure: str, limit: str, changes: tuple[str, ...], shown: list[str]):
    found = said(measured(measure, *changes, limit=limit))
    assert [text for text in shown if text in found] == shown


@given(
    first=st.integers(2000, 8000),
    frame_cost=st.integers(0, 300),
    model=st.integers(50, 900),
)
@settings(max_examples=6, deadline=None, phases=(Phase.explicit, Phase.generate))
def test_the_parts_of_chains_add_up_at_any_phase(first: int, frame_cost: int, model: int):
    changes = [f"host.first={first} us", f"{SETTING}frame_cost={frame_cost} us", f"{SETTING}model_cost={model} us"]
    for chain in chains(load(TIMING / "imu_hil_published.toml", changes), Fraction(28, 1000)).values():
        assert sum(part.length for part in chain.parts) == (chain.length if chain.parts else 0)
        assert all(part.length > 0 for part in chain.parts)
        if chain.verdict.unit == "us" and chain.verdict.measure != "slack":
            assert float(chain.us(chain.length)) == pytest.approx(chain.verdict.worst, abs=1e-3)
        assert [step.at for step in chain.steps] == sorted(step.at for step in chain.steps)
        assert sum(part.length for part in chain.more) == (chain.length - (chain.typical or 0) if chain.more else 0)
        for step in chain.steps:
            if step.place is not None:
                assert linecache.getline(str(step.place.file), step.place.line).strip()


def test_json_has_the_contents_of_the_text():
    chain = chains_of("imu_hil_published", *LATE)["stretch"]
    shown = json.loads(json.dumps(as_json(chain)))
    assert shown["length_us"] == 97.8333 and shown["typical_us"] == 0
    assert sum(part["length_us"] for part in shown["parts"]) == pytest.approx(97.8333, abs=1e-3)
    step = next(step for step in shown["steps"] if step["what"].startswith("SCIRXINTA"))
    assert (step["function"], step["length_us"]) == ("sci_received", 200.36)
    assert step["file"].endswith("firmware/python/imu_hil.py")


def test_only_the_least_critical_occurrences_of_explained_budgets_are_recorded(monkeypatch: pytest.MonkeyPatch):
    """Each additional occurrence keeps all records around it."""
    looked_for: list[Verdict] = []
    monkeypatch.setattr(
        import_module("periph_sim.interfaces.reports.explain.explain"),
        "windows",
        lambda _, found, *rest: looked_for.extend(found) or [],
    )
    worst, typical, other = (
        Verdict(name, "response", "us", 5.0, 9, 4.0, 1, "pass", at) for name, at in (("a", 0.2), ("a", 0.1), ("b", 0.3))
    )
    explain(load(TIMING / "imu_hil_published.toml"), [worst], [typical, other])
    assert looked_for == [worst, typical]


# Windows built by hand ---------------------------------------------------------------------

CASE = case(unit={"dsp": {"firmware": "given", "modules": ["I2C-A"]}})


@pytest.mark.parametrize(
    ("scl", "sda", "falls"),
    [
        ([40], [10, 30], ["SCL falls, and stays low"]),
        ([40, 50], [45], ["SDA falls, and stays low"]),
        ([40, 50], [60], ["SDA falls, and stays low"]),  # in the same tick
        ([40, 50], [61], []),
        ([40], [20], ["SDA falls, and stays low", "SCL falls, and stays low"]),
    ],
)
def test_a_stuck_bus_is_explained_by_the_lines_that_are_low(scl: list[int], sda: list[int], falls: list[str]):
    """Edges of lines that begin high; the stuck bus is reported at 60."""
    window = drawn("wait AAS 0 -", begin=60, end=60)
    channels = tuple(Channel(name, i, 1, np.array(at)) for i, (name, at) in enumerate((("SCL", scl), ("SDA", sda))))
    verdict = replace(window.verdict, measure="stuck", unit="count")
    chain = chain_of(CASE, replace(window, verdict=verdict, edges=replace(window.edges, channels=channels)))
    assert [step.what for step in chain.steps if "falls" in step.what] == falls


def test_a_load_is_explained_by_the_whole_last_part_of_the_run():
    """The last tick is 149, which is 199 after the first."""
    window = drawn("span model 0 99", kept=(Span(-50, 150),))
    (step,) = chain_of(CASE, replace(window, verdict=replace(window.verdict, measure="cpu load", unit="%"))).steps
    assert (step.at, step.length) == (-50, 199)
    assert step.what == "the last 0.066 us of the run: other code 0.033 us, span model 0.033 us"


# Planted delays --------------------------------------------------------------------------


def answered(measure: str, cycles: int, data: Sequence[int] = (1,), pause: int = 20) -> Chain:
    """The firmware computes before it writes the bytes of each read; `pause` is its number of cycles after a write."""

    def answer(i2c: Any, dsp: Dsp) -> None:
        while True:
            dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)
            i2c.I2CSTR.all = 0x4000
            dsp.compute(cycles)
            for byte in data:
                i2c.I2CDXR.all = byte
                dsp.compute(pause)
            dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
            i2c.I2CSTR.SCD = 1

    return explained(answer, measure, {"address": 0x50, "count": len(data)}, limit="1 us").chain


def us_in(chain: Chain, what: str) -> float:
    return float(sum(chain.us(one.length) for one in chain.parts if str(one) == what))


@pytest.fixture
def new_kinds(monkeypatch: pytest.MonkeyPatch):
    """Register additional measures, of records of each kind, for this test."""
    rows = {
        "held": Sentence("value of record transfer stretch"),
        "freshness": MEASURES["age"],
        "doubtful": Sentence("sum of record data wrong bytes"),
        "begun": Sentence("count of record round due"),
        "unanswered": Sentence("count of record transfer refused"),
        "queue": Sentence("value of record receiver words"),
    }
    for name, row in rows.items():
        monkeypatch.setitem(MEASURES, name, row)


@pytest.mark.usefixtures("new_kinds")
@pytest.mark.parametrize("measure", ["response", "stretch", "each time in wire SCL low", "held"])
def test_a_computation_before_the_answer_is_named_with_its_line(measure: str):
    """If it takes 100 us more, this part is 100 us longer, and no other part."""
    computed = "code before I2C-A.I2CDXR written"
    short, long = (answered(measure, cycles) for cycles in (7_500, 22_500))
    assert us_in(long, computed) - us_in(short, computed) == pytest.approx(100, abs=0.01)
    assert long.us(long.length - short.length) == pytest.approx(100, abs=0.01)
    assert sum(one.length for one in long.parts) == long.length
    assert str(long.blamed) == computed and line_of(long, "I2C-A.I2CDXR written") == "i2c.I2CDXR.all = byte"


def test_a_hold_is_described_by_the_write_that_ended_it():
    """It is not described by the write of the next byte, which is before the end, too."""
    chain = answered("from bus address read to bus byte", 7_500, data=(1, 2), pause=1_000)
    (shown,) = [step for step in chain.steps if "I2CDXR written" in step.what]
    (hold,) = [step for step in chain.steps if step.what.startswith("SCL held low by dsp")]
    assert (
        shown.what == f"I2C-A.I2CDXR written, 0x0001, for which SCL was held {chain.timebase.show(shown.at - hold.at)}"
    )


@pytest.mark.parametrize("measure", ["stretch", "response"])
def test_a_device_that_holds_scl_is_named_with_the_duration(measure: str):
    """The master's own low time of 5 us belongs to the bits."""
    shown = [
        chain_of_master(measure, SCRIPT, REQUESTS, stretch={"length": f"{length} us", "access": "read", "bytes": [1]})
        for length in (130, 230)
    ]
    assert [us_in(one, "SCL held low by memory") for one in shown] == pytest.approx([125, 225])
    assert [sum(one.length for one in each.parts) for each in shown] == [each.length for each in shown]
    assert "repeated START, memory (0x50 R)" in said(shown[0]) and "held low by dsp" not in said(shown[0])


def test_a_frame_that_comes_late_has_no_cause_in_the_recording():
    """The host sends 12 characters every 50 ms; the longest period is from the last one to the next frame."""
    found = measured("period of frame RX begin", "host.period=50 ms")
    assert found.us(found.length) == pytest.approx(50_000 - 11 * 10 * 1e6 / 115_200, abs=1)
    assert found.steps[-1].what == "RX: frame begins, whose cause is not recorded"


# Budgets of other kinds ------------------------------------------------------------------


@pytest.mark.usefixtures("new_kinds")
@pytest.mark.parametrize(
    ("name", "measure", "shown"),
    [
        ("imu_hil_published", "freshness", "magnetometer (0x1E R), with older data"),
        ("imu_hil_no_sdir", "doubtful", "I2CDXR = 0x12 written, before the read's START"),
        ("imu_hil_published", "begun", "gyroscope (0x68 W) begins"),
        ("late_model", "unanswered", "address 0x68 not acknowledged"),
        ("imu_hil_published", "queue", "12 words in the FIFO"),
    ],
)
def test_a_budget_of_a_new_measure_is_explained_without_new_code(name: str, measure: str, shown: str):
    found = measured(measure, name=name, limit='max = "1 us"' if measure == "freshness" else "max = 0")
    assert any(step.what == shown for step in found.steps), [step.what for step in found.steps]
    assert sum(one.length for one in found.parts) == (found.length if found.parts else 0)
