"""Which fields of which modules ask for which interrupt: a line of the PIE goes in, module and fields come out.

SCIRXINTA --> "SCI-A", fields whose rise, or whose being enabled, asks for it
"""

from __future__ import annotations

I2C_FLAGS = ("AAS", "SCD", "XRDY", "RRDY", "ARDY", "NACK", "AL")

# A line's name without the module's letter --> kind of module, fields. Source: SPRUG03B sections 3.1 and 3.2, SPRUFZ5A
# section 1.2.10.1 and figure 1-10.
SOURCES: dict[str, tuple[str, tuple[str, ...]]] = {
    "I2CINT1": ("I2C", (*(f"I2CSTR.{f}" for f in I2C_FLAGS), *(f"I2CIER.{f}" for f in I2C_FLAGS))),
    "I2CINT2": ("I2C", ("I2CFFTX.TXFFINT", "I2CFFRX.RXFFINT", "I2CFFTX.TXFFIENA", "I2CFFRX.RXFFIENA")),
    "SCIRXINT": (
        "SCI",
        (
            *(f"SCIFFRX.{f}" for f in ("RXFFINT", "RXFFOVF", "RXFFIENA")),
            *(f"SCIRXST.{f}" for f in ("RXRDY", "BRKDT", "RXERROR")),
            "SCICTL1.RXERRINTENA",
            "SCICTL2.RXBKINTENA",
        ),
    ),
    "SCITXINT": ("SCI", ("SCIFFTX.TXFFINT", "SCIFFTX.TXFFIENA", "SCICTL2.TXRDY", "SCICTL2.TXINTENA")),
}
TIMER = "TINT0", "TIMER0", ("TCR.TIF", "TCR.TIE")


def sources(line: str) -> tuple[str, tuple[str, ...]]:
    """Module and fields of a line of the PIE; ("", ()) where no field asks for it."""
    if line == TIMER[0]:
        return TIMER[1:]
    kind, fields = SOURCES.get(line[:-1], ("", ()))
    return (f"{kind}-{line[-1]}", fields) if kind else ("", ())
