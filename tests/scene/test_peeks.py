"""A debugger that reads registers has no effect: the records are equal with and without its peeks."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from random import Random

import pytest

from periph_sim import Case, Dsp, Scene, load
from periph_sim.core.kernel import CHIP, PROBE, TIMER
from periph_sim.core.records import RECORDED, Recorder
from periph_sim.core.time import Timebase
from periph_sim.cosim.registers import peek
from tests.scene import small
from tests.scene.runs import TIMING

Records = list[tuple[object, ...]]


def records(case: Case, seconds: str, phase: int, peeks: list[int]) -> Records:
    """Return all records of a run in which every register of every module is read at these ticks."""
    found: Records = []

    def keep(recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe(
            RECORDED, lambda r: found.append((r.number, r.tick, r.kind, r.where, r.what, r.value, r.cause))
        )

    scene = Scene(case, keep)
    places = [
        f"dsp.{module}.{register.name}"
        for module in case.unit["dsp"].modules
        for register in scene.units["dsp"].sockets[module].chip.MAP
    ]
    for tick in peeks:
        for place in places:
            scene.kernel.call_at(tick, partial(peek, scene, place), phase)
    scene.run(Fraction(seconds))
    return found


@pytest.mark.parametrize("phase", [TIMER, CHIP, PROBE])
@pytest.mark.parametrize(
    ("name", "seconds"), [("imu_hil", "0.0025"), ("responder", "0.0015"), ("uart_logger", "0.003")]
)
def test_peeks_at_and_close_to_the_times_of_records_change_none(name: str, seconds: str, phase: int):
    """The peeks are at times when a chip wakes, also in the cycle that begins next; a cycle is 20 ticks."""
    case = load(TIMING / f"{name}.toml")
    plain = records(case, seconds, phase, [])
    random = Random(phase)
    instants = sorted({int(record[1]) for record in plain if int(record[1]) > 20})
    assert len(instants) > 50
    peeks = [tick - random.choice((0, 0, 1, 19)) for tick in random.sample(instants, min(len(instants), 60))]
    assert records(case, seconds, phase, peeks) == plain


def test_reading_a_value_for_a_budget_touches_no_open_question():
    """The value of I2COAR without a clock is an open question. GPIO28 is in the upper half of a register of 32 bits."""

    def main(dsp: Dsp) -> None:
        dsp.eallow()
        dsp.module("GPIO").GPAMUX2.GPIO28 = 1
        dsp.compute(1000)

    scene = small.scene_with(main, ["I2C-A", "GPIO"])
    scene.run()
    assert scene.measured.value_of("dsp.I2C-A", "I2COAR.OAR") == 0
    assert scene.measured.value_of("dsp.GPIO", "GPAMUX2.GPIO28") == 1
    assert not scene.units["dsp"].sockets["I2C-A"].chip.touched
