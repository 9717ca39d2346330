"""Table of the SCI's registers: names as in C2000Ware's DSP2833x_Sci.h, offsets in words from the module's base.

All three modules (0x7050, 0x7750, 0x7770) have this map. The high byte of an 8-bit register reads 0 and ignores writes.

Source: TI SPRUFZ5A chapter 2.
"""

from __future__ import annotations

from ...core.registers import Register, RegisterMap, Yields, field

BASES = {"SCI-A": 0x7050, "SCI-B": 0x7750, "SCI-C": 0x7770}

SCI_MAP = RegisterMap(
    "SCI",
    "TI SPRUFZ5A chapter 2",
    (
        Register(
            "SCICCR",
            0x0,
            "SPRUFZ5A F2-1, T2-3",
            (
                field("STOPBITS", "7", doc="1 sends two stop bits; the receiver checks only the first."),
                field("PARITY", "6", doc="1 even, 0 odd."),
                field("PARITYENA", "5", doc="A parity bit is sent and expected."),
                field("LOOPBKENA", "4", doc="The receiver is connected to the transmitter inside the module."),
                field("ADDRIDLE_MODE", "3", doc="1 address-bit mode, 0 idle-line mode."),
                field("SCICHAR", "2:0", doc="Data bits of a character, less one."),
            ),
            width=8,
        ),
        Register(
            "SCICTL1",
            0x1,
            "SPRUFZ5A F2-2, T2-4",
            (
                field("RXERRINTENA", "6", doc="RXERROR requests RXINT."),
                field("SWRESET", "5", doc="0 holds state machines and flags in reset."),
                field("TXWAKE", "3", "R/S", doc="Marks the next character loaded; cleared when it moves to TXSHF."),
                field("SLEEP", "2", doc="Only address frames are received."),
                field("TXENA", "1", doc="Characters move to TXSHF and out."),
                field("RXENA", "0", doc="Characters move from RXSHF to SCIRXBUF."),
            ),
            width=8,
        ),
        Register(
            "SCIHBAUD", 0x2, "SPRUFZ5A F2-3", (field("BAUD", "7:0", doc="Bits 15 to 8 of the baud divider."),), width=8
        ),
        Register(
            "SCILBAUD", 0x3, "SPRUFZ5A F2-4", (field("BAUD", "7:0", doc="Bits 7 to 0 of the baud divider."),), width=8
        ),
        Register(
            "SCICTL2",
            0x4,
            "SPRUFZ5A F2-5, T2-6",
            (
                field("TXRDY", "7", "R", 1, "SCITXBUF can take a character."),
                field("TXEMPTY", "6", "R", 1, "SCITXBUF and TXSHF are both empty."),
                field("RXBKINTENA", "1", doc="RXRDY and BRKDT request RXINT (standard mode)."),
                field("TXINTENA", "0", doc="TXRDY requests TXINT (standard mode)."),
            ),
            width=8,
        ),
        Register(
            "SCIRXST",
            0x5,
            "SPRUFZ5A F2-7, T2-7",
            (
                field("RXERROR", "7", "R", doc="BRKDT, FE, OE or PE is set."),
                field("RXRDY", "6", "R", doc="SCIRXBUF holds a character not yet read."),
                field("BRKDT", "5", "R", doc="A break was received; needs SW RESET."),
                field("FE", "4", "R", doc="A first stop bit was 0."),
                field("OE", "3", "R", doc="A character replaced one that had not been read."),
                field("PE", "2", "R", doc="A parity bit did not fit."),
                field("RXWAKE", "1", "R", doc="An address frame, or an idle line before one."),
            ),
            width=8,
        ),
        Register(
            "SCIRXEMU",
            0x6,
            "SPRUFZ5A F2-8",
            (field("ERXDT", "7:0", "R", doc="SCIRXBUF's data, without the effects of reading it."),),
            width=8,
            yields=Yields.DATA,
            data="ERXDT",
        ),
        Register(
            "SCIRXBUF",
            0x7,
            "SPRUFZ5A F2-9, T2-8",
            (
                field("SCIFFFE", "15", "R", doc="Framing error of the word at the FIFO's head (FIFO mode)."),
                field("SCIFFPE", "14", "R", doc="Parity error of the word at the FIFO's head (FIFO mode)."),
                field("RXDT", "7:0", "R", doc="The character; reading removes it."),
            ),
            read_acts=True,
            yields=Yields.DATA,
            data="RXDT",
        ),
        Register(
            "SCITXBUF",
            0x9,
            "SPRUFZ5A F2-10",
            (field("TXDT", "7:0", doc="A write queues a character for sending."),),
            width=8,
            yields=Yields.DATA,
            data="TXDT",
        ),
        Register(
            "SCIFFTX",
            0xA,
            "SPRUFZ5A F2-11, T2-9",
            (
                field("SCIRST", "15", reset=1, doc="0 holds transmit and receive channels in reset."),
                field("SCIFFENA", "14", doc="FIFO mode."),
                field("TXFIFOXRESET", "13", reset=1, doc="0 empties the transmit FIFO and holds it so."),
                field("TXFFST", "12:8", "R", doc="Words waiting, 0 to 16."),
                field("TXFFINT", "7", "R", doc="TXFFST fell to TXFFIL."),
                field("TXFFINTCLR", "6", "W1", doc="Clears TXFFINT."),
                field("TXFFIENA", "5", doc="TXFFINT requests TXINT."),
                field("TXFFIL", "4:0", doc="Level of the transmit interrupt."),
            ),
        ),
        Register(
            "SCIFFRX",
            0xB,
            "SPRUFZ5A F2-12, T2-10",
            (
                field("RXFFOVF", "15", "R", doc="A word arrived while 16 were waiting."),
                field("RXFFOVRCLR", "14", "W1", doc="Clears RXFFOVF."),
                field("RXFIFORESET", "13", reset=1, doc="0 empties the receive FIFO and holds it so."),
                field("RXFFST", "12:8", "R", doc="Words waiting, 0 to 16."),
                field("RXFFINT", "7", "R", doc="RXFFST reached RXFFIL."),
                field("RXFFINTCLR", "6", "W1", doc="Clears RXFFINT."),
                field("RXFFIENA", "5", doc="RXFFINT requests RXINT."),
                field("RXFFIL", "4:0", reset=31, doc="Level of the receive interrupt."),
            ),
        ),
        Register(
            "SCIFFCT",
            0xC,
            "SPRUFZ5A F2-13, T2-11",
            (
                field("ABD", "15", "R", doc="'A' or 'a' was measured and the baud divider loaded."),
                field("ABDCLR", "14", "W1", doc="Clears ABD."),
                field("CDC", "13", doc="Waits for 'A' or 'a' to measure the rate."),
                field("FFTXDLY", "7:0", doc="Pause between words sent from the FIFO."),
            ),
        ),
        Register(
            "SCIPRI",
            0xF,
            "SPRUFZ5A F2-14, T2-12",
            (
                field("SOFT", "4", doc="With FREE = 0: a debugger stop waits for the current frame."),
                field("FREE", "3", doc="A debugger stop has no effect."),
            ),
            width=8,
        ),
    ),
)

# Masks of the fields of seven registers, in the order of their tables above. Of SCIFFTX, only the first two are needed.
STOPBITS, PARITY, PARITYENA, LOOPBKENA, ADDRIDLE_MODE, SCICHAR = (f.mask for f in SCI_MAP["SCICCR"].fields)
RXERRINTENA, SWRESET, TXWAKE, SLEEP, TXENA, RXENA = (f.mask for f in SCI_MAP["SCICTL1"].fields)
TXRDY, TXEMPTY, RXBKINTENA, TXINTENA = (f.mask for f in SCI_MAP["SCICTL2"].fields)
ST_RXERROR, ST_RXRDY, ST_BRKDT, ST_FE, ST_OE, ST_PE, ST_RXWAKE = (f.mask for f in SCI_MAP["SCIRXST"].fields)
SCIRST, SCIFFENA = (f.mask for f in SCI_MAP["SCIFFTX"].fields[:2])
ABD, ABDCLR, CDC, FFTXDLY = (f.mask for f in SCI_MAP["SCIFFCT"].fields)
SOFT, FREE = (f.mask for f in SCI_MAP["SCIPRI"].fields)
