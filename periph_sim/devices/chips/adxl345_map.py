"""Registers of the ADXL345 as data. Source: ADXL345 data sheet Rev 0, register map and register definitions."""

from __future__ import annotations

from ...core.registers import RegisterMap
from .register_chip import Bits, byte_register

SHEET = "ADXL345 Rev 0"
MAP_SECTION = f"{SHEET} register map"
OFFSETS = ("OFSX", "OFSY", "OFSZ")
DATA = ("DATAX0", "DATAX1", "DATAY0", "DATAY1", "DATAZ0", "DATAZ1")
EVENTS: Bits = (
    ("DATA_READY", "7"),
    ("SINGLE_TAP", "6"),
    ("DOUBLE_TAP", "5"),
    ("Activity", "4"),
    ("Inactivity", "3"),
    ("FREE_FALL", "2"),
    ("Watermark", "1"),
    ("Overrun", "0"),
)
AXES_OF_ACTIVITY: Bits = (
    ("ACT_ac_dc", "7"),
    ("ACT_X", "6"),
    ("ACT_Y", "5"),
    ("ACT_Z", "4"),
    ("INACT_ac_dc", "3"),
    ("INACT_X", "2"),
    ("INACT_Y", "1"),
    ("INACT_Z", "0"),
)
TAP_AXES: Bits = (("Suppress", "3"), ("TAP_X", "2"), ("TAP_Y", "1"), ("TAP_Z", "0"))
TAP_STATUS: Bits = (
    ("ACT_X", "6"),
    ("ACT_Y", "5"),
    ("ACT_Z", "4"),
    ("Asleep", "3"),
    ("TAP_X", "2"),
    ("TAP_Y", "1"),
    ("TAP_Z", "0"),
)
POWER_CTL: Bits = (("Link", "5"), ("AUTO_SLEEP", "4"), ("Measure", "3"), ("Sleep", "2"), ("Wakeup", "1:0"))
DATA_FORMAT: Bits = (
    ("SELF_TEST", "7"),
    ("SPI", "6"),
    ("INT_INVERT", "5"),
    ("FULL_RES", "3"),
    ("Justify", "2"),
    ("Range", "1:0"),
)

MAP = RegisterMap(
    "ADXL345",
    SHEET,
    (
        byte_register(0x00, "DEVID", "R", 0xE5, MAP_SECTION),
        byte_register(0x1D, "THRESH_TAP", "R/W", 0x00, MAP_SECTION),
        *(byte_register(0x1E + i, name, "R/W", 0x00, MAP_SECTION) for i, name in enumerate(OFFSETS)),
        byte_register(0x21, "DUR", "R/W", 0x00, MAP_SECTION),
        byte_register(0x22, "Latent", "R/W", 0x00, MAP_SECTION),
        byte_register(0x23, "Window", "R/W", 0x00, MAP_SECTION),
        byte_register(0x24, "THRESH_ACT", "R/W", 0x00, MAP_SECTION),
        byte_register(0x25, "THRESH_INACT", "R/W", 0x00, MAP_SECTION),
        byte_register(0x26, "TIME_INACT", "R/W", 0x00, MAP_SECTION),
        byte_register(0x27, "ACT_INACT_CTL", "R/W", 0x00, MAP_SECTION, AXES_OF_ACTIVITY),
        byte_register(0x28, "THRESH_FF", "R/W", 0x00, MAP_SECTION),
        byte_register(0x29, "TIME_FF", "R/W", 0x00, MAP_SECTION),
        byte_register(0x2A, "TAP_AXES", "R/W", 0x00, MAP_SECTION, TAP_AXES),
        byte_register(0x2B, "ACT_TAP_STATUS", "R", 0x00, MAP_SECTION, TAP_STATUS),
        byte_register(0x2C, "BW_RATE", "R/W", 0x0A, MAP_SECTION, (("LOW_POWER", "4"), ("Rate", "3:0"))),
        byte_register(0x2D, "POWER_CTL", "R/W", 0x00, MAP_SECTION, POWER_CTL),
        byte_register(0x2E, "INT_ENABLE", "R/W", 0x00, MAP_SECTION, EVENTS),
        byte_register(0x2F, "INT_MAP", "R/W", 0x00, MAP_SECTION, EVENTS),
        byte_register(0x30, "INT_SOURCE", "R", 0x02, MAP_SECTION, EVENTS),
        byte_register(0x31, "DATA_FORMAT", "R/W", 0x00, MAP_SECTION, DATA_FORMAT),
        *(byte_register(0x32 + i, name, "R", 0x00, MAP_SECTION) for i, name in enumerate(DATA)),
        byte_register(
            0x38, "FIFO_CTL", "R/W", 0x00, MAP_SECTION, (("Mode", "7:6"), ("Trigger", "5"), ("Samples", "4:0"))
        ),
        byte_register(0x39, "FIFO_STATUS", "R", 0x00, MAP_SECTION, (("FIFO_TRIG", "7"), ("Entries", "5:0"))),
    ),
)
