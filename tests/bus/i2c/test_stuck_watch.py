"""A line that stays low for too long is told once, with a record; one that moves in time is not."""

from __future__ import annotations

import pytest

from periph_sim.bus.i2c.stuck_watch import StuckWatch
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Recorder
from periph_sim.core.wire import Wire


@pytest.mark.parametrize(
    ("moves", "told"),
    [
        ({10: 0}, [110]),
        ({10: 0, 109: 1}, []),
        ({10: 0, 60: 1, 90: 0}, [190]),
        ({10: 0, 60: 1, 90: 0, 150: 1, 160: 0, 240: 1}, []),
        ({10: 0, 130: 1, 200: 0}, [110, 300]),
    ],
)
def test_a_line_is_stuck_from_the_limit_on(moves: dict[int, int], told: list[int]):
    kernel, recorder = Kernel(), Recorder()
    marks: list[int] = []
    recorder.subscribe([Kind.BUS], lambda record: marks.append(record.tick))
    wire = Wire(kernel, "SDA", recorder)
    came: list[int] = []
    StuckWatch(kernel, recorder, wire, 100, lambda line: came.append(kernel.now))
    pin = wire.attach("somebody")
    for tick, level in moves.items():
        kernel.call_at(tick, lambda level=level: pin.drive(level))  # type: ignore[misc]
    kernel.run_until(1000)
    assert came == told == marks
