"""A bus without a controller agent is recorded as the agent would have recorded it."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.bus.i2c.event_recorder import BusRecorder
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.scene.runs import TIMING, run_file


def heard(name: str, seconds: str, *changes: str) -> tuple[list[Record], list[Record]]:
    """What the controller of a case records, and what is said of its wires beside it."""
    found: list[Record] = []

    def subscribe(recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe([Kind.BUS], found.append)

    scene = Scene(load(TIMING / f"{name}.toml", ["budget=[]", "breaks=[]", *changes]), subscribe)
    bus = BusRecorder(scene.kernel, scene.recorder, scene.wires["SCL"], scene.wires["SDA"])
    scene.run(Fraction(seconds))
    assert bus.bytes == sum(r.where == "bus" and r.what in ("address", "byte") for r in found)
    return [r for r in found if r.where != "bus"], [r for r in found if r.where == "bus"]


@pytest.mark.parametrize("name", ["imu_hil_published", "late_model", "wrong_order", "real_chips"])
def test_it_says_what_the_controller_says(name: str):
    told, beside = heard(name, "0.1")
    assert [(r.what, r.value) for r in beside] == [(r.what, r.value) for r in told] != []
    assert all(0 <= b.tick - a.tick <= 3 for a, b in zip(told, beside, strict=True))


def test_a_master_that_is_firmware_has_budgets_on_the_bus():
    texts = {
        "count of bus START": "min=6",
        "bus load": 'max="99 %"',
        "response": 'max="30 us"',
        "nacked": "max=0",
        "from first bus START of transfer to bus STOP, same transfer": 'max="9 ms"',
        "reaction of imu": 'max="9 ms"',
        "margin of imu:I2CDXR": 'min="0 s"',
        "SCL held per transfer by imu": 'max="1 ms"',
        "count of bus NACK": "max=0",
    }
    budgets = ", ".join(f'{{name="{text}", measure="{text}", {limit}}}' for text, limit in texts.items())
    ran = run_file("two_dsps", "0.05", f"budget=[{budgets}]")
    assert ran.broken() == [] and all(
        v.count for v in ran.result.budgets if v.measure not in ("nacked", "count of bus NACK")
    )
