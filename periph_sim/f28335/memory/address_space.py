"""Contents of the address space: the kind of memory, or the name of the register, at each address.

This is the whole space of the chip; `memory_map` has only the modules that a scene names. Parts of the family with less
flash than the F28335 have nothing at the low addresses of flash. Words have 16 bits.

Registers of modelled modules have names such as "I2C-A.I2CMDR". Other modules have such names only for some registers
that firmware polls or writes when it sets up the chip. Any other register is named by its module and offset, such as
"ADC + 0x01".

Source: SPRS439M Figure 3-2, Tables 3-1, 3-5, 3-8 to 3-11, SPRUFB0D Tables 86 to 96; the addresses in the linker command
files that TI ships.
"""

from __future__ import annotations

from bisect import bisect_right
from enum import Enum
from typing import NamedTuple

from ..descriptor import FLASH, ModuleDescriptor, Part
from ..parts.f28335 import PART
from ..pie import register_map as pie_map
from .ram import BLOCKS


class Content(Enum):
    RAM = "memory"
    FLASH = "flash"
    OTP = "one-time programmable memory"
    EXTERNAL = "external memory, if the board has it"
    ROM = "ROM"
    REGISTERS = "peripheral registers"


class Area(NamedTuple):
    name: str
    base: int
    size: int
    content: Content

    @property
    def end(self) -> int:
        return self.base + self.size


AREAS = tuple(
    sorted(
        (
            *(
                Area(block.name, block.base, block.size, Content.REGISTERS if block.protected else Content.RAM)
                for block in BLOCKS
            ),
            Area("peripheral frame 0", 0x000800, 0x500, Content.REGISTERS),
            Area("peripheral frame 0", 0x000E00, 0x1200, Content.REGISTERS),
            Area("XINTF zone 0", 0x004000, 0x1000, Content.EXTERNAL),
            Area("peripheral frame 3", 0x005000, 0x1000, Content.REGISTERS),
            Area("peripheral frame 1", 0x006000, 0x1000, Content.REGISTERS),
            Area("peripheral frame 2", 0x007000, 0x1000, Content.REGISTERS),
            Area("XINTF zone 6", 0x100000, 0x100000, Content.EXTERNAL),
            Area("XINTF zone 7", 0x200000, 0x100000, Content.EXTERNAL),
            Area("flash", FLASH.start, len(FLASH), Content.FLASH),
            Area("ADC calibration", 0x380080, 0x10, Content.ROM),
            Area("PARTID", 0x380090, 1, Content.ROM),
            Area("user OTP", 0x380400, 0x400, Content.OTP),
            Area("L0 to L3 again", 0x3F8000, 0x4000, Content.RAM),
            Area("boot ROM", 0x3FE000, 0x2000, Content.ROM),
        ),
        key=lambda area: area.base,
    )
)
_BASES = [area.base for area in AREAS]

OTHER_PARTS = (  # memory of other C28x parts at addresses where the F28335 has nothing
    (range(0x01_0000, 0x02_0000), "an F2806x and an F2837x have memory there"),
    (range(0x08_0000, 0x10_0000), "an F2837x has its flash there"),
    (range(0x3D_8000, 0x3F_8000), "an F281x, F280x, F2803x or F2806x has its flash there"),
)
LOADABLE = frozenset((Content.RAM, Content.FLASH, Content.OTP, Content.EXTERNAL))


def area_at(address: int) -> Area | None:
    """Return the area that contains an address of the F28335; None if the chip has nothing there."""
    at = bisect_right(_BASES, address) - 1
    return AREAS[at] if at >= 0 and address < AREAS[at].end else None


def not_loadable(base: int, size: int, part: Part) -> str:
    """Return why words cannot be loaded at these addresses of a part, as the end of a sentence; "" if they can be."""
    address = base
    while address < base + size:
        area = area_at(address)
        if area is None:
            others = "".join(
                f"; {what}, so link it for the {part.name}" for where, what in OTHER_PARTS if address in where
            )
            return f"at {address:#08x}, where the {part.name} has nothing{others}"
        if area.content is Content.FLASH and address < part.flash.start:
            return f"at {address:#08x}, where the {part.name} has nothing; its flash begins at {part.flash.start:#08x}"
        if area.content not in LOADABLE:
            return f"at {address:#08x}, over {area.content.value} ({area.name})"
        address = area.end
    return ""


class UnmodelledModule(NamedTuple):
    """Addresses of a module that is not modelled."""

    name: str
    base: int
    size: int


