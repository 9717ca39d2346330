"""Registers of the ITG-3200 as data. Source: InvenSense ITG-3200 Product Specification rev 1.4, register map."""

from __future__ import annotations

from ...core.registers import RegisterMap
from .register_chip import Bits, byte_register

SHEET = "ITG-3200 rev 1.4"
MAP_SECTION = f"{SHEET} register map"
DATA = ("GYRO_XOUT_H", "GYRO_XOUT_L", "GYRO_YOUT_H", "GYRO_YOUT_L", "GYRO_ZOUT_H", "GYRO_ZOUT_L")
INT_CFG: Bits = (
    ("ACTL", "7"),
    ("OPEN", "6"),
    ("LATCH_INT_EN", "5"),
    ("INT_ANYRD_2CLEAR", "4"),
    ("ITG_RDY_EN", "2"),
    ("RAW_RDY_EN", "0"),
)
PWR_MGM: Bits = (
    ("H_RESET", "7"),
    ("SLEEP", "6"),
    ("STBY_XG", "5"),
    ("STBY_YG", "4"),
    ("STBY_ZG", "3"),
    ("CLK_SEL", "2:0"),
)

MAP = RegisterMap(
    "ITG-3200",
    SHEET,
    (
        byte_register(0x00, "WHO_AM_I", "R/W", 0x68, MAP_SECTION, (("ID", "6:1"), ("BIT0", "0"))),
        byte_register(0x15, "SMPLRT_DIV", "R/W", 0x00, MAP_SECTION),
        byte_register(0x16, "DLPF_FS", "R/W", 0x00, MAP_SECTION, (("FS_SEL", "4:3"), ("DLPF_CFG", "2:0"))),
        byte_register(0x17, "INT_CFG", "R/W", 0x00, MAP_SECTION, INT_CFG),
        byte_register(0x1A, "INT_STATUS", "R", 0x00, MAP_SECTION, (("ITG_RDY", "2"), ("RAW_DATA_RDY", "0"))),
        byte_register(0x1B, "TEMP_OUT_H", "R", 0x00, MAP_SECTION),
        byte_register(0x1C, "TEMP_OUT_L", "R", 0x00, MAP_SECTION),
        *(byte_register(0x1D + i, name, "R", 0x00, MAP_SECTION) for i, name in enumerate(DATA)),
        byte_register(0x3E, "PWR_MGM", "R/W", 0x00, MAP_SECTION, PWR_MGM),
    ),
)
