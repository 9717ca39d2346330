"""Explanations follow from records: of windows made by hand, of budgets of kinds that nobody knew, of planted delays.

A planted delay has a place and an amount that the test knows; the explanation has to name both.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from periph_sim.explain.chain import Chain
from periph_sim.explain.explain import explain
from periph_sim.explain.occurrence import chain_of
from periph_sim.firmware import start_i2c
from periph_sim.processor.dsp import Dsp
from periph_sim.scene.case.load import load
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene
from periph_sim.timing.budget_schema import Budget
from periph_sim.timing.measures.registry import MEASURES, Sentence
from periph_sim.traces.capture.capture import Span, channel_of_edges
from tests.explain.made import drawn
from tests.explain.test_master_explained import REQUESTS, SCRIPT, chain
from tests.records.scenes import line_of
from tests.scene.runs import TIMING
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
    verdict = replace(window.verdict, measure="stuck", unit="count")
    chain = chain_of(CASE, replace(window, verdict=verdict, edges=replace(window.edges, channels=channels)))
    assert [step.what for step in chain.steps if "falls" in step.what] == falls


def test_a_load_is_told_by_all_of_the_last_part_of_the_run():
    """Its last tick is 149, which is 199 behind the first."""
    window = drawn("span model 0 99", kept=(Span(-50, 150),))
    (step,) = chain_of(CASE, replace(window, verdict=replace(window.verdict, measure="cpu load", unit="%"))).steps
    assert (step.at, step.length) == (-50, 199)
    assert step.what == "the last 0.066 us of the run: other code 0.033 us, span model 0.033 us"


# Planted delays --------------------------------------------------------------------------


def answer(dsp: Dsp, cycles: int) -> None:
    start_i2c(dsp, own_address=0x50)
    i2c = dsp.module("I2C-A")
    i2c.I2CMDR.IRS = 1
    while True:
        dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)
        i2c.I2CSTR.all = 0x4000
        dsp.compute(cycles)
        i2c.I2CDXR.all = 1
        dsp.compute(20)
        dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
        i2c.I2CSTR.SCD = 1


def answered(measure: str, cycles: int) -> Chain:
    """A read of one byte, for which the firmware computes."""
    programs = {"dsp": Firmware("slave", lambda dsp, settings: answer(dsp, cycles), None)}
    made = case(
        "3 ms",
        unit={"dsp": {"firmware": "slave", "modules": ["I2C-A"]}},
        controller={"first": "1 ms", "period": "5 ms", "request": [{"address": 0x50, "count": 1}]},
        budget=[{"name": "b", "measure": measure, "max": "1 us"}],
    )
    return explain(made, Scene(made, programs=programs).run().budgets, programs=programs)["b"].chain


def part(chain: Chain, what: str) -> float:
    """The sum of a place, in us."""
    return float(sum(chain.us(one.length) for one in chain.parts if str(one) == what))


@pytest.fixture
def new_kinds(monkeypatch: pytest.MonkeyPatch):
    """Measures that only this test registers, of records of each kind."""
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
    """100 us more of it are 100 us more there and nowhere else."""
    computed = "code before I2C-A.I2CDXR written"
    short, long = (answered(measure, cycles) for cycles in (7_500, 22_500))
    assert part(long, computed) - part(short, computed) == pytest.approx(100, abs=0.01)
    assert long.us(long.length - short.length) == pytest.approx(100, abs=0.01)
    assert sum(one.length for one in long.parts) == long.length
    place = next(one.place for one in long.parts if str(one) == computed)
    assert place is not None and f"{place.function}:{place.line}" == line_of(answer, 8)


@pytest.mark.parametrize("measure", ["stretch", "response"])
def test_a_device_that_holds_scl_is_named_with_how_long(measure: str):
    """The master's own low time of 5 us is a part of the bits."""
    told = [
        chain(measure, SCRIPT, REQUESTS, stretch={"length": f"{length} us", "access": "read", "bytes": [1]})
        for length in (130, 230)
    ]
    assert [part(one, "SCL held low by memory") for one in told] == pytest.approx([125, 225])
    assert [sum(one.length for one in each.parts) for each in told] == [each.length for each in told]


def test_a_frame_that_comes_late_has_no_cause_in_the_recording():
    """The host sends 12 characters every 50 ms; the longest period is from the last one to the next frame."""
    budget = Budget.model_validate({"name": "b", "measure": "period of frame RX begin", "max": "1 ms"})
    run = load(TIMING / "imu_hil_published.toml", ["host.period=50 ms"]).model_copy(update={"budget": (budget,)})
    length = run.duration / 60
    found = explain(run, Scene(run).run(length).budgets, length=length)["b"].chain
    assert found.us(found.length) == pytest.approx(50_000 - 11 * 10 * 1e6 / 115_200, abs=1)
    assert found.steps[-1].what == "RX: frame begins, whose cause is not recorded"


# Budgets of other kinds ------------------------------------------------------------------


@pytest.mark.usefixtures("new_kinds")
@pytest.mark.parametrize(
    ("name", "measure", "told"),
    [
        ("imu_hil_published", "freshness", "magnetometer (0x1E R), with older data"),
        ("imu_hil_no_sdir", "doubtful", "I2CDXR = 0x12 written, before the read's START"),
        ("imu_hil_published", "begun", "gyroscope (0x68 W) begins"),
        ("late_model", "unanswered", "address 0x68 not acknowledged"),
        ("imu_hil_published", "queue", "12 words in the FIFO"),
    ],
)
def test_a_budget_of_a_new_kind_is_explained_without_another_line(name: str, measure: str, told: str):
    budget = Budget.model_validate({"name": "b", "measure": measure, "max": "1 us" if measure == "freshness" else 0})
    run = load(TIMING / f"{name}.toml", []).model_copy(update={"budget": (budget,)})
    length = run.duration / 80
    found = explain(run, Scene(run).run(length).budgets, length=length)["b"].chain
    assert any(step.what == told for step in found.steps), [step.what for step in found.steps]
    assert sum(one.length for one in found.parts) == (found.length if found.parts else 0)
