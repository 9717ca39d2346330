"""The bench of `cost`, which runs within a simulator."""

from __future__ import annotations

import json
import logging
import os
from time import process_time
from typing import Any

import cocotb
from cocotb.triggers import Timer
from cocotbext.i2c import I2cMaster, I2cMemory

from periph_sim.cosim import F28335
from tests.cosim.benches import run_settings
from tests.cosim.cost import CHIPS, MEMORY, ROUND, cases


@cocotb.test()
async def rounds(dut: Any) -> None:
    folder, asked = run_settings()
    party = asked["party"]
    logging.getLogger("cocotb").setLevel(logging.WARNING)
    addresses, dsp = CHIPS, None
    lines = {"scl": dut.scl, "scl_o": dut.dsp_scl, "sda": dut.sda, "sda_o": dut.dsp_sda}
    if party == MEMORY:
        memory = I2cMemory(**lines, addr=CHIPS[0])
        memory.write_mem(0, bytes.fromhex(ROUND[0]))
    else:
        dsp = F28335(dut, cases()[party], **lines)
    if party == MEMORY or "register" in party:
        addresses = CHIPS[:1] * 3
    master = I2cMaster(sda=dut.sda, sda_o=dut.other_sda, scl=dut.scl, scl_o=dut.other_scl, speed=200e3)
    await Timer(2, "ms")
    begin = process_time()
    profile = None
    if "COST_PROFILE" in os.environ:
        import cProfile

        profile = cProfile.Profile()
        profile.enable()
    for number in range(asked["rounds"]):
        await Timer(17_000_000 + number * 7_919, "ns")
        for address in addresses:
            await master.write(address, b"\x00")
            data = await master.read(address, 6)
            await master.send_stop()
            assert data == bytes.fromhex(ROUND[CHIPS.index(address)]), data.hex()
            await Timer(60, "us")
    if profile is not None:
        profile.disable()
        profile.dump_stats(os.environ["COST_PROFILE"])
    found = {"seconds": process_time() - begin, "wakes": 0 if dsp is None else dsp.wakes}
    (folder / "found.json").write_text(json.dumps(found))
