"""Addresses of register structures, by their names in TI's headers.

Source: SPRS439M Tables 3-8 to 3-11; the names of the linker command files that TI ships with its headers.
"""

from __future__ import annotations

from ...f28335.parts.f28335 import PART

BYTES_A_WORD = 4  # on the host, per word of the chip: the size of an unsigned int
IER, IFR = 0x0F00, 0x0F04  # CPU registers, at addresses unused on the chip
VECTORS = range(0x0D00, 0x0E00)

SYMBOLS: dict[str, int] = {
    "IER": IER,
    "IFR": IFR,
    **{name: module.base + offset for module in PART.modules for name, offset in module.header.items()},
    "DevEmuRegs": 0x0880,
    "FlashRegs": 0x0A80,
    "CsmRegs": 0x0AE0,
    "AdcMirror": 0x0B00,
    "XintfRegs": 0x0B20,
    "PieVectTable": VECTORS.start,
    "DmaRegs": 0x1000,
    "McbspaRegs": 0x5000,
    "McbspbRegs": 0x5040,
    **{
        f"ECan{letter}{part}": base + offset
        for letter, base in (("a", 0x6000), ("b", 0x6200))
        for part, offset in (("Regs", 0), ("LAMRegs", 0x40), ("MOTSRegs", 0x80), ("MOTORegs", 0xC0), ("Mboxes", 0x100))
    },
    **{f"EPwm{number}Regs": 0x6800 + 0x40 * (number - 1) for number in range(1, 7)},
    **{f"ECap{number}Regs": 0x6A00 + 0x20 * (number - 1) for number in range(1, 7)},
    "EQep1Regs": 0x6B00,
    "EQep2Regs": 0x6B40,
    "AdcRegs": 0x7100,
}
# Symbols of code copied to RAM at start-up: nothing is copied here.
COPIED = ("RamfuncsLoadStart", "RamfuncsLoadEnd", "RamfuncsRunStart", "RamfuncsLoadSize")
