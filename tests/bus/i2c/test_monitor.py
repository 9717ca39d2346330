"""A monitor of a bus reports the same transfers as the controller of the bus."""

from __future__ import annotations

import pytest

from periph_sim.bus.i2c.controller import I2cController
from periph_sim.bus.i2c.monitor import I2cMonitor
from periph_sim.bus.i2c.replayed_sides import Answer, ScriptedTarget
from periph_sim.bus.i2c.transfer import BusTiming, Phase, Transfer
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.wire import Wire


def both(answers: dict[int, list[Answer]], *transfers: list[Phase]) -> tuple[list[Transfer], list[Transfer]]:
    """The transfers that the controller reports, and those that the monitor reports."""
    kernel, recorder = Kernel(), Recorder()
    scl, sda = Wire(kernel, "SCL", recorder), Wire(kernel, "SDA", recorder)
    ScriptedTarget(kernel, scl, sda, answers, hold=30)
    controller = I2cController(kernel, recorder, scl, sda, BusTiming(100, 100, 20, 100, 100, 100, 200))

    monitored: list[Transfer] = []
    I2cMonitor(scl, sda, monitored.append, {0x53: "accelerometer"})
    done: list[Transfer] = []
    for phases in transfers:
        controller.begin(Transfer("accelerometer", phases), done.append)
        kernel.run_until(kernel.now + 100_000)
    return done, monitored


READ, WRITE = Phase(0x53, True, count=2), Phase(0x53, False, data=b"\x32\x07")


@pytest.mark.parametrize(
    ("answers", "transfers"),
    [
        ([Answer(True, b"\x12\x34")], [[READ]]),
        ([Answer(True, acks=(True, False))], [[WRITE]]),
        ([Answer(True), Answer(True, b"\x80\x7f")], [[WRITE, READ]]),
        ([Answer(False)], [[READ]]),
        ([Answer(False), Answer(True, b"\x01\x02")], [[WRITE], [READ]]),
    ],
)
def test_transfers_are_those_of_the_controller(answers: list[Answer], transfers: list[list[Phase]]):
    copies = [[Phase(p.address, p.read, p.data, p.count) for p in phases] for phases in transfers]
    done, monitored = both({0x53: answers}, *copies)
    assert len(monitored) == len(transfers)
    for own, seen in zip(done, monitored, strict=True):
        assert (seen.name, seen.stop_at, seen.acked) == ("accelerometer", own.stop_at, own.acked)
        for mine, theirs in zip(own.phases, seen.phases, strict=True):
            assert (theirs.address, theirs.read, theirs.acked) == (mine.address, mine.read, mine.acked)
            assert (theirs.got, theirs.acks, theirs.start_at) == (mine.got, mine.acks, mine.start_at)
            assert theirs.answer_from == mine.answer_from
            if mine.read and mine.acked:
                assert theirs.answer_at == mine.answer_at
