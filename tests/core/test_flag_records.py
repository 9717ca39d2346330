"""Changes of register fields are recorded in each word of a register, with the causing write as their cause."""

from __future__ import annotations

import pytest

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.f28335.cpu.code_costs import BARE
from periph_sim.f28335.i2c.register_map import I2C_MAP
from periph_sim.processor.dsp import Dsp, DspPlan


@pytest.mark.parametrize("pin", [12, 15, 16, 28, 31, 32, 47, 48, 63])
def test_a_pin_of_either_half_of_a_port_records_its_changes(pin: int):
    """GPxDIR and GPxDAT are 32 bits wide; an output shows in GPxDAT."""
    kernel, recorder, seen = Kernel(), Recorder(), list[Record]()
    recorder.subscribe([Kind.FLAG, Kind.ACCESS], seen.append)
    dsp = Dsp(kernel, Timebase(150_000_000), recorder, DspPlan("dsp", ("GPIO",), {}, code=BARE))
    port, name = "AB"[pin // 32], f"GPIO{pin}"

    def main() -> None:
        gpio = dsp.module("GPIO")
        dsp.eallow()
        setattr(getattr(gpio, f"GP{port}DIR"), name, 1)
        dsp.edis()
        for register in ("SET", "CLEAR"):
            dsp.compute(100)
            setattr(getattr(gpio, f"GP{port}{register}"), name, 1)
        dsp.compute(100)

    dsp.start(main)
    kernel.run_until(kernel.now + 100_000)
    number = {record.number: record for record in seen}
    changes = [(r.what, r.value, number[r.cause].what[2:]) for r in seen if r.kind is Kind.FLAG and name in r.what]
    assert changes == [
        (f"GP{port}DIR.{name}", 1, f"GPIO.GP{port}DIR"),
        (f"GP{port}DAT.{name}", 0, f"GPIO.GP{port}DIR"),  # the latch is 0 after reset
        (f"GP{port}DAT.{name}", 1, f"GPIO.GP{port}SET"),
        (f"GP{port}DAT.{name}", 0, f"GPIO.GP{port}CLEAR"),
    ]


@pytest.mark.parametrize("name", ["I2COAR", "I2CIER", "I2CCLKL", "I2CCLKH", "I2CSAR", "I2CPSC", "I2CCNT"])
def test_a_register_without_hardware_effects_records_its_writes_and_its_reset(name: str):
    kernel, recorder, seen = Kernel(), Recorder(), list[Record]()
    recorder.subscribe([Kind.FLAG], seen.append)
    dsp = Dsp(kernel, Timebase(150_000_000), recorder, DspPlan("dsp", ("I2C-A",), {}, code=BARE))

    def main() -> None:
        dsp.eallow()
        dsp.module("SYS").PCLKCR0.I2CAENCLK = 1
        dsp.edis()
        i2c = dsp.module("I2C-A")
        for value in (0x15, 0x2A):
            getattr(i2c, name).all = value
            dsp.compute(100)

    dsp.start(main)
    kernel.run_until(kernel.now + 10_000)
    changes = [r.what for r in seen if r.what.startswith(f"{name}.")]
    socket = dsp.sockets["I2C-A"]
    held = socket.peek(100, I2C_MAP[name].offset)
    assert changes and held == 0x2A & sum(field.mask for field in I2C_MAP[name].fields)
    seen.clear()
    socket.chip.reset(1000)
    socket.publish(1000)
    assert [r.what for r in seen if r.what.startswith(f"{name}.")]
