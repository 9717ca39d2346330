"""Boot modes of an image, and stubs: values that reads of unmodelled registers return.

    entry   The program begins at its entry point, as if a debugger started it; SYSCLKOUT is as after a reset.
    flash   The program begins at 0x33FFF6, to which the boot ROM jumps if GPIO87 to GPIO84 are high; SYSCLKOUT is
            OSCCLK / 2.
    ram     The program begins at 0, to which the boot ROM jumps in the mode "M0 SARAM"; SYSCLKOUT is OSCCLK / 2.

The run time of the boot ROM, and the words that its stack leaves in M0, are not modelled. Source: SPRU963A.
"""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

from ...f28335.memory.address_space import Content, address_of, area_at, full_name
from ...f28335.memory.memory_map import AddressMap
from ..image_files.model import BadImage, Image

Boot = Literal["entry", "flash", "ram"]
BEGINS: dict[Boot, int] = {"flash": 0x33_FFF6, "ram": 0}


class Stub(Struct, frozen=True):
    """A stub: reads of `address` return `value` from the tick `tick` on."""

    tick: int
    address: int
    value: int


class BadStub(ValueError):
    """Raised if an address cannot have a stub. The message is one sentence."""


def entry_of(image: Image, boot: Boot) -> int:
    """Return the address of the first instruction.

    Raise BadImage in the modes flash and ram if nothing is loaded at this address.
    """
    if boot == "entry":
        return image.entry
    address = BEGINS[boot]
    if not any(section.address <= address < section.end for section in image.loaded):
        raise BadImage(
            f'boot = "{boot}" begins at {address:#08x}, where this image has nothing; its entry is elsewhere'
        )
    return address


def stubbed(register: str | int, memory: AddressMap) -> int:
    """Return the address of a word that gets a stub: a register that is not modelled, or a word of an XINTF zone.

    Raise BadStub for any other word. register: a name, such as ADC.ADCST, or an address.
    """
    address = register if isinstance(register, int) else address_of(register)
    if address is None:
        raise BadStub(
            f"there is no register {register!r}; write its address, ADC.ADCST, or an offset as in eCAN-A + 0x08"
        )
    area = area_at(address)
    if area is None or area.content not in (Content.REGISTERS, Content.EXTERNAL):
        raise BadStub(f"{address:#08x} is not a register")
    if memory.at(address) is not None:
        raise BadStub(f"{full_name(address)} is modelled; stubs are for registers that are not")
    return address
