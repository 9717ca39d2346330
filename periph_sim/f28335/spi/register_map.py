"""Table of the SPI's registers: names as in C2000Ware's DSP2833x_Spi.h, offsets in words from the module's base.

The high byte of an 8-bit register reads 0 and ignores writes. SPIPRI of the 2833x has only the two bits for debugger
stops; TRIWIRE and STEINV are bits of later devices.

Source: TI SPRUEU3 chapter 2. Its sections are numbered like those of SPRUG72, the guide for the 280x.
"""

from __future__ import annotations

from ...core.registers import Register, RegisterMap, Yields, field

BASE = 0x7040

SPI_MAP = RegisterMap(
    "SPI",
    "TI SPRUEU3 chapter 2",
    (
        Register(
            "SPICCR",
            0x0,
            "SPRUEU3 §2.1.1",
            (
                field("SPISWRESET", "7", doc="0 stops transfers and clears the flags of SPISTS."),
                field("CLKPOLARITY", "6", doc="Level of SPICLK between transfers."),
                field("SPILBK", "4", doc="A master receives what it sends, inside the module."),
                field("SPICHAR", "3:0", doc="Bits of a character, less one."),
            ),
            width=8,
        ),
        Register(
            "SPICTL",
            0x1,
            "SPRUEU3 §2.1.2",
            (
                field("OVERRUNINTENA", "4", doc="OVERRUN_FLAG requests RXINT (without FIFOs)."),
                field("CLK_PHASE", "3", doc="SPICLK is half a period later than the data."),
                field("MASTER_SLAVE", "2", doc="1 master, 0 slave."),
                field("TALK", "1", doc="0 leaves the data output undriven."),
                field("SPIINTENA", "0", doc="INT_FLAG requests RXINT (without FIFOs)."),
            ),
            width=8,
        ),
        Register(
            "SPISTS",
            0x2,
            "SPRUEU3 §2.1.3",
            (
                field("OVERRUN_FLAG", "7", "R/W1C", doc="A character replaced one that had not been read."),
                field("INT_FLAG", "6", "R", doc="A character is complete; cleared by reading SPIRXBUF."),
                field("BUFFULL_FLAG", "5", "R", doc="SPITXBUF holds a character that waits for SPIDAT."),
            ),
            width=8,
        ),
        Register(
            "SPIBRR",
            0x4,
            "SPRUEU3 §2.1.4",
            (field("BIT_RATE", "6:0", doc="LSPCLK cycles of a bit, less one; 0 to 2 mean four cycles."),),
            width=8,
        ),
        Register(
            "SPIRXEMU",
            0x6,
            "SPRUEU3 §2.1.5",
            (field("ERXB", "15:0", "R", doc="SPIRXBUF's character, without the effects of reading it."),),
            yields=Yields.DATA,
            data="ERXB",
        ),
        Register(
            "SPIRXBUF",
            0x7,
            "SPRUEU3 §2.1.6",
            (field("RXB", "15:0", "R", doc="The character received, right-justified; reading removes it."),),
            read_acts=True,
            yields=Yields.DATA,
            data="RXB",
        ),
        Register(
            "SPITXBUF",
            0x8,
            "SPRUEU3 §2.1.7",
            (field("TXB", "15:0", doc="A write queues a character, left-justified."),),
            yields=Yields.DATA,
            data="TXB",
        ),
        Register(
            "SPIDAT",
            0x9,
            "SPRUEU3 §2.1.8",
            (field("SDAT", "15:0", doc="Shift register: bit 15 goes out first, bits come in at bit 0."),),
        ),
        Register(
            "SPIFFTX",
            0xA,
            "SPRUEU3 §2.1.9",
            (
                field("SPIRST", "15", reset=1, doc="0 holds transmit and receive channels in reset."),
                field("SPIFFENA", "14", doc="FIFO mode."),
                field("TXFIFO", "13", reset=1, doc="0 empties the transmit FIFO and holds it so."),
                field("TXFFST", "12:8", "R", doc="Words waiting, 0 to 16."),
                field("TXFFINT", "7", "R", doc="TXFFST fell to TXFFIL."),
                field("TXFFINTCLR", "6", "W1", doc="Clears TXFFINT."),
                field("TXFFIENA", "5", doc="TXFFINT requests TXINT."),
                field("TXFFIL", "4:0", doc="Level of the transmit interrupt."),
            ),
        ),
        Register(
            "SPIFFRX",
            0xB,
            "SPRUEU3 §2.1.9",
            (
                field("RXFFOVF", "15", "R", doc="A word arrived while 16 were waiting."),
                field("RXFFOVFCLR", "14", "W1", doc="Clears RXFFOVF."),
                field("RXFIFORESET", "13", reset=1, doc="0 empties the receive FIFO and holds it so."),
                field("RXFFST", "12:8", "R", doc="Words waiting, 0 to 16."),
                field("RXFFINT", "7", "R", doc="RXFFST reached RXFFIL."),
                field("RXFFINTCLR", "6", "W1", doc="Clears RXFFINT."),
                field("RXFFIENA", "5", doc="RXFFINT requests RXINT."),
                field("RXFFIL", "4:0", reset=31, doc="Level of the receive interrupt."),
            ),
        ),
        Register(
            "SPIFFCT",
            0xC,
            "SPRUEU3 §2.1.9",
            (field("TXDLY", "7:0", doc="SPICLK periods between words sent from the FIFO."),),
        ),
        Register(
            "SPIPRI",
            0xF,
            "SPRUEU3 §2.1.10",
            (
                field("SOFT", "5", doc="With FREE = 0: a debugger stop waits until all words are sent."),
                field("FREE", "4", doc="A debugger stop has no effect."),
            ),
            width=8,
        ),
    ),
)

# Masks of the fields of five registers, in the order of their tables above. Of SPIFFTX, only the first two are needed.
SPISWRESET, CLKPOLARITY, SPILBK, SPICHAR = (f.mask for f in SPI_MAP["SPICCR"].fields)
OVERRUNINTENA, CLK_PHASE, MASTER_SLAVE, TALK, SPIINTENA = (f.mask for f in SPI_MAP["SPICTL"].fields)
OVERRUN_FLAG, INT_FLAG, BUFFULL_FLAG = (f.mask for f in SPI_MAP["SPISTS"].fields)
SPIRST, SPIFFENA = (f.mask for f in SPI_MAP["SPIFFTX"].fields[:2])
SOFT, FREE = (f.mask for f in SPI_MAP["SPIPRI"].fields)
