"""The descriptor of I2C-A. Sources: SPRS439M Tables 3-10, 3-11; SPRUG03B sections 3.1 and 3.2 (interrupts)."""

from __future__ import annotations

from ..descriptor import Frame, Interrupt, ModuleDescriptor
from .register_map import BASE, I2C_MAP

FLAGS = ("AAS", "SCD", "XRDY", "RRDY", "ARDY", "NACK", "AL")

I2C_A = ModuleDescriptor(
    name="I2C-A",
    registers=I2C_MAP,
    base=BASE,
    size=0x40,
    frame=Frame.PF2,
    header={"I2caRegs": 0},
    chip="i2c.module.I2c",
    takes=("options",),
    options="i2c",
    options_class="i2c.options.I2cOptions",
    gate="I2CAENCLK",
    interrupts=(
        Interrupt("I2CINT1A", (*(f"I2CSTR.{flag}" for flag in FLAGS), *(f"I2CIER.{flag}" for flag in FLAGS))),
        Interrupt("I2CINT2A", ("I2CFFTX.TXFFINT", "I2CFFRX.RXFFINT", "I2CFFTX.TXFFIENA", "I2CFFRX.RXFFIENA")),
    ),
    inputs=("SCLA", "SDAA"),
    outputs=("SCLA", "SDAA"),
    pins={"SDAA": 32, "SCLA": 33},
    wires={"SDA": "SDAA", "SCL": "SCLA"},
    bus=True,
)
