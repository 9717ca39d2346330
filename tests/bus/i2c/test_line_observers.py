"""Observers of a bus without a controller agent: counted bytes, records equal to those of an agent, stuck lines."""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.bus.i2c.line_observers import BusRecorder, StuckWatch
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.core.wire import Wire
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.scene.runs import TIMING, run_file


@pytest.mark.parametrize(
    ("scl", "sda", "counted"),
    [
        ("11 1" + "0100" * 9 + "0 11", "11 0" + "0000" * 9 + "0 01", 1),
        ("11 1" + "0100" * 18 + "0 11", "11 0" + "0000" * 18 + "0 01", 2),
        ("11 1" + "0100" * 8 + "0 11", "11 0" + "0000" * 8 + "0 01", 0),  # cut off by the STOP
        ("11 1" + "0100" * 9, "11 1" + "1111" * 9, 0),  # no START
    ],
)
def test_complete_bytes_between_start_and_stop_are_counted(scl, sda, counted):
    kernel = Kernel()
    lines = [Wire(kernel, name, Recorder()) for name in ("SCL", "SDA")]
    pins = [wire.attach("hand") for wire in lines]
    counter = BusRecorder(*lines)
    for pin, row in zip(pins, (scl, sda), strict=True):
        for tick, level in enumerate(row.replace(" ", "")):
            kernel.call_at(tick, lambda pin=pin, level=level: pin.drive(int(level)))
    kernel.run_until(1000)
    assert counter.bytes == counted


def recorded(name: str, seconds: str, *changes: str) -> tuple[list[Record], list[Record]]:
    """The records of a case's controller, and those of a BusRecorder on its wires."""
    found: list[Record] = []

    def subscribe(recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe([Kind.BUS], found.append)

    scene = Scene(load(TIMING / f"{name}.toml", ["budget=[]", "breaks=[]", *changes]), subscribe)
    bus = BusRecorder(scene.wires["SCL"], scene.wires["SDA"])
    scene.run(Fraction(seconds))
    assert bus.bytes == sum(r.where == "bus" and r.what in ("address", "byte") for r in found)
    return [r for r in found if r.where != "bus"], [r for r in found if r.where == "bus"]


@pytest.mark.parametrize("name", ["imu_hil_published", "late_model", "wrong_order", "real_chips"])
def test_a_recorder_of_the_wires_makes_the_records_of_the_controller(name: str):
    of_controller, of_wires = recorded(name, "0.1")
    assert [(r.what, r.value) for r in of_wires] == [(r.what, r.value) for r in of_controller] != []
    assert all(0 <= b.tick - a.tick <= 3 for a, b in zip(of_controller, of_wires, strict=True))


def test_budgets_on_the_bus_work_with_a_master_that_is_firmware():
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


@pytest.mark.parametrize(
    ("moves", "reported"),
    [
        ({10: 0}, [110]),
        ({10: 0, 109: 1}, []),
        ({10: 0, 60: 1, 90: 0}, [190]),
        ({10: 0, 60: 1, 90: 0, 150: 1, 160: 0, 240: 1}, []),
        ({10: 0, 130: 1, 200: 0}, [110, 300]),
    ],
)
def test_a_line_that_is_low_for_the_limit_is_stuck(moves: dict[int, int], reported: list[int]):
    kernel, recorder = Kernel(), Recorder()
    marks: list[int] = []
    recorder.subscribe([Kind.BUS], lambda record: marks.append(record.tick))
    wire = Wire(kernel, "SDA", recorder)
    called: list[int] = []
    StuckWatch(wire, 100, lambda line: called.append(kernel.now))
    pin = wire.attach("party")
    for tick, level in moves.items():
        kernel.call_at(tick, lambda level=level: pin.drive(level))  # type: ignore[misc]
    kernel.run_until(1000)
    assert called == reported == marks
