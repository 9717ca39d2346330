"""Cycles of C28x instructions in SYSCLKOUT, without the wait states of memory and bus.

These are the instructions that the processor executes itself; `c28x/encodings.toml` has the cycles of all others.

Source: SPRU430F chapter 6, the CYC line of each instruction; for interrupt delays, the comment at each.
"""

from __future__ import annotations

# Loads, stores, arithmetic, tests: MOV, MOVW DP, AND, OR, ADD, CMP, TBIT, ADDB SP, SUBB SP, NOP.
SIMPLE = 1

SB_NOT_TAKEN = 4
SB_ALWAYS = 4  # condition UNC

# Interrupt control
CLRC_INTM = SETC_INTM = 2  # EINT and DINT are the same instructions
EALLOW = EDIS = 4
AND_IER = OR_IER = AND_IFR = 2
TRAP = 8
IRET = 8
IDLE = 5

# Interrupt path
IFR_DELAY = 4  # from a request to the CPU's IFR bit (share of the 14 cycles of `int_latency`, E2E thread)
VECTOR_AND_SAVE = 9  # from the vector fetch to the first instruction, SPRUFB0D section 8
