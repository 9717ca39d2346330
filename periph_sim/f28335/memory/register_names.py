"""Names of all peripheral registers of the F28335 by address, such as "I2C-A.I2CMDR" or "ADC + 0x01".

Registers of modelled modules have names, as do those that firmware polls or uses to set up the chip; for the others,
only the module and the offset in it are known.

Source: SPRS439M Tables 3-8 to 3-11, SPRUFB0D Tables 86 to 96; the bases of the linker command files that TI ships.
"""

from __future__ import annotations

from typing import NamedTuple

from ...core.registers import RegisterMap
from ..parts.f28335 import PART
from ..pie import register_map as pie_map


class Module(NamedTuple):
    """Addresses of a module. registers: None if the module is not modelled."""

    name: str
    base: int
    size: int
    registers: RegisterMap | None = None


MODELLED = tuple(Module(one.name, one.base, one.size, one.registers) for one in PART.modules)

NOT_MODELLED = (
    Module("device emulation", 0x0880, 0x180),
    Module("flash control", 0x0A80, 0x60),
    Module("CSM", 0x0AE0, 0x10),
    Module("ADC results", 0x0B00, 0x10),
    Module("XINTF", 0x0B20, 0x20),
    Module("DMA", 0x1000, 0x200),
    Module("McBSP-A", 0x5000, 0x40),
    Module("McBSP-B", 0x5040, 0x40),
    Module("eCAN-A", 0x6000, 0x200),
    Module("eCAN-B", 0x6200, 0x200),
    *(Module(f"ePWM{number}", 0x6800 + 0x40 * (number - 1), 0x40) for number in range(1, 7)),
    *(Module(f"eCAP{number}", 0x6A00 + 0x20 * (number - 1), 0x20) for number in range(1, 7)),
    Module("eQEP1", 0x6B00, 0x40),
    Module("eQEP2", 0x6B40, 0x40),
    Module("ADC", 0x7100, 0x20),
)

NAMES = {
    0x0A80: "FOPT", 0x0A82: "FPWR", 0x0A83: "FSTATUS", 0x0A84: "FSTDBYWAIT", 0x0A85: "FACTIVEWAIT",
    0x0A86: "FBANKWAIT", 0x0A87: "FOTPWAIT", 0x0AEF: "CSMSCR",
    0x7100: "ADCTRL1", 0x7101: "ADCTRL2", 0x7118: "ADCTRL3", 0x7119: "ADCST",
}  # fmt: skip
PROTECTED_MODULES = frozenset(("device emulation", "flash control", "CSM", "XINTF", "DMA"))  # as a whole

MODULES = tuple(sorted((*MODELLED, *NOT_MODELLED), key=lambda module: module.base))
VECTORS = "PIE vectors"


def module_at(address: int) -> Module | None:
    """Return the module whose registers include an address; None if there is none."""
    return next((module for module in MODULES if 0 <= address - module.base < module.size), None)


def register_name(address: int) -> tuple[str, str]:
    """Return (module, register) at an address; "+0x01" for an unnamed one, ("", "0x000900") outside all modules."""
    if address in pie_map.VECTOR_TABLE:
        return VECTORS, f"+{address - pie_map.VECTOR_TABLE.start:#04x}"
    module = module_at(address)
    if module is None:
        return "", f"{address:#08x}"
    offset = address - module.base
    if module.registers is not None:
        for back in (0, 1):
            register = module.registers.at(offset - back)
            if register is not None and register.width > 16 * back:
                return module.name, register.name
    return module.name, NAMES.get(address, f"+{offset:#04x}")


def full_name(address: int) -> str:
    """Return a name like "ADC.ADCST" or "eCAN-A + 0x08"; the address itself outside all modules."""
    module, name = register_name(address)
    if not module:
        return name
    return f"{module} + {name[1:]}" if name.startswith("+") else f"{module}.{name}"


def address_of(text: str) -> int | None:
    """Return the address of "ADC.ADCST", "eCAN-A + 0x08" or "0x7119"; None if nothing has that name."""
    module, plus, offset = (part.strip() for part in text.partition("+"))
    if not plus:
        module, _, name = (part.strip() for part in text.partition("."))
        if not name:
            return _number(module)
    for known in MODULES:
        if known.name == module:
            return _inside(known, _number(offset)) if plus else _named(known, name)
    return None


def _named(module: Module, name: str) -> int | None:
    addresses = range(module.base, module.base + module.size)
    return next((address for address in addresses if register_name(address)[1] == name), None)


def _inside(module: Module, offset: int | None) -> int | None:
    return module.base + offset if offset is not None and 0 <= offset < module.size else None


def _number(text: str) -> int | None:
    try:
        return int(text, 0)
    except ValueError:
        return None


def is_protected(address: int) -> bool:
    """Return True if a write at an address needs EALLOW."""
    if address in pie_map.VECTOR_TABLE:
        return True
    module = module_at(address)
    if module is None:
        return False
    if module.registers is None:
        return module.name in PROTECTED_MODULES
    register = module.registers.at(address - module.base) or module.registers.at(address - module.base - 1)
    return register is not None and register.protected
