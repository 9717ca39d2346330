"""cocotb test: a sensor head in Verilog reads the IMU emulator, and each value that it reads is that of a host frame.

    simulate(["sensor_head.v", "i2c_master.v"], "sensor_head", "timing.rtl.bench_imu", folder="build")

The head replaces the [controller] of the case. The budgets of the case are judged from the wires.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from periph_sim.cosim import F28335

CASE = Path(__file__).with_name("imu_hil_rtl.toml")
CHIPS = ("gyroscope", "accelerometer", "magnetometer")


def shown(values: tuple[int, ...]) -> tuple[bytes, bytes, bytes]:
    """Return the bytes of the three chips for a frame of roll, pitch, yaw and three accelerations."""
    roll, pitch, yaw, *accelerations = values
    angles = struct.pack(">3h", roll, pitch, yaw)
    return angles, struct.pack("<3h", *accelerations), struct.pack(">3h", roll, yaw, pitch)


@cocotb.test()
async def every_value_is_that_of_the_frame_before(dut: Any) -> None:
    dsp = F28335(dut, CASE, scl=dut.scl, scl_o=dut.dsp_scl, sda=dut.sda, sda_o=dut.dsp_sda, log="outside.jsonl")
    frames = [(0,) * 6]  # the chips show zeros before the first frame
    dsp.session.scene.on_frame(lambda number, values, tick: frames.append(values))
    reads: list[tuple[int, bytes, int]] = []  # place in the round, data, number of frames so far

    async def head() -> None:
        while True:
            await RisingEdge(dut.read)
            await RisingEdge(dut.clk)
            assert not int(dut.refused.value), "a chip did not acknowledge"
            reads.append((int(dut.read_chip.value), int(dut.read_data.value).to_bytes(6, "big"), len(frames)))

    cocotb.start_soon(head())
    result = await dsp.finished()
    assert [place for place, _, _ in reads] == [0, 1, 2] * (len(reads) // 3) and len(reads) >= 30
    newest = []
    for place, data, count in reads:
        known = [number for number in range(count) if shown(frames[number])[place] == data]
        assert known, f"the {CHIPS[place]} gave {data.hex(' ')}, which is of no frame so far"
        newest.append(known[-1])
    assert newest == sorted(newest), "a value is older than the one read before it"
    assert newest[-1] >= len(frames) - 4
    for name, verdict in [(one.name, one.verdict) for one in result.budgets]:
        assert verdict == "pass", f"{name}: {verdict}"
    dut._log.info("%d rounds, %d bytes, %s", result.counts["rounds"], result.wire_bytes, result.notes[0])
