"""Contents of the address space: memory that may hold code or data, or registers, for each address.

This is the whole space of the chip; `memory_map` has only the modules that a scene names. Parts of the family with less
flash than the F28335 have nothing at the low addresses of flash. Words have 16 bits.

Source: SPRS439M Figure 3-2, Tables 3-1, 3-5, 3-8 to 3-11.
"""

from __future__ import annotations

from bisect import bisect_right
from enum import Enum
from typing import TYPE_CHECKING, NamedTuple

from ..descriptor import FLASH
from .ram import BLOCKS

if TYPE_CHECKING:
    from ..descriptor import Part


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

OTHER_PARTS = (  # memory of other C28x parts where the F28335 has nothing
    (range(0x01_0000, 0x02_0000), "an F2806x and an F2837x have memory there"),
    (range(0x08_0000, 0x10_0000), "an F2837x has its flash there"),
    (range(0x3D_8000, 0x3F_8000), "an F281x, F280x, F2803x or F2806x has its flash there"),
)
LOADABLE = frozenset((Content.RAM, Content.FLASH, Content.OTP, Content.EXTERNAL))


def area_at(address: int) -> Area | None:
    """Return the area that contains an address of the F28335; None where the chip has nothing."""
    at = bisect_right(_BASES, address) - 1
    return AREAS[at] if at >= 0 and address < AREAS[at].end else None


def not_loadable(base: int, size: int, part: Part) -> str:
    """Return why words cannot be loaded at these addresses of a part, as the end of a sentence; "" if they can be."""
    address = base
    while address < base + size:
        area = area_at(address)
        if area is None:
            others = "".join(f"; {what}" for where, what in OTHER_PARTS if address in where)
            return f"at {address:#08x}, where the {part.name} has nothing{others}"
        if area.content is Content.FLASH and address < part.flash.start:
            return f"at {address:#08x}, where the {part.name} has nothing; its flash begins at {part.flash.start:#08x}"
        if area.content not in LOADABLE:
            return f"at {address:#08x}, over {area.content.value} ({area.name})"
        address = area.end
    return ""
