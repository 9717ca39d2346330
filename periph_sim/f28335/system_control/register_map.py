"""Table of the system control registers: PLL, clock prescalers and gates, low-power mode, watchdog.

All of these registers are EALLOW-protected. The clock gates of modules that are not simulated are stored, so that
firmware reads back what it wrote to PCLKCR0, PCLKCR1 and PCLKCR3.

Source: SPRUFB0D section 5, Table 14.
"""

from __future__ import annotations

from ...core.registers import Register, RegisterMap, Yields, field

BASE = 0x7010

PLLSTS = Register(
    "PLLSTS",
    0x01,
    "SPRUFB0D Table 22",
    (
        field("DIVSEL", "8:7", doc="SYSCLKOUT is the PLL's output divided by 4 (0, 1), 2 (2) or 1 (3, only in bypass)"),
        field("MCLKOFF", "6", doc="1: missing-clock detection off"),
        field("OSCOFF", "5", doc="1: OSCCLK does not reach the PLL, to test the missing-clock detection"),
        field("MCLKCLR", "4", "W1", doc="1: restart the missing-clock detection"),
        field("MCLKSTS", "3", "R", doc="1: OSCCLK was found missing"),
        field("PLLOFF", "2", doc="1: PLL off, allowed in bypass only"),
        field("PLLLOCKS", "0", "R", 1, doc="0 while the PLL locks"),
    ),
    protected=True,
)

HISPCP = Register(
    "HISPCP",
    0x0A,
    "SPRUFB0D Table 18",
    (field("HSPCLK", "2:0", "R/W", 1, doc="HSPCLK = SYSCLKOUT for 0, else SYSCLKOUT/(2n)"),),
    protected=True,
)

LOSPCP = Register(
    "LOSPCP",
    0x0B,
    "SPRUFB0D Table 19",
    (field("LSPCLK", "2:0", "R/W", 2, doc="LSPCLK = SYSCLKOUT for 0, else SYSCLKOUT/(2n)"),),
    protected=True,
)

PCLKCR0 = Register(
    "PCLKCR0",
    0x0C,
    "SPRUFB0D Table 15",
    (
        field("ECANBENCLK", "15", doc="clock to eCAN-B"),
        field("ECANAENCLK", "14", doc="clock to eCAN-A"),
        field("MCBSPBENCLK", "13", doc="clock to McBSP-B"),
        field("MCBSPAENCLK", "12", doc="clock to McBSP-A"),
        field("SCIBENCLK", "11", doc="clock to SCI-B"),
        field("SCIAENCLK", "10", doc="clock to SCI-A"),
        field("SPIAENCLK", "8", doc="clock to SPI-A"),
        field("SCICENCLK", "5", doc="clock to SCI-C"),
        field("I2CAENCLK", "4", doc="clock to I2C-A"),
        field("ADCENCLK", "3", doc="clock to the ADC"),
        field("TBCLKSYNC", "2", doc="time base clocks of all ePWM modules"),
    ),
    protected=True,
)

PCLKCR1 = Register(
    "PCLKCR1",
    0x0D,
    "SPRUFB0D Table 16",
    (
        field("EQEP2ENCLK", "15", doc="clock to eQEP2"),
        field("EQEP1ENCLK", "14", doc="clock to eQEP1"),
        field("ECAP6ENCLK", "13", doc="clock to eCAP6"),
        field("ECAP5ENCLK", "12", doc="clock to eCAP5"),
        field("ECAP4ENCLK", "11", doc="clock to eCAP4"),
        field("ECAP3ENCLK", "10", doc="clock to eCAP3"),
        field("ECAP2ENCLK", "9", doc="clock to eCAP2"),
        field("ECAP1ENCLK", "8", doc="clock to eCAP1"),
        field("EPWM6ENCLK", "5", doc="clock to ePWM6"),
        field("EPWM5ENCLK", "4", doc="clock to ePWM5"),
        field("EPWM4ENCLK", "3", doc="clock to ePWM4"),
        field("EPWM3ENCLK", "2", doc="clock to ePWM3"),
        field("EPWM2ENCLK", "1", doc="clock to ePWM2"),
        field("EPWM1ENCLK", "0", doc="clock to ePWM1"),
    ),
    protected=True,
)

