"""The descriptor of I2C-A. Sources: SPRS439M Tables 3-10, 3-11; SPRUG03B sections 3.1 and 3.2 (interrupts)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ...core.options import Answers
from ..descriptor import Frame, Interrupt, ModuleDescriptor
from .register_map import BASE, I2C_MAP

if TYPE_CHECKING:
    from .module import I2c

FLAGS = ("AAS", "SCD", "XRDY", "RRDY", "ARDY", "NACK", "AL")


def build(name: str, options: Mapping[str, Answers]) -> I2c:
    from .module import I2c
    from .options import I2cOptions

    given = options.get("i2c")
    return I2c(given) if isinstance(given, I2cOptions) else I2c()


def options_class() -> type[Answers]:
    from .options import I2cOptions

    return I2cOptions


I2C_A = ModuleDescriptor(
    name="I2C-A",
    registers=I2C_MAP,
    base=BASE,
    size=0x40,
    frame=Frame.PF2,
    header={"I2caRegs": 0},
    build=build,
    options="i2c",
    options_class=options_class,
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
