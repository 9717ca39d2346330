"""The register maps compared with tables written separately, to find mistakes in bits, access types or reset values.

Each line has: offset; name; marks (EALLOW: writes need it; 32: it has 32 bits; runs: it counts without accesses; acts:
reads have side effects; +X: `all` contains X, too); fields with bits, access type unless R/W, reset value unless 0, and
"tie" if hardware takes precedence over a write in the same cycle. "A1 to A9 x2" are fields of two bits each, from bit
0 on.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest
from msgspec.structs import replace

from periph_sim.core.registers import Field, Register, RegisterMap, Tie, Yields
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.f28335.pie import register_map as pie_map
from periph_sim.records.register_maps import reads_take, yields_data

MAPS: dict[str, RegisterMap] = {one.registers.name: one.registers for one in PART.modules}

MANUAL = {
    "system control": """
        01 PLLSTS EALLOW: DIVSEL 8:7, MCLKOFF 6, OSCOFF 5, MCLKCLR 4 W1, MCLKSTS 3 R, PLLOFF 2, PLLLOCKS 0 R =1
        0A HISPCP EALLOW: HSPCLK 2:0 =1
        0B LOSPCP EALLOW: LSPCLK 2:0 =2
        0C PCLKCR0 EALLOW: ECANBENCLK 15, ECANAENCLK 14, MCBSPBENCLK 13, MCBSPAENCLK 12, SCIBENCLK 11, SCIAENCLK 10,
            SPIAENCLK 8, SCICENCLK 5, I2CAENCLK 4, ADCENCLK 3, TBCLKSYNC 2
        0D PCLKCR1 EALLOW: EQEP2ENCLK 15, EQEP1ENCLK 14, ECAP6ENCLK 13, ECAP5ENCLK 12, ECAP4ENCLK 11, ECAP3ENCLK 10,
            ECAP2ENCLK 9, ECAP1ENCLK 8, EPWM6ENCLK 5, EPWM5ENCLK 4, EPWM4ENCLK 3, EPWM3ENCLK 2, EPWM2ENCLK 1, EPWM1ENCLK
            0
        0E LPMCR0 EALLOW: WDINTE 15, QUALSTDBY 7:2 =3F, LPM 1:0
        10 PCLKCR3 EALLOW: GPIOINENCLK 13 =1, XINTFENCLK 12, DMAENCLK 11, CPUTIMER2ENCLK 10 =1, CPUTIMER1ENCLK 9 =1,
            CPUTIMER0ENCLK 8 =1
        11 PLLCR EALLOW: DIV 3:0
        12 SCSR EALLOW: WDINTS 2 R =1, WDENINT 1, WDOVERRIDE 0 R/W1C =1
        13 WDCNTR EALLOW runs: WDCNTR 7:0 R
        15 WDKEY EALLOW: WDKEY 7:0
        19 WDCR EALLOW: WDFLAG 7 R/W1C, WDDIS 6, WDCHK 5:3 W, WDPS 2:0
    """,
    "PIE": """
        00 PIECTRL: PIEVECT 15:1 R, ENPIE 0
        01 PIEACK: PIEACK 11:0 R/W1C =FFF
        02 PIEIER1: INTx1 to INTx8 x1
        04 PIEIER2: INTx1 to INTx8 x1
        06 PIEIER3: INTx1 to INTx8 x1
        08 PIEIER4: INTx1 to INTx8 x1
        0A PIEIER5: INTx1 to INTx8 x1
        0C PIEIER6: INTx1 to INTx8 x1
        0E PIEIER7: INTx1 to INTx8 x1
        10 PIEIER8: INTx1 to INTx8 x1
        12 PIEIER9: INTx1 to INTx8 x1
        14 PIEIER10: INTx1 to INTx8 x1
        16 PIEIER11: INTx1 to INTx8 x1
        18 PIEIER12: INTx1 to INTx8 x1
        03 PIEIFR1 acts: INTx1 to INTx8 x1 tie
        05 PIEIFR2 acts: INTx1 to INTx8 x1 tie
        07 PIEIFR3 acts: INTx1 to INTx8 x1 tie
        09 PIEIFR4 acts: INTx1 to INTx8 x1 tie
        0B PIEIFR5 acts: INTx1 to INTx8 x1 tie
        0D PIEIFR6 acts: INTx1 to INTx8 x1 tie
        0F PIEIFR7 acts: INTx1 to INTx8 x1 tie
        11 PIEIFR8 acts: INTx1 to INTx8 x1 tie
        13 PIEIFR9 acts: INTx1 to INTx8 x1 tie
        15 PIEIFR10 acts: INTx1 to INTx8 x1 tie
        17 PIEIFR11 acts: INTx1 to INTx8 x1 tie
        19 PIEIFR12 acts: INTx1 to INTx8 x1 tie
    """,
    "SCI": """
        00 SCICCR: STOPBITS 7, PARITY 6, PARITYENA 5, LOOPBKENA 4, ADDRIDLE_MODE 3, SCICHAR 2:0
        01 SCICTL1: RXERRINTENA 6, SWRESET 5, TXWAKE 3 R/S, SLEEP 2, TXENA 1, RXENA 0
        02 SCIHBAUD: BAUD 7:0
        03 SCILBAUD: BAUD 7:0
        04 SCICTL2: TXRDY 7 R =1, TXEMPTY 6 R =1, RXBKINTENA 1, TXINTENA 0
        05 SCIRXST: RXERROR 7 R, RXRDY 6 R, BRKDT 5 R, FE 4 R, OE 3 R, PE 2 R, RXWAKE 1 R
        06 SCIRXEMU: ERXDT 7:0 R
        07 SCIRXBUF acts: SCIFFFE 15 R, SCIFFPE 14 R, RXDT 7:0 R
        09 SCITXBUF: TXDT 7:0
        0A SCIFFTX: SCIRST 15 =1, SCIFFENA 14, TXFIFOXRESET 13 =1, TXFFST 12:8 R, TXFFINT 7 R, TXFFINTCLR 6 W1,
            TXFFIENA 5, TXFFIL 4:0
        0B SCIFFRX: RXFFOVF 15 R, RXFFOVRCLR 14 W1, RXFIFORESET 13 =1, RXFFST 12:8 R, RXFFINT 7 R, RXFFINTCLR 6 W1,
            RXFFIENA 5, RXFFIL 4:0 =1F
        0C SCIFFCT: ABD 15 R, ABDCLR 14 W1, CDC 13, FFTXDLY 7:0
        0F SCIPRI: SOFT 4, FREE 3
    """,
    "SPI": """
        00 SPICCR: SPISWRESET 7, CLKPOLARITY 6, SPILBK 4, SPICHAR 3:0
        01 SPICTL: OVERRUNINTENA 4, CLK_PHASE 3, MASTER_SLAVE 2, TALK 1, SPIINTENA 0
        02 SPISTS: OVERRUN_FLAG 7 R/W1C, INT_FLAG 6 R, BUFFULL_FLAG 5 R
        04 SPIBRR: BIT_RATE 6:0
        06 SPIRXEMU: ERXB 15:0 R
        07 SPIRXBUF acts: RXB 15:0 R
        08 SPITXBUF: TXB 15:0
        09 SPIDAT: SDAT 15:0
        0A SPIFFTX: SPIRST 15 =1, SPIFFENA 14, TXFIFO 13 =1, TXFFST 12:8 R, TXFFINT 7 R, TXFFINTCLR 6 W1, TXFFIENA 5,
            TXFFIL 4:0
        0B SPIFFRX: RXFFOVF 15 R, RXFFOVFCLR 14 W1, RXFIFORESET 13 =1, RXFFST 12:8 R, RXFFINT 7 R, RXFFINTCLR 6 W1,
            RXFFIENA 5, RXFFIL 4:0 =1F
        0C SPIFFCT: TXDLY 7:0
        0F SPIPRI: SOFT 5, FREE 4
    """,
    "I2C": """
        00 I2COAR: OAR 9:0
        01 I2CIER: AAS 6, SCD 5, XRDY 4, RRDY 3, ARDY 2, NACK 1, AL 0
        02 I2CSTR: SDIR 14 R/W1C, NACKSNT 13 R/W1C, BB 12 R, RSFULL 11 R, XSMT 10 R =1, AAS 9 R, AD0 8 R, SCD 5
            R/W1C, XRDY 4 R =1, RRDY 3 R/W1C, ARDY 2 R/W1C, NACK 1 R/W1C, AL 0 R/W1C
        03 I2CCLKL: ICCL 15:0
        04 I2CCLKH: ICCH 15:0
        05 I2CCNT: ICDC 15:0
        06 I2CDRR acts: DATA 7:0 R
        07 I2CSAR: SAR 9:0 =3FF
        08 I2CDXR: DATA 7:0
        09 I2CMDR: NACKMOD 15, FREE 14, STT 13, STP 11, MST 10, TRX 9, XA 8, RM 7, DLB 6, IRS 5, STB 4, FDF 3, BC
            2:0
        0A I2CISRC acts: WRITE_ZEROS 11:8, INTCODE 2:0 RC
        0B I2CEMDR: BCM 0 =1
        0C I2CPSC: IPSC 7:0
        20 I2CFFTX: I2CFFEN 14, TXFFRST 13, TXFFST 12:8 R, TXFFINT 7 R, TXFFINTCLR 6 W1, TXFFIENA 5, TXFFIL 4:0
        21 I2CFFRX: RXFFRST 13, RXFFST 12:8 R, RXFFINT 7 R, RXFFINTCLR 6 W1, RXFFIENA 5, RXFFIL 4:0
    """,
    "GPIO": """
        00 GPACTRL EALLOW 32: QUALPRD0 7:0, QUALPRD1 15:8, QUALPRD2 23:16, QUALPRD3 31:24
        02 GPAQSEL1 EALLOW 32: GPIO0 to GPIO15 x2
        04 GPAQSEL2 EALLOW 32: GPIO16 to GPIO31 x2
        06 GPAMUX1 EALLOW 32: GPIO0 to GPIO15 x2
        08 GPAMUX2 EALLOW 32: GPIO16 to GPIO31 x2
        0A GPADIR EALLOW 32: GPIO0 to GPIO31 x1
        0C GPAPUD EALLOW 32: GPIO0 to GPIO31 x1 =FFF
        10 GPBCTRL EALLOW 32: QUALPRD0 7:0, QUALPRD1 15:8, QUALPRD2 23:16, QUALPRD3 31:24
        12 GPBQSEL1 EALLOW 32: GPIO32 to GPIO47 x2
        14 GPBQSEL2 EALLOW 32: GPIO48 to GPIO63 x2
        16 GPBMUX1 EALLOW 32: GPIO32 to GPIO47 x2
        18 GPBMUX2 EALLOW 32: GPIO48 to GPIO63 x2
        1A GPBDIR EALLOW 32: GPIO32 to GPIO63 x1
        1C GPBPUD EALLOW 32: GPIO32 to GPIO63 x1
        26 GPCMUX1 EALLOW 32: GPIO64 to GPIO79 x2
        28 GPCMUX2 EALLOW 32: GPIO80 to GPIO87 x2
        2A GPCDIR EALLOW 32: GPIO64 to GPIO87 x1
        2C GPCPUD EALLOW 32: GPIO64 to GPIO87 x1
        40 GPADAT 32: GPIO0 to GPIO31 x1
        42 GPASET 32: GPIO0 to GPIO31 x1 W1
        44 GPACLEAR 32: GPIO0 to GPIO31 x1 W1
        46 GPATOGGLE 32: GPIO0 to GPIO31 x1 W1
        48 GPBDAT 32: GPIO32 to GPIO63 x1
        4A GPBSET 32: GPIO32 to GPIO63 x1 W1
        4C GPBCLEAR 32: GPIO32 to GPIO63 x1 W1
        4E GPBTOGGLE 32: GPIO32 to GPIO63 x1 W1
        50 GPCDAT 32: GPIO64 to GPIO87 x1
        52 GPCSET 32: GPIO64 to GPIO87 x1 W1
        54 GPCCLEAR 32: GPIO64 to GPIO87 x1 W1
        56 GPCTOGGLE 32: GPIO64 to GPIO87 x1 W1
        60 GPIOXINT1SEL EALLOW: GPIOSEL 4:0
        61 GPIOXINT2SEL EALLOW: GPIOSEL 4:0
        62 GPIOXNMISEL EALLOW: GPIOSEL 4:0
        63 GPIOXINT3SEL EALLOW: GPIOSEL 4:0
        64 GPIOXINT4SEL EALLOW: GPIOSEL 4:0
        65 GPIOXINT5SEL EALLOW: GPIOSEL 4:0
        66 GPIOXINT6SEL EALLOW: GPIOSEL 4:0
        67 GPIOXINT7SEL EALLOW: GPIOSEL 4:0
        68 GPIOLPMSEL EALLOW 32: GPIO0 to GPIO31 x1
    """,
    "XINT": """
        00 XINT1CR: POLARITY 3:2, ENABLE 0
        01 XINT2CR: POLARITY 3:2, ENABLE 0
        02 XINT3CR: POLARITY 3:2, ENABLE 0
        03 XINT4CR: POLARITY 3:2, ENABLE 0
        04 XINT5CR: POLARITY 3:2, ENABLE 0
        05 XINT6CR: POLARITY 3:2, ENABLE 0
        06 XINT7CR: POLARITY 3:2, ENABLE 0
        07 XNMICR: POLARITY 3:2, SELECT 1, ENABLE 0
        08 XINT1CTR: INTCTR 15:0 R
        09 XINT2CTR: INTCTR 15:0 R
        0F XNMICTR: INTCTR 15:0 R
    """,
    "CPU timer": """
        00 TIM runs +TIMH: TIM 15:0
        01 TIMH runs: TIMH 15:0
        02 PRD +PRDH: PRD 15:0 =FFFF
        03 PRDH: PRDH 15:0
        04 TCR: TIF 15 R/W1C, TIE 14, FREE 11, SOFT 10, TRB 5 W1, TSS 4
        06 TPR runs: PSC 15:8 R, TDDR 7:0
        07 TPRH runs: PSCH 15:8 R, TDDRH 7:0
    """,
}


def printed(register: Register) -> str:
    """Return a register in the notation above."""
    marks = {
        "EALLOW": register.protected,
        "32": register.width == 32,
        "runs": register.yields is Yields.TIME,
        "acts": register.read_acts,
        f"+{register.upper}": register.upper,
    }
    head = " ".join([f"{register.offset:02X}", register.name, *(mark for mark, on in marks.items() if on)])
    row = in_a_row(register.fields)
    return f"{head}: {row or ', '.join(map(printed_field, register.fields))}"


def printed_field(f: Field, bits: str = "") -> str:
    words = [f.name, bits or f.bits]
    if f.access != "R/W":
        words.append(f.access)
    if f.reset:
        words.append(f"={f.reset:X}")
    if f.tie is not Tie.SOFTWARE:
        words.append("tie")
    return " ".join(words)


def in_a_row(fields: tuple[Field, ...]) -> str:
    """Return "GPIO0 to GPIO31 x1 =FFF" for equal fields with consecutive numbers and bits, and "" for others."""
    rising = fields if fields[0].lsb == 0 else fields[::-1]
    width = rising[0].msb + 1
    stem = rising[0].name.rstrip("0123456789")
    first = rising[0].name.removeprefix(stem)
    kinds = {(f.access, f.tie) for f in rising}
    if len(rising) < 5 or len(kinds) > 1 or not first:
        return ""
    for i, f in enumerate(rising):
        if (f.name, f.lsb, f.msb) != (f"{stem}{int(first) + i}", width * i, width * i + width - 1):
            return ""
    resets = sum(f.reset << f.lsb for f in rising)
    whole = replace(rising[0], reset=resets)
    return printed_field(whole, f"to {rising[-1].name} x{width}")


def lines(text: str) -> list[str]:
    """Return the lines of the table; a line with more indentation continues the line before it."""
    found: list[str] = []
    for line in text.strip("\n").splitlines():
        if line.startswith(" " * 12):
            found[-1] += " " + line.strip()
        elif line.strip():
            found.append(line.strip())
    return found


@pytest.mark.parametrize("module", MAPS)
def test_the_register_map_of_each_module(module: str):
    assert [printed(register) for register in MAPS[module]] == lines(MANUAL[module])


# SPRUFB0D Table 111: the lines of each group; "-" if there is none.
GROUPS = """
    SEQ1INT      SEQ2INT      -            XINT1        XINT2        ADCINT       TINT0       WAKEINT
    EPWM1_TZINT  EPWM2_TZINT  EPWM3_TZINT  EPWM4_TZINT  EPWM5_TZINT  EPWM6_TZINT  -           -
    EPWM1_INT    EPWM2_INT    EPWM3_INT    EPWM4_INT    EPWM5_INT    EPWM6_INT    -           -
    ECAP1_INT    ECAP2_INT    ECAP3_INT    ECAP4_INT    ECAP5_INT    ECAP6_INT    -           -
    EQEP1_INT    EQEP2_INT    -            -            -            -            -           -
    SPIRXINTA    SPITXINTA    MRINTB       MXINTB       MRINTA       MXINTA       -           -
    DINTCH1      DINTCH2      DINTCH3      DINTCH4      DINTCH5      DINTCH6      -           -
    I2CINT1A     I2CINT2A     -            -            SCIRXINTC    SCITXINTC    -           -
    SCIRXINTA    SCITXINTA    SCIRXINTB    SCITXINTB    ECAN0INTA    ECAN1INTA    ECAN0INTB   ECAN1INTB
    -            -            -            -            -            -            -           -
    -            -            -            -            -            -            -           -
    XINT3        XINT4        XINT5        XINT6        XINT7        -            LVF         LUF
