"""The descriptor of the GPIO module. Sources: SPRS439M Table 3-9; SPRUFB0D section 6."""

from __future__ import annotations

from ..descriptor import Frame, ModuleDescriptor
from .register_map import BASE
from .register_map import GPIO as REGISTERS

GPIO = ModuleDescriptor(
    name="GPIO",
    registers=REGISTERS,
    base=BASE,
    size=0x80,
    frame=Frame.PF1,
    header={"GpioCtrlRegs": 0, "GpioDataRegs": 0x40, "GpioIntRegs": 0x60},
    chip="gpio.module.Gpio",
    takes=("options",),
    input_gate="GPIOINENCLK",
    inputs=None,
)
