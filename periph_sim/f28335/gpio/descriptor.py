"""The descriptor of the GPIO module. Sources: SPRS439M Table 3-9; SPRUFB0D section 6."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ...core.options import Answers
from ..descriptor import Frame, ModuleDescriptor
from ..system.options import SystemOptions
from .register_map import BASE
from .register_map import GPIO as REGISTERS

if TYPE_CHECKING:
    from .module import Gpio


def build(name: str, options: Mapping[str, Answers]) -> Gpio:
    from .module import Gpio

    given = options.get("system")
    return Gpio(given if isinstance(given, SystemOptions) else SystemOptions())


GPIO = ModuleDescriptor(
    name="GPIO",
    registers=REGISTERS,
    base=BASE,
    size=0x80,
    frame=Frame.PF1,
    header={"GpioCtrlRegs": 0, "GpioDataRegs": 0x40, "GpioIntRegs": 0x60},
    build=build,
    input_gate="GPIOINENCLK",
    inputs=None,
)
