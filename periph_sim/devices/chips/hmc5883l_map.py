"""Registers of the HMC5883L as data. Source: Honeywell HMC5883L data sheet, register list and definitions."""

from __future__ import annotations

from ...core.registers import RegisterMap
from .register_chip import byte_register

SHEET = "HMC5883L data sheet"
MAP_SECTION = f"{SHEET}, register list"
DATA = ("DXRA", "DXRB", "DZRA", "DZRB", "DYRA", "DYRB")  # in this order: x, z, y, high byte first

MAP = RegisterMap(
    "HMC5883L",
    SHEET,
    (
        byte_register(0x00, "CRA", "R/W", 0x10, MAP_SECTION, (("MA", "6:5"), ("DO", "4:2"), ("MS", "1:0"))),
        byte_register(0x01, "CRB", "R/W", 0x20, MAP_SECTION, (("GN", "7:5"), ("ZERO", "4:0"))),
        byte_register(0x02, "Mode", "R/W", 0x01, MAP_SECTION, (("HS", "7"), ("MD", "1:0"))),
        *(byte_register(0x03 + i, name, "R", 0x00, MAP_SECTION) for i, name in enumerate(DATA)),
        byte_register(0x09, "Status", "R", 0x00, MAP_SECTION, (("LOCK", "1"), ("RDY", "0"))),
        byte_register(0x0A, "IRA", "R", ord("H"), MAP_SECTION),
        byte_register(0x0B, "IRB", "R", ord("4"), MAP_SECTION),
        byte_register(0x0C, "IRC", "R", ord("3"), MAP_SECTION),
    ),
)
