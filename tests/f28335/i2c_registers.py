"""Registers of the I2C module for the tests: offsets, bits and codes, copied from the tables of SPRUG03B.

They are independent of the model's register map, so that the tests detect mistakes in it. Tests name a single flag by
its text ("XRDY"), and use its mask (XRDY) to write or compare the value of a whole register.
"""

from __future__ import annotations

# Table 4: register offsets.
OFFSET = {
    "I2COAR": 0x00,
    "I2CIER": 0x01,
    "I2CSTR": 0x02,
    "I2CCLKL": 0x03,
    "I2CCLKH": 0x04,
    "I2CCNT": 0x05,
    "I2CDRR": 0x06,
    "I2CSAR": 0x07,
    "I2CDXR": 0x08,
    "I2CMDR": 0x09,
    "I2CISRC": 0x0A,
    "I2CEMDR": 0x0B,
    "I2CPSC": 0x0C,
    "I2CFFTX": 0x20,
    "I2CFFRX": 0x21,
}

# I2CSTR, Table 10.
AL, NACK, ARDY, RRDY, XRDY, SCD = (1 << n for n in range(6))
AD0, AAS, XSMT, RSFULL, BB, NACKSNT, SDIR = (1 << n for n in range(8, 15))
STR_RESET = XSMT | XRDY
FLAGS = {
    "AL": AL,
    "NACK": NACK,
    "ARDY": ARDY,
    "RRDY": RRDY,
    "XRDY": XRDY,
    "SCD": SCD,
    "AD0": AD0,
    "AAS": AAS,
    "XSMT": XSMT,
    "RSFULL": RSFULL,
    "BB": BB,
    "NACKSNT": NACKSNT,
    "SDIR": SDIR,
}
W1C = AL | NACK | ARDY | RRDY | SCD | NACKSNT | SDIR

# I2CMDR, Table 5.
FDF, STB, IRS, DLB, RM, XA, TRX, MST, STP = (1 << n for n in range(3, 12))
STT, FREE, NACKMOD = 1 << 13, 1 << 14, 1 << 15

MDR = {
    "NACKMOD": NACKMOD,
    "FREE": FREE,
    "STT": STT,
    "STP": STP,
    "MST": MST,
    "TRX": TRX,
    "XA": XA,
    "RM": RM,
    "DLB": DLB,
    "IRS": IRS,
    "STB": STB,
    "FDF": FDF,
}

# I2CIER, Table 9.
IE_AL, IE_NACK, IE_ARDY, IE_RRDY, IE_XRDY, IE_SCD, IE_AAS = (1 << n for n in range(7))

# I2CFFTX and I2CFFRX, Tables 21 and 22: FFEN is in I2CFFTX only; the other bits have the same positions in both.
FFEN, FFRST, FFINT, FFINTCLR, FFIENA = 1 << 14, 1 << 13, 1 << 7, 1 << 6, 1 << 5

CODES = {"": 0, "AL": 1, "NACK": 2, "ARDY": 3, "RRDY": 4, "XRDY": 5, "SCD": 6, "AAS": 7}  # I2CISRC

# Interrupt lines.
INT1, INT2 = 1, 2
