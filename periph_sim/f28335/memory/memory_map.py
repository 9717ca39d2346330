"""The peripheral frames: the module, register and wait states at an address.

Source: SPRS439M Table 3-5 (wait states), SPRUFB0D section 7.2 and Tables 86-96 (frames, EALLOW), section 7.4 (block
protection).
"""

from __future__ import annotations

from msgspec import Struct

from ...core.registers import Register
from ...core.socket import Socket
from ..descriptor import Frame
from ..system_options import SystemOptions

# A read in this range waits until an earlier write in it is complete (PROTSTART, PROTRANGE as set by the boot ROM).
PROTECTED_BLOCK = range(0x4000, 0x8000)
WRITE_TO_READ = 3  # minimum number of cycles between such a write and the read that waits

LOW, HIGH, BOTH = 0b01, 0b10, 0b11  # the 16-bit words of a 32-bit register that an access transfers
WORDS_MASK = (0, 0xFFFF, 0xFFFF_0000, 0xFFFF_FFFF)  # masks of the register bits for no word, LOW, HIGH and BOTH


class ModuleRange(Struct, frozen=True):
    """Addresses of a module. base: the address of the register at offset 0. size: in 16-bit words."""

    name: str
    base: int
    size: int
    frame: Frame
    socket: Socket


class WaitStates:
    """Wait states of reads and writes, in cycles. The indices 0 to 2 are the peripheral frames PF0 to PF2.

    TI does not document the wait states of PF2 clearly, so they are options. `processor.bus` records their use.
    """

    def __init__(self, options: SystemOptions) -> None:
        self.read = (1, 2, options.pf2_read_ws.unrecorded())
        self.write = (0, 0, options.pf2_write_ws.unrecorded())


class NoSuchAddress(ValueError):
    """Error: no module of this scene has the address, or there is no register at it."""


class AddressMap:
    """The modules of one F28335 that the scene names, with their addresses."""

    def __init__(self) -> None:
        self.places: dict[str, ModuleRange] = {}

    def at(self, address: int) -> tuple[ModuleRange, Register, int] | None:
        """Return (module, register, half) at an address; None if there is no register.

        half: 1 if the address is that of the upper 16 bits of a 32-bit register, else 0.
        """
        place = self._place(address)
        if place is not None:
            offset = address - place.base
            for back in (0, 1):
                register = place.socket.chip.MAP.at(offset - back)
                if register is not None and register.width > 16 * back:
                    return place, register, back
        return None

    def _place(self, address: int) -> ModuleRange | None:
        return next((place for place in self.places.values() if 0 <= address - place.base < place.size), None)

    def refusal(self, address: int) -> NoSuchAddress:
        """Return the error for an address without a register.

        The message names the nearest registers of the module at the address; if there is no module, all modules.
        """
        place = self._place(address)
        if place is None:
            here = ", ".join(f"{p.name} {p.base:#06x}" for p in self.places.values())
            return NoSuchAddress(f"{address:#06x} belongs to no module of this scene, which has {here}")
        last, offset = place.base + place.size - 1, address - place.base
        by_distance = sorted(place.socket.chip.MAP, key=lambda r: (abs(r.offset - offset), r.offset))[:2]
        nearest = [f"{r.name} {place.base + r.offset:#06x}" for r in sorted(by_distance, key=lambda r: r.offset)]
        return NoSuchAddress(
            f"{address:#06x} is not a register of {place.name} ({place.base:#06x} to {last:#06x}); "
            f"the nearest are {' and '.join(nearest)}"
        )
