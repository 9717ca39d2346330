"""Which modules a unit may name, and on which pins TI's start-up code has their signals: data alone, no module."""

from __future__ import annotations

SCIS = ("SCI-A", "SCI-B", "SCI-C")
MODULES = (*SCIS, "I2C-A", "GPIO", "XINT", "TIMER0", "TIMER1", "TIMER2")
GATED = tuple(name for name in MODULES if name not in ("GPIO", "XINT"))  # PCLKCR switches their clock

# GPIO numbers by signal; used for wires when no GPIO module is in the scene.
PIN_OF = {
    "SDAA": 32,
    "SCLA": 33,
    "SCIRXDA": 28,
    "SCITXDA": 29,
    "SCIRXDB": 19,
    "SCITXDB": 18,
    "SCIRXDC": 62,
    "SCITXDC": 63,
}
