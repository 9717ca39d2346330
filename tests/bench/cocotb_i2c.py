"""Runs inside the Verilog simulator: cocotbext-i2c's master requests the same from its memory as the sensor head from a
chip.

BENCH_ROUNDS and BENCH_RESULT (a path) are read from the environment, and a JSON object is written to that path. One
round is three requests of nine bytes on the wire: address, pointer, address again, six data bytes. cocotbext-i2c 0.1.2
clocks at half the given speed, which does not change the bytes per second of wall time.
"""

from __future__ import annotations

import json
import logging
import os
from pathlib import Path
from time import perf_counter, process_time

import cocotb
from cocotb.triggers import Timer
from cocotbext.i2c import I2cMaster, I2cMemory

ADDRESS, COUNT, REQUESTS = 0x68, 6, 3
WIRE_BYTES = 1 + 1 + 1 + COUNT  # address and pointer, address again and data


@cocotb.test()
async def rounds(dut) -> None:
    logging.getLogger("cocotb").setLevel(logging.WARNING)  # otherwise both models log every byte
    memory = I2cMemory(sda=dut.sda, sda_o=dut.memory_sda, scl=dut.scl, scl_o=dut.memory_scl, addr=ADDRESS)
    master = I2cMaster(sda=dut.sda, sda_o=dut.master_sda, scl=dut.scl, scl_o=dut.master_scl, speed=100e3)
    expected = bytes(range(0x10, 0x10 + COUNT))
    memory.write_mem(0, expected)
    await Timer(10, "us")
    count = int(os.environ["BENCH_ROUNDS"])
    wall, cpu = perf_counter(), process_time()
    for _ in range(count * REQUESTS):
        await master.write(ADDRESS, b"\x00")
        data = await master.read(ADDRESS, COUNT)
        await master.send_stop()
        assert data == expected, f"the memory answered {data.hex()}, expected {expected.hex()}"
    found = {
        "wall": perf_counter() - wall,
        "cpu": process_time() - cpu,
        "wire_bytes": count * REQUESTS * WIRE_BYTES,
    }
    Path(os.environ["BENCH_RESULT"]).write_text(json.dumps(found))
