"""Table of the F28335's I2C registers, with the masks and offsets that the model uses.

Names are as in TI's C header for the F2833x. Offsets are 16-bit words from BASE.

Source: TI SPRUG03B, tables 4 to 22. I2CEMDR is also in the C header, but not in the data manual (option
`emdr_present`).
"""

from __future__ import annotations

from ...core.registers import OnWrite, Register, RegisterMap, Yields, field

BASE = 0x7900

I2COAR = Register(
    "I2COAR",
    0x00,
    "SPRUG03B table 17",
    (field("OAR", "9:0", doc="Own address; bits 6:0 count with XA = 0, all ten with XA = 1."),),
)
I2CIER = Register(
    "I2CIER",
    0x01,
    "SPRUG03B table 9",
    (
        field("AAS", "6", doc="Enables the request of I2CSTR.AAS."),
        field("SCD", "5", doc="Enables the request of I2CSTR.SCD."),
        field("XRDY", "4", doc="Enables the request of I2CSTR.XRDY; 0 in FIFO mode."),
        field("RRDY", "3", doc="Enables the request of I2CSTR.RRDY; 0 in FIFO mode."),
        field("ARDY", "2", doc="Enables the request of I2CSTR.ARDY."),
        field("NACK", "1", doc="Enables the request of I2CSTR.NACK."),
        field("AL", "0", doc="Enables the request of I2CSTR.AL."),
    ),
)
I2CSTR = Register(
    "I2CSTR",
    0x02,
    "SPRUG03B table 10",
    (
        field("SDIR", "14", "R/W1C", doc="Addressed as slave-transmitter."),
        field("NACKSNT", "13", "R/W1C", doc="A NACK was sent as receiver."),
        field("BB", "12", "R", doc="The bus is busy: a START was seen and no STOP since."),
        field("RSFULL", "11", "R", doc="A byte waits in I2CRSR because I2CDRR is unread."),
        field("XSMT", "10", "R", 1, doc="0: the transmitter ran out of data."),
        field("AAS", "9", "R", doc="Addressed as slave."),
        field("AD0", "8", "R", doc="The general-call address was seen."),
        field("SCD", "5", "R/W1C", doc="A STOP was sent or seen."),
        field("XRDY", "4", "R", 1, doc="I2CDXR can take a byte."),
        field("RRDY", "3", "R/W1C", doc="I2CDRR holds an unread byte."),
        field("ARDY", "2", "R/W1C", doc="Master: the registers may be loaded for the next action."),
        field("NACK", "1", "R/W1C", doc="A NACK was received."),
        field("AL", "0", "R/W1C", doc="Arbitration lost."),
    ),
)
I2CCLKL = Register(
    "I2CCLKL", 0x03, "SPRUG03B table 13", (field("ICCL", "15:0", doc="SCL low time in module clocks, less d."),)
)
I2CCLKH = Register(
    "I2CCLKH", 0x04, "SPRUG03B table 14", (field("ICCH", "15:0", doc="SCL high time in module clocks, less d."),)
)
I2CCNT = Register("I2CCNT", 0x05, "SPRUG03B table 18", (field("ICDC", "15:0", doc="Bytes to move; 0 is 65536."),))
I2CDRR = Register(
    "I2CDRR",
    0x06,
    "SPRUG03B table 19",
    (field("DATA", "7:0", "R", doc="Byte received; output of the RX FIFO."),),
    read_acts=True,
    yields=Yields.DATA,
    data="DATA",
)
I2CSAR = Register(
    "I2CSAR", 0x07, "SPRUG03B table 16", (field("SAR", "9:0", "R/W", 0x3FF, doc="Address sent next as master."),)
)
I2CDXR = Register(
    "I2CDXR",
    0x08,
    "SPRUG03B table 20",
    (field("DATA", "7:0", doc="Byte to send; input of the TX FIFO."),),
    yields=Yields.DATA,
    data="DATA",
)
I2CMDR = Register(
    "I2CMDR",
    0x09,
    "SPRUG03B table 5",
    (
        field("NACKMOD", "15", doc="Receiver: answer NACK in the next acknowledge slot."),
        field("FREE", "14", doc="1: run on at a breakpoint."),
        field("STT", "13", doc="Master: send a START; clears itself."),
        field("STP", "11", doc="Master: send a STOP; clears itself."),
        field("MST", "10", doc="1: master."),
        field("TRX", "9", doc="1: transmitter (master, and free data format)."),
        field("XA", "8", doc="1: 10-bit addresses."),
        field("RM", "7", doc="1: repeat mode, I2CCNT does not count."),
        field("DLB", "6", doc="1: digital loopback."),
        field("IRS", "5", doc="0: the module is held in reset."),
        field("STB", "4", doc="Master: send a START byte first."),
        field("FDF", "3", doc="1: free data format, no address byte."),
        field("BC", "2:0", doc="Bits in the next data byte; 0 is 8."),
    ),
)
I2CISRC = Register(
    "I2CISRC",
    0x0A,
    "SPRUG03B table 11",
    (
        field("WRITE_ZEROS", "11:8", doc="Must be written 0."),
        field("INTCODE", "2:0", "RC", doc="0 none, 1 AL, 2 NACK, 3 ARDY, 4 RRDY, 5 XRDY, 6 SCD, 7 AAS."),
    ),
    read_acts=True,
)
I2CEMDR = Register(
    "I2CEMDR",
    0x0B,
    "SPRUG03B table 8",
    (field("BCM", "0", "R/W", 1, doc="Slave-transmitter: 1 requests a byte ahead of time, 0 when it is needed."),),
)
I2CPSC = Register(
    "I2CPSC", 0x0C, "SPRUG03B table 12", (field("IPSC", "7:0", doc="Module clock = SYSCLKOUT / (IPSC + 1)."),)
)
I2CFFTX = Register(
    "I2CFFTX",
    0x20,
    "SPRUG03B table 21",
    (
        field("I2CFFEN", "14", doc="1: FIFO mode, both ways."),
        field("TXFFRST", "13", doc="0: the TX FIFO is emptied and held empty."),
        field("TXFFST", "12:8", "R", doc="Bytes in the TX FIFO, 0 to 16."),
        field("TXFFINT", "7", "R", doc="TXFFST fell to or below TXFFIL."),
        field("TXFFINTCLR", "6", "W1", doc="1 clears TXFFINT."),
        field("TXFFIENA", "5", doc="Enables the request of TXFFINT."),
        field("TXFFIL", "4:0", doc="Level of TXFFINT."),
    ),
)
I2CFFRX = Register(
    "I2CFFRX",
    0x21,
    "SPRUG03B table 22",
    (
        field("RXFFRST", "13", doc="0: the RX FIFO is emptied and held empty."),
        field("RXFFST", "12:8", "R", doc="Bytes in the RX FIFO, 0 to 16."),
        field("RXFFINT", "7", "R", doc="RXFFST rose to or above RXFFIL."),
        field("RXFFINTCLR", "6", "W1", doc="1 clears RXFFINT."),
        field("RXFFIENA", "5", doc="Enables the request of RXFFINT."),
        field("RXFFIL", "4:0", doc="Level of RXFFINT."),
    ),
)

