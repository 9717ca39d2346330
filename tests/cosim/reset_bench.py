"""Benches whose line RX is x until a reset: before it, RX has the requested level; an x after it is an error."""

from __future__ import annotations

from typing import Any

import cocotb
from cocotb.handle import Immediate
from cocotb.triggers import Timer
from cocotb.types import Logic

from periph_sim import make_case
from periph_sim.cosim import F28335, OutsideError
from tests.outside.sessions import refuses

CASE = make_case(name="reset", duration="1 ms", unit={"dsp": {"firmware": "sci_echo", "modules": ["SCI-A"]}})


@cocotb.test()
async def x_until_reset(dut: Any) -> None:
    refuses("before_reset is 2; expected 0 or 1", F28335, dut, CASE, rx=dut.rx, before_reset=2)
    high, low = (F28335(dut, CASE, rx=dut.rx, before_reset=level) for level in (1, 0))
    await Timer(200, "us")
    dut.rx.value = Immediate(1)
    await Timer(200, "us")
    assert [dsp.peek("SCI-A.SCIRXST.FE") for dsp in (high, low)] == [0, 1]


@cocotb.test(expect_error=OutsideError)
async def x_after_reset(dut: Any) -> None:
    F28335(dut, CASE, rx=dut.rx, before_reset=1)
    await Timer(1, "us")
    dut.rx.value = Immediate(1)
    await Timer(1, "us")
    dut.rx.value = Immediate(Logic("X"))
    await Timer(1, "us")
