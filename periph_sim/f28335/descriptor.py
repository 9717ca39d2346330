"""Types for the descriptions of the chip's modules (`ModuleDescriptor`) and of the chips of the family (`Part`).

    i2c/descriptor.py: I2C_A --+
    sci/descriptor.py: SCIS  --+--> parts/f28335.py: Part --> addresses, clocks, interrupts, pins, wires, options

Descriptors are read by the code that builds units, connects pins, parses names of events and checks cases, and by the
commands `why` and `regs`. To add a module, add a folder with a descriptor, a register map and a chip, and an entry in
`parts/f28335.py`. The folders without a descriptor (`cpu`, `memory` and `parts`) are not modules.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import IntEnum
from functools import cache, cached_property
from importlib import import_module
from itertools import pairwise
from typing import Any, cast

from msgspec import Struct, field

from ..core.chip import Chip
from ..core.options import Answers
from ..core.registers import RegisterMap
from .gpio.pin_mux_table import FUNCTIONS
from .pie.register_map import CPU_VECTORS, VECTORS
from .system_control.register_map import PCLKCR0, PCLKCR3

ARGUMENTS = frozenset(("name", "options"))  # arguments that a descriptor can pass to its chip's constructor
CLOCKS = ("SYSCLKOUT", "LSPCLK")
FLASH = range(0x30_0000, 0x34_0000)  # addresses of flash in the F28335, the part with the most flash


class Frame(IntEnum):
    """Peripheral frames: areas of registers with different wait states and access widths (SPRS439M Table 3-5)."""

    PF0 = 0  # PIE and CPU timers; accesses of 16 and 32 bits
    PF1 = 1  # GPIO; accesses of 16 and 32 bits
    PF2 = 2  # system control, SCI, SPI, I2C and XINT; accesses of 16 bits only


class DescriptorError(ValueError):
    """Error: the description of a module or part contradicts itself, the manual, or another module of the part."""


class Interrupt(Struct, frozen=True):
    """An interrupt of a module.

    vector: the name of the interrupt in the PIE's table of vectors.
    fields: the flags that request it and the bits that enable it, each as "REGISTER.FIELD".
    shared: True if another module can also request it.
    """

    vector: str
    fields: tuple[str, ...] = ()
    shared: bool = False


class ModuleDescriptor(Struct, frozen=True, dict=True, kw_only=True):
    """A module of the chip.

    base, size: address and length of its registers, in 16-bit words.
    header: the structures that TI's C headers declare for the module, each with its offset from `base`.
    chip: the name of the class that models the module, such as "i2c.module.I2c" in this package. It is "" for a module
        that every unit has, and which the unit itself constructs.
    takes: the arguments of the constructor of this class: "name", "options", both or none.
    options: the name of the group of options that the module uses.
    options_class: the name of the class of these options, written like `chip`.
    gate: the field of PCLKCR0 or PCLKCR3 that switches the module's clock; "" if there is none.
    input_gate: the field of PCLKCR0 or PCLKCR3 that switches the clock of its input paths only; "" if there is none.
    clock: the clock that the module runs on, "SYSCLKOUT" or "LSPCLK".
    interrupts: its interrupts, in the order of the bits of the chip's `requests`.
    inputs, outputs: the module's signals in the table of the pin multiplexer, in the order of `INPUTS` and `OUTPUTS`
        of the chip. inputs is None if any pin can affect the module, directly or by interrupts.
    pins: for each signal of the module, the GPIO number to which TI's start-up code assigns it.
    wires: for each name that a case may use, the signal of the module that has this name.
    bus: True if all units of a scene connect their modules of this name to the same wires, as on an I2C bus.
    plain: True if a case writes the names in `wires` without the module's name before them.
    """

    name: str
    registers: RegisterMap
    base: int
    size: int
    frame: Frame
    header: Mapping[str, int]
    chip: str = ""
    takes: tuple[str, ...] = ()
    options: str = "system"
    options_class: str = "system_options.SystemOptions"
    gate: str = ""
    input_gate: str = ""
    clock: str = "SYSCLKOUT"
    interrupts: tuple[Interrupt, ...] = ()
    inputs: tuple[str, ...] | None = ()
    outputs: tuple[str, ...] = ()
    pins: Mapping[str, int] = field(default_factory=dict)
    wires: Mapping[str, str] = field(default_factory=dict)
    bus: bool = False
    plain: bool = False

    def __post_init__(self) -> None:
        for register in self.registers:
            if register.offset + register.width // 16 > self.size:
                raise self._error(
                    f"register {register.name} at offset {register.offset:#x} lies beyond its {self.size} words"
                )
        for interrupt in self.interrupts:
            if interrupt.vector not in VECTORS:
                raise self._error(f"there is no interrupt {interrupt.vector!r} in the PIE's table")
            if not 0 < CPU_VECTORS.get(interrupt.vector, 1) <= CPU_VECTORS["NMI"]:
                raise self._error(f"no module can request {interrupt.vector}, which the CPU itself raises")
            for name in interrupt.fields:
                register_name, _, field_name = name.partition(".")
                if register_name not in self.registers or field_name not in self.registers[register_name]:
                    raise self._error(f"{interrupt.vector} names {name}, which is no field of its registers")
        if unknown := set(self.takes) - ARGUMENTS:
            raise self._error(f"its chip takes {', '.join(sorted(unknown))}; expected {', '.join(sorted(ARGUMENTS))}")
        if self.clock not in CLOCKS:
            raise self._error(f"its clock is {self.clock!r}; expected {' or '.join(CLOCKS)}")
        for gate in filter(None, (self.gate, self.input_gate)):
            if gate not in PCLKCR0 and gate not in PCLKCR3:
                raise self._error(f"there is no field {gate!r} in PCLKCR0 or PCLKCR3")
        signals = dict.fromkeys((*(self.inputs or ()), *self.outputs))
        for signal in signals:
            if not 0 <= self.pins.get(signal, -1) < len(FUNCTIONS):
                raise self._error(f"signal {signal} has no pin")
            if signal not in FUNCTIONS[self.pins[signal]]:
                raise self._error(f"the multiplexer does not offer {signal} at GPIO{self.pins[signal]}")
        for signal in (*self.pins, *self.wires.values()):
            if signal not in signals:
                raise self._error(f"{signal} is neither among its inputs nor among its outputs")

    def build(self, options: Mapping[str, Answers]) -> Chip:
        """Return a new chip. options: the unit's answers, by group of options; missing groups have the defaults."""
        given = options.get(self.options)
        values: dict[str, Callable[[], object]] = {
            "name": lambda: self.name,
            "options": lambda: named_class(self.options_class)() if given is None else given,
        }
        return cast(Chip, named_class(self.chip)(*(values[one]() for one in self.takes)))

    def _error(self, what: str) -> DescriptorError:
        return DescriptorError(f"descriptor of {self.name}: {what}")


