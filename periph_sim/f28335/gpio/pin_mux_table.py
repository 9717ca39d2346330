"""Table of the signals that each multiplexer value assigns to a pin, copied from the manual.

FUNCTIONS[pin] has the names for GPxMUX = 1, 2, 3. "GPIO" means general-purpose input or output; "" means that the value
is reserved. `settings.PinSettings` derives from this table which pin is connected to which signal.

Source: SPRUFB0D Tables 46 (inputs without a pin), 47 to 49 (multiplexer).
"""

from __future__ import annotations

# For modules that are not modelled: maps the prefix of signal names to the module that has these signals.
MODULES = {
    "EPWM": "ePWM",
    "TZ": "ePWM",
    "ECAP": "eCAP",
    "EQEP": "eQEP",
    "CAN": "eCAN",
    "M": "McBSP",
    "ADC": "ADC",
    "X": "XINTF",
}

# Inputs that read 0 when no pin, or more than one, is assigned to them (Table 46); all others read 1.
IDLE_LOW = ("SPISTEA", "EPWMSYNCI")

_PORT_A = """
EPWM1A    -         -          EPWM1B    ECAP6     MFSRB      EPWM2A    -         -          EPWM2B    ECAP5     MCLKRB
EPWM3A    -         -          EPWM3B    MFSRA     ECAP1      EPWM4A    EPWMSYNCI EPWMSYNCO  EPWM4B    MCLKRA    ECAP2
EPWM5A    CANTXB    ADCSOCAO   EPWM5B    SCITXDB   ECAP3      EPWM6A    CANRXB    ADCSOCBO   EPWM6B    SCIRXDB   ECAP4
TZ1       CANTXB    MDXB       TZ2       CANRXB    MDRB       TZ3       SCITXDB   MCLKXB     TZ4       SCIRXDB   MFSXB
SPISIMOA  CANTXB    TZ5        SPISOMIA  CANRXB    TZ6        SPICLKA   SCITXDB   CANRXA     SPISTEA   SCIRXDB   CANTXA
EQEP1A    MDXA      CANTXB     EQEP1B    MDRA      CANRXB     EQEP1S    MCLKXA    SCITXDB    EQEP1I    MFSXA     SCIRXDB
ECAP1     EQEP2A    MDXB       ECAP2     EQEP2B    MDRB       ECAP3     EQEP2I    MCLKXB     ECAP4     EQEP2S    MFSXB
SCIRXDA   XZCS6     XZCS6      SCITXDA   XA19      XA19       CANRXA    XA18      XA18       CANTXA    XA17      XA17
"""
_PORT_B = """
SDAA      EPWMSYNCI ADCSOCAO   SCLA      EPWMSYNCO ADCSOCBO   ECAP1     XREADY    XREADY     SCITXDA   XRW       XRW
SCIRXDA   XZCS0     XZCS0      ECAP2     XZCS7     XZCS7      -         XWE0      XWE0       -         XA16      XA16
-         XA0       XA0        -         XA1       XA1        -         XA2       XA2        -         XA3       XA3
-         XA4       XA4        -         XA5       XA5        -         XA6       XA6        -         XA7       XA7
ECAP5     XD31      XD31       ECAP6     XD30      XD30       EQEP1A    XD29      XD29       EQEP1B    XD28      XD28
EQEP1S    XD27      XD27       EQEP1I    XD26      XD26       SPISIMOA  XD25      XD25       SPISOMIA  XD24      XD24
SPICLKA   XD23      XD23       SPISTEA   XD22      XD22       MCLKRA    XD21      XD21       MFSRA     XD20      XD20
MCLKRB    XD19      XD19       MFSRB     XD18      XD18       SCIRXDC   XD17      XD17       SCITXDC   XD16      XD16
"""
_PORT_C = """
GPIO      XD15      XD15       GPIO      XD14      XD14       GPIO      XD13      XD13       GPIO      XD12      XD12
GPIO      XD11      XD11       GPIO      XD10      XD10       GPIO      XD9       XD9        GPIO      XD8       XD8
GPIO      XD7       XD7        GPIO      XD6       XD6        GPIO      XD5       XD5        GPIO      XD4       XD4
GPIO      XD3       XD3        GPIO      XD2       XD2        GPIO      XD1       XD1        GPIO      XD0       XD0
GPIO      XA8       XA8        GPIO      XA9       XA9        GPIO      XA10      XA10       GPIO      XA11      XA11
GPIO      XA12      XA12       GPIO      XA13      XA13       GPIO      XA14      XA14       GPIO      XA15      XA15
"""


def _rows(table: str) -> list[tuple[str, str, str]]:
    names = ["" if name == "-" else name for name in table.split()]
    return list(zip(names[0::3], names[1::3], names[2::3], strict=True))


FUNCTIONS: tuple[tuple[str, str, str], ...] = (*_rows(_PORT_A), *_rows(_PORT_B), *_rows(_PORT_C))