"""


def test_lines_of_the_pie():
    rows = [row.split() for row in GROUPS.strip().splitlines()]
    places = {name: (g, y) for g, row in enumerate(rows, 1) for y, name in enumerate(row, 1) if name != "-"}
    assert places == pie_map.LINES


def test_vectors_without_a_pie_group():
    others = ["INT13", "INT14", "DATALOG", "RTOSINT", "EMUINT", "NMI", "ILLEGAL", *(f"USER{n}" for n in range(1, 13))]
    assert {"RESET": 0} | dict(zip(others, range(13, 32), strict=True)) == pie_map.CPU_VECTORS


def names(holds: Callable[[Register], bool]) -> set[str]:
    return {f"{one.name}.{register.name}" for one in PART.modules for register in one.registers if holds(register)}


def test_kinds_of_values_that_registers_yield():
    scis = ("SCI-A", "SCI-B", "SCI-C")
    received = {"I2C-A.I2CDRR", "SPI-A.SPIRXBUF", *(f"{sci}.SCIRXBUF" for sci in scis)}
    copies = {"SPI-A.SPIRXEMU", *(f"{sci}.SCIRXEMU" for sci in scis)}
    sent = {"I2C-A.I2CDXR", "SPI-A.SPITXBUF", *(f"{sci}.SCITXBUF" for sci in scis)}
    counts = {f"TIMER{n}.{name}" for n in range(3) for name in ("TIM", "TIMH", "TPR", "TPRH")} | {"SYS.WDCNTR"}
    assert names(lambda register: register.yields is Yields.DATA) == received | copies | sent
    assert names(lambda register: register.yields is Yields.TIME) == counts
    assert names(lambda register: register.reads_take) == received | {"I2C-A.I2CISRC"}
    assert {name for name in names(lambda register: True) if reads_take(name)} == received | {"I2C-A.I2CISRC"}
    assert {name for name in names(lambda register: True) if yields_data(name)} == received | copies | sent
    assert not any(holds(name) for holds in (reads_take, yields_data) for name in ("", "I2CDRR", "ADC.ADCST"))
