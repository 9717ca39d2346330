"""Cycles of C28x instructions in SYSCLKOUT, without the wait states of memory and bus.

Source: SPRU430F chapter 6, the CYC line of each instruction, which a test compares with `c28x/encodings.toml`; for
interrupt delays, the comment at each. "Taken" and "not taken" are given only if they differ.
"""

from __future__ import annotations

# Loads, stores, arithmetic, tests: MOV, MOVW DP, AND, OR, ADD, CMP, TBIT, ADDB SP, SUBB SP, NOP.
SIMPLE = 1

# Branches
B_TAKEN = SB_TAKEN = XB_TAKEN = 7
B_NOT_TAKEN = SB_NOT_TAKEN = XB_NOT_TAKEN = 4
SB_ALWAYS = 4  # condition UNC
BF_TAKEN = BF_NOT_TAKEN = SBF_TAKEN = SBF_NOT_TAKEN = 4
BANZ_TAKEN = BAR_TAKEN = 4
BANZ_NOT_TAKEN = BAR_NOT_TAKEN = 2
LB = 4

# Calls and returns
LC = LCR = FFC = 4
LRETR = 4
LRET = LRETE = 8

# Interrupt control
CLRC_INTM = SETC_INTM = 2  # EINT and DINT are the same instructions
CLRC_DBGM = SETC_DBGM = 2
EALLOW = EDIS = 4
AND_IER = OR_IER = AND_IFR = OR_IFR = 2
MOV_IER_LOC16 = 5  # write IER
MOV_LOC16_IER = 1  # read IER
TRAP = INTR = 8
IRET = 8
IDLE = 5

# Stack
PUSH = POP = 1  # one register
PUSH_ACC = PUSH_LOC16 = POP_LOC16 = 2
POP_RPC = 3
POP_ST1 = POP_IFR = POP_DBGIER = 5

RPT = 1  # RPT #n; from memory 4

# Interrupt path
IFR_DELAY = 4  # from a request to the CPU's IFR bit (share of the 14 cycles of `int_latency`, E2E thread)
VECTOR_AND_SAVE = 9  # from the vector fetch to the first instruction, SPRUFB0D section 8
PIEIER_SETTLE = 5  # after a PIEIER write until no pulse is in transit, SPRUFB0D section 8.3.2
