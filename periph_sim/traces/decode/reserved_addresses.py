"""Purposes of reserved I2C addresses.

Source: UM10204, section 3.1.12, table "Reserved addresses", and sections 3.1.11 (10-bit), 3.1.13 (general call),
3.1.15 (START byte), 3.1.17 (device ID), 5.3 (Hs-mode).
"""

from __future__ import annotations

PURPOSES = (
    "general call",
    "START byte",
    "CBUS",
    "other bus format",
    "future use",
    "Hs-mode controller code",
    "10-bit",
    "device ID",
)


def purpose_of(byte: int) -> str:
    """Return the purpose of an address byte with its R/W bit; empty for a device's address."""
    high = byte >> 1
    if high == 0:
        return "START byte" if byte & 1 else "general call"
    if high < 4:
        return ("CBUS", "other bus format", "future use")[high - 1]
    if high < 8:
        return "Hs-mode controller code"
    if high >= 0x7C:
        return "device ID"
    return "10-bit" if high >= 0x78 else ""
