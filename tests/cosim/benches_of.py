"""Test benches that run inside a simulator; tests of pytest choose one by its name."""

from __future__ import annotations

import json
from typing import Any

import cocotb
from cocotb.triggers import Timer

from periph_sim.cosim import F28335
from tests.cosim.benches import case, told


@cocotb.test()
async def i2c_master(dut: Any) -> None:
    """cocotbext-i2c's master asks the responder, at all phases of what else runs."""
    from cocotbext.i2c import I2cMaster

    folder, settings = told()
    dsp = F28335(
        dut,
        case(),
        scl=dut.scl,
        scl_o=dut.dsp_scl,
        sda=dut.sda,
        sda_o=dut.dsp_sda,
        log=folder / "outside.jsonl",
        record=folder / "live.jsonl",
    )
    master = I2cMaster(sda=dut.sda, sda_o=dut.other_sda, scl=dut.scl, scl_o=dut.other_scl, speed=settings["speed"])
    await Timer(1, "ms")
    got = []
    for _ in range(settings["rounds"]):
        await master.write(0x50, b"\x00")
        got.append(list(await master.read(0x50, 4)))
        await master.send_stop()
    await Timer(1, "ms")
    (folder / "found.json").write_text(
        json.dumps({"got": got, "wire_bytes": dsp.result.wire_bytes, "nacked": dsp.result.counts["nacked"]})
    )