NOT_MODELLED = (
    UnmodelledModule("device emulation", 0x0880, 0x180),
    UnmodelledModule("flash control", 0x0A80, 0x60),
    UnmodelledModule("CSM", 0x0AE0, 0x10),
    UnmodelledModule("ADC results", 0x0B00, 0x10),
    UnmodelledModule("XINTF", 0x0B20, 0x20),
    UnmodelledModule("DMA", 0x1000, 0x200),
    UnmodelledModule("McBSP-A", 0x5000, 0x40),
    UnmodelledModule("McBSP-B", 0x5040, 0x40),
    UnmodelledModule("eCAN-A", 0x6000, 0x200),
    UnmodelledModule("eCAN-B", 0x6200, 0x200),
    *(UnmodelledModule(f"ePWM{number}", 0x6800 + 0x40 * (number - 1), 0x40) for number in range(1, 7)),
    *(UnmodelledModule(f"eCAP{number}", 0x6A00 + 0x20 * (number - 1), 0x20) for number in range(1, 7)),
    UnmodelledModule("eQEP1", 0x6B00, 0x40),
    UnmodelledModule("eQEP2", 0x6B40, 0x40),
    UnmodelledModule("ADC", 0x7100, 0x20),
)

NAMES = {
    0x0A80: "FOPT", 0x0A82: "FPWR", 0x0A83: "FSTATUS", 0x0A84: "FSTDBYWAIT", 0x0A85: "FACTIVEWAIT",
    0x0A86: "FBANKWAIT", 0x0A87: "FOTPWAIT", 0x0AEF: "CSMSCR",
    0x7100: "ADCTRL1", 0x7101: "ADCTRL2", 0x7118: "ADCTRL3", 0x7119: "ADCST",
}  # fmt: skip
# Modules that are not modelled and whose registers are all EALLOW-protected.
PROTECTED_MODULES = frozenset(("device emulation", "flash control", "CSM", "XINTF", "DMA"))

MODULES: tuple[ModuleDescriptor | UnmodelledModule, ...] = (*PART.modules, *NOT_MODELLED)
VECTORS = "PIE vectors"


def module_at(address: int) -> ModuleDescriptor | UnmodelledModule | None:
    """Return the module whose registers include an address; None if there is none."""
    return next((module for module in MODULES if 0 <= address - module.base < module.size), None)


def register_name(address: int) -> tuple[str, str]:
    """Return the names (module, register) for an address.

    A register without a name has its offset in place of the name, such as "+0x01". Outside all modules, `module` is ""
    and `register` is the address, such as "0x000900".
    """
    if address in pie_map.VECTOR_TABLE:
        return VECTORS, f"+{address - pie_map.VECTOR_TABLE.start:#04x}"
    module = module_at(address)
    if module is None:
        return "", f"{address:#08x}"
    offset = address - module.base
    if isinstance(module, ModuleDescriptor):
        for back in (0, 1):
            register = module.registers.at(offset - back)
            if register is not None and register.width > 16 * back:
                return module.name, register.name
    return module.name, NAMES.get(address, f"+{offset:#04x}")


def full_name(address: int) -> str:
    """Return a name like "ADC.ADCST" or "eCAN-A + 0x08"; outside all modules, the address as text."""
    module, name = register_name(address)
    if not module:
        return name
    return f"{module} + {name[1:]}" if name.startswith("+") else f"{module}.{name}"


def address_of(text: str) -> int | None:
    """Return the address for a text like "ADC.ADCST", "eCAN-A + 0x08" or "0x7119"; None if nothing has that name."""
    module, plus, offset = (part.strip() for part in text.partition("+"))
    if not plus:
        module, _, name = (part.strip() for part in text.partition("."))
        if not name:
            return _number(module)
    known = next((one for one in MODULES if one.name == module), None)
    if known is None:
        return None
    if plus:
        number = _number(offset)
        return known.base + number if number is not None and 0 <= number < known.size else None
    addresses = range(known.base, known.base + known.size)
    return next((address for address in addresses if register_name(address)[1] == name), None)


def _number(text: str) -> int | None:
    try:
        return int(text, 0)
    except ValueError:
        return None


def is_protected(address: int) -> bool:
    """Return True if a write at an address needs EALLOW.

    A module that is not modelled counts as unprotected unless all of its registers are protected.
    """
    if address in pie_map.VECTOR_TABLE:
        return True
    module = module_at(address)
    if module is None:
        return False
    if isinstance(module, UnmodelledModule):
        return module.name in PROTECTED_MODULES
    register = module.registers.at(address - module.base) or module.registers.at(address - module.base - 1)
    return register is not None and register.protected