@cache
def named_class(name: str) -> Any:
    """Return the class with a name like "i2c.module.I2c" in this package. Its module is imported on first use."""
    module, _, attribute = name.rpartition(".")
    return getattr(import_module(f"{__package__}.{module}"), attribute)


class Part(Struct, frozen=True, dict=True):
    """A chip of the family.

    modules: its modules, in the order in which they are listed to users.
    flash: the addresses of its flash. Parts differ only in `part_id` and in the start of this range: a smaller flash
        lacks the low addresses of the F28335's flash.
    part_id: the value at the address PARTID (0x380090), by which firmware identifies the chip.
    """

    name: str
    modules: tuple[ModuleDescriptor, ...]
    flash: range
    part_id: int

    def __post_init__(self) -> None:
        if not (self.flash and self.flash.start >= FLASH.start and self.flash.stop == FLASH.stop):
            raise DescriptorError(
                f"{self.name}: its flash is at {self.flash.start:#08x} to {self.flash.stop - 1:#08x}; "
                f"expected the end of {FLASH.start:#08x} to {FLASH.stop - 1:#08x}"
            )
        self._refuse_twice("name", [(one.name, one) for one in self.modules])
        self._refuse_twice("interrupt", [(i.vector, m) for m in self.modules for i in m.interrupts if not i.shared])
        self._refuse_twice("start-up pin", [(f"GPIO{pin}", one) for one in self.modules for pin in one.pins.values()])
        for before, after in pairwise(sorted(self.modules, key=lambda one: one.base)):
            if before.base + before.size > after.base:
                raise DescriptorError(f"{self.name}: {after.name} at {after.base:#06x} overlaps {before.name}")

    def _refuse_twice(self, what: str, found: list[tuple[str, ModuleDescriptor]]) -> None:
        seen: dict[str, ModuleDescriptor] = {}
        for name, module in found:
            if name in seen:
                raise DescriptorError(f"{self.name}: {seen[name].name} and {module.name} have the same {what} {name}")
            seen[name] = module

    @cached_property
    def by_name(self) -> dict[str, ModuleDescriptor]:
        return {one.name: one for one in self.modules}

    @cached_property
    def selectable(self) -> tuple[str, ...]:
        """Names of the modules that a unit has only if its key `modules` in the case names them."""
        return tuple(one.name for one in self.modules if one.chip)

    @cached_property
    def in_every_unit(self) -> tuple[str, ...]:
        """Names of the modules that every unit has."""
        return tuple(one.name for one in self.modules if not one.chip)

    @cached_property
    def pins(self) -> dict[str, int]:
        """GPIO number of each signal, as assigned by TI's start-up code."""
        return {signal: pin for one in self.modules for signal, pin in one.pins.items()}

    @cached_property
    def options_groups(self) -> dict[str, str]:
        """For each group of options, the name of its class, as in `ModuleDescriptor.options_class`."""
        return dict(sorted((one.options, one.options_class) for one in self.modules))

    def options_classes(self) -> dict[str, type[Answers]]:
        """Return the class of each group of options."""
        return {group: named_class(name) for group, name in self.options_groups.items()}

    def requesters(self, vector: str) -> dict[str, Interrupt]:
        """Return the `Interrupt` of each module that can request the interrupt `vector`, by the module's name."""
        return {one.name: found for one in self.modules for found in one.interrupts if found.vector == vector}