LPMCR0 = Register(
    "LPMCR0",
    0x0E,
    "SPRUFB0D Figure 25, Table 25",
    (
        field("WDINTE", "15", doc="1: the watchdog may wake the device from STANDBY"),
        # The reset value follows Figure 25, which shows 1 for each of the six bits. Table 25 gives 0 as the default.
        field("QUALSTDBY", "7:2", "R/W", 0x3F, doc="OSCCLK periods to qualify the pin that wakes from STANDBY"),
        field("LPM", "1:0", doc="mode that IDLE enters: 0 IDLE, 1 STANDBY, 2 and 3 HALT"),
    ),
    protected=True,
)

PCLKCR3 = Register(
    "PCLKCR3",
    0x10,
    "SPRUFB0D Table 17",
    (
        field("GPIOINENCLK", "13", "R/W", 1, doc="clock to the GPIO input path"),
        field("XINTFENCLK", "12", doc="clock to the external interface"),
        field("DMAENCLK", "11", doc="clock to the DMA"),
        field("CPUTIMER2ENCLK", "10", "R/W", 1, doc="clock to CPU timer 2"),
        field("CPUTIMER1ENCLK", "9", "R/W", 1, doc="clock to CPU timer 1"),
        field("CPUTIMER0ENCLK", "8", "R/W", 1, doc="clock to CPU timer 0"),
    ),
    protected=True,
)

PLLCR = Register(
    "PLLCR",
    0x11,
    "SPRUFB0D Table 21",
    (field("DIV", "3:0", doc="0: bypass; 1 to 10: the PLL multiplies OSCCLK by this; others reserved"),),
    protected=True,
)

SCSR = Register(
    "SCSR",
    0x12,
    "SPRUFB0D Table 27",
    (
        field("WDINTS", "2", "R", 1, doc="the level of WDINT, delayed by two SYSCLKOUT cycles"),
        field("WDENINT", "1", doc="1: the watchdog interrupts instead of resetting"),
        field("WDOVERRIDE", "0", "R/W1C", 1, doc="0: WDDIS cannot be changed any more; only a reset sets it"),
    ),
    protected=True,
)

WDCNTR = Register(
    "WDCNTR",
    0x13,
    "SPRUFB0D Table 28",
    (field("WDCNTR", "7:0", "R", doc="the watchdog's count"),),
    protected=True,
    yields=Yields.TIME,
)

WDKEY = Register(
    "WDKEY",
    0x15,
    "SPRUFB0D Table 29",
    (field("WDKEY", "7:0", doc="0x55 followed by 0xAA clears WDCNTR; reads as WDCR"),),
    protected=True,
)

WDCR = Register(
    "WDCR",
    0x19,
    "SPRUFB0D Table 30",
    (
        field("WDFLAG", "7", "R/W1C", doc="1: the last reset was the watchdog's"),
        field("WDDIS", "6", doc="1: watchdog off; writable while SCSR.WDOVERRIDE is 1"),
        field("WDCHK", "5:3", "W", doc="must be written 5; reads 0"),
        field("WDPS", "2:0", doc="WDCLK = OSCCLK/512, divided by 1 (0, 1), 2, 4, 8, 16, 32, 64 (2 to 7)"),
    ),
    protected=True,
)

MAP = RegisterMap(
    "system control",
    "SPRUFB0D section 5",
    (PLLSTS, HISPCP, LOSPCP, PCLKCR0, PCLKCR1, LPMCR0, PCLKCR3, PLLCR, SCSR, WDCNTR, WDKEY, WDCR),
)
