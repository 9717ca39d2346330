"""The descriptor of SPI-A. Sources: SPRS439M Tables 3-10, 3-11; SPRUEU3 section 1.5 (interrupts); SPRUFB0D Table 48."""

from __future__ import annotations

from ..descriptor import Frame, Interrupt, ModuleDescriptor
from .register_map import BASE, SPI_MAP

RECEIVER = (
    *("SPISTS.INT_FLAG", "SPISTS.OVERRUN_FLAG", "SPICTL.SPIINTENA", "SPICTL.OVERRUNINTENA"),
    *("SPIFFRX.RXFFINT", "SPIFFRX.RXFFOVF", "SPIFFRX.RXFFIENA"),
)

SPI_A = ModuleDescriptor(
    name="SPI-A",
    registers=SPI_MAP,
    base=BASE,
    size=0x10,
    frame=Frame.PF2,
    header={"SpiaRegs": 0},
    chip="spi.module.Spi",
    takes=("name", "options"),
    options="spi",
    options_class="spi.options.SpiOptions",
    gate="SPIAENCLK",
    clock="LSPCLK",
    interrupts=(Interrupt("SPIRXINTA", RECEIVER), Interrupt("SPITXINTA", ("SPIFFTX.TXFFINT", "SPIFFTX.TXFFIENA"))),
    inputs=("SPISIMOA", "SPISOMIA", "SPICLKA", "SPISTEA"),
    outputs=("SPISIMOA", "SPISOMIA", "SPICLKA", "SPISTEA"),
    pins={
        "SPISIMOA": 54,
        "SPISOMIA": 55,
        "SPICLKA": 56,
        "SPISTEA": 57,
    },  # not GPIO16 to 19, the other choice, because SCI-B is at GPIO18 and 19
    wires={"SIMO": "SPISIMOA", "SOMI": "SPISOMIA", "CLK": "SPICLKA", "STE": "SPISTEA"},
)
