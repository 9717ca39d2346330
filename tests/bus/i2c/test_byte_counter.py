"""Bytes are counted from the edges alone."""

from __future__ import annotations

import pytest

from periph_sim.bus.i2c.byte_counter import I2cByteCounter
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.wire import Wire


@pytest.mark.parametrize(
    ("scl", "sda", "counted"),
    [
        ("11 1" + "0100" * 9 + "0 11", "11 0" + "0000" * 9 + "0 01", 1),
        ("11 1" + "0100" * 18 + "0 11", "11 0" + "0000" * 18 + "0 01", 2),
        ("11 1" + "0100" * 8 + "0 11", "11 0" + "0000" * 8 + "0 01", 0),  # cut off by the STOP
        ("11 1" + "0100" * 9, "11 1" + "1111" * 9, 0),  # no START
    ],
)
def test_whole_bytes_between_start_and_stop_count(scl, sda, counted):
    kernel = Kernel()
    lines = [Wire(kernel, name, Recorder()) for name in ("SCL", "SDA")]
    pins = [wire.attach("hand") for wire in lines]
    counter = I2cByteCounter(*lines)
    for pin, row in zip(pins, (scl, sda), strict=True):
        for tick, level in enumerate(row.replace(" ", "")):
            kernel.call_at(tick, lambda pin=pin, level=level: pin.drive(int(level)))
    kernel.run_until(1000)
    assert counter.bytes == counted
