"""Table of the external interrupt registers, 0x7070 to 0x707F.

Names are those of C2000Ware's DSP2833x_XIntrupt.h.

Source: SPRUFB0D section 8.6, Figures 91 to 95, Tables 121 to 126.
"""

from __future__ import annotations

from ...core.registers import Register, RegisterMap, field

BASE = 0x7070

_POLARITY = field("POLARITY", "3:2", doc="0 and 2: falling edge, 1: rising edge, 3: both.")
_ENABLE = field("ENABLE", "0")


def _counter(name: str, offset: int, source: str) -> Register:
    count = field("INTCTR", "15:0", "R", doc="SYSCLKOUT cycles since the last valid edge.")
    return Register(name, offset, source, (count,))


XINT = RegisterMap(
    "XINT",
    "SPRUFB0D section 8.6",
    (
        *(Register(f"XINT{n}CR", n - 1, "SPRUFB0D Figure 91", (_POLARITY, _ENABLE)) for n in range(1, 8)),
        Register(
            "XNMICR",
            0x7,
            "SPRUFB0D Figure 92",
            (_POLARITY, field("SELECT", "1", doc="INT13 comes from 0: CPU timer 1, 1: XNMI_XINT13."), _ENABLE),
        ),
        _counter("XINT1CTR", 0x8, "SPRUFB0D Figure 93"),
        _counter("XINT2CTR", 0x9, "SPRUFB0D Figure 94"),
        _counter("XNMICTR", 0xF, "SPRUFB0D Figure 95"),
    ),
)