I2C_MAP = RegisterMap(
    "I2C",
    "TI SPRUG03B, TMS320x2833x/2823x I2C reference guide",
    (
        I2COAR,
        I2CIER,
        I2CSTR,
        I2CCLKL,
        I2CCLKH,
        I2CCNT,
        I2CDRR,
        I2CSAR,
        I2CDXR,
        I2CMDR,
        I2CISRC,
        I2CEMDR,
        I2CPSC,
        I2CFFTX,
        I2CFFRX,
    ),
)

# Word offsets of the registers.
OAR, IER, STR, CLKL, CLKH, CNT, DRR, SAR, DXR, MDR, ISRC, EMDR, PSC = range(0x0D)
FFTX, FFRX = 0x20, 0x21

# Masks of the fields of I2CSTR. I2CIER has the enables of AL to SCD in the same positions.
(
    STR_SDIR,
    STR_NACKSNT,
    STR_BB,
    STR_RSFULL,
    STR_XSMT,
    STR_AAS,
    STR_AD0,
    STR_SCD,
    STR_XRDY,
    STR_RRDY,
    STR_ARDY,
    STR_NACK,
    STR_AL,
) = (f.mask for f in I2CSTR.fields)
STR_RESET = I2CSTR.reset
STR_CLEARS = I2CSTR.mask(OnWrite.ONE_CLEARS)  # bits that a write of 1 clears (option `xrdy_w1c` may add XRDY)

# Masks of the fields of I2CMDR.
(
    MDR_NACKMOD,
    MDR_FREE,
    MDR_STT,
    MDR_STP,
    MDR_MST,
    MDR_TRX,
    MDR_XA,
    MDR_RM,
    MDR_DLB,
    MDR_IRS,
    MDR_STB,
    MDR_FDF,
    MDR_BC,
) = (f.mask for f in I2CMDR.fields)

# Bits of `out`, and of the masks of lines that master and slave pull low.
SCL, SDA = 1, 2
