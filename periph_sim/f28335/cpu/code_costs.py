"""SYSCLKOUT cycles that C28x instructions and compiled C code take. Only `poll_pass` includes wait states.

The constants are for firmware that is not machine code, such as Python firmware. For programs that are images of
machine code, `processor/c28x/encodings.toml` has the cycles of all instructions.

The figures in `CodeCosts` were counted in the 127 different F28335 images (COFF, TI compilers 5.2 to 22.6, 3380
functions) of eight public repositories. Pipeline stalls are not included. docs/fidelity.md compares them with cycles
that were measured in running programs.

Source: SPRU430F chapter 6, the CYC line of each instruction; SPRUEO2A (FPU), SPRS439M Table 3-5 (wait states). The
comments at the interrupt delays cite their sources.
"""

from __future__ import annotations

from msgspec import Struct

# Cycles of MOV, MOVW DP, AND, OR, ADD, CMP, TBIT, ADDB SP, SUBB SP and NOP.
SIMPLE = 1

SB_NOT_TAKEN = 4
SB_ALWAYS = 4  # cycles of SB with the condition UNC, which always holds

# Cycles of the instructions that control interrupts.
CLRC_INTM = SETC_INTM = 2  # EINT and DINT are the same instructions
EALLOW = EDIS = 4
AND_IER = OR_IER = AND_IFR = 2
TRAP = 8
IRET = 8
IDLE = 5

# Cycles on the way from an interrupt request to the service routine.
IFR_DELAY = 4  # from a request to the CPU's IFR bit, according to TI's E2E forum; option `int_latency` includes it
VECTOR_AND_SAVE = 9  # from the vector fetch to the first instruction of the service routine, SPRUFB0D section 8


class CodeCosts(Struct, frozen=True):
    """Cycles of the code that a C compiler generates around register accesses and computations.

    The defaults are the median or the most frequent case; the comments give the range found.

    between_accesses: cycles of the code before a register access, for addresses, data, tests and branches.
    poll_pass: cycles of one pass of a loop that polls a register of peripheral frame 2, including the wait states.
    isr_prologue: cycles in which the code of a service routine saves registers. The 14 words that the CPU itself saves
        are not included.
    isr_epilogue: cycles in which a service routine restores these registers. IRET is not included.
    """

    between_accesses: int = 5  # lower and upper quartile: 1 and 15; between consecutive stores: 0
    poll_pass: int = 10  # range: 7 (TBIT, SBF) to 21 (a function that returns the bit)
    isr_prologue: int = 17  # range: 6 (a routine without calls) to 22 (a routine that uses all FPU registers)
    isr_epilogue: int = 13  # range: 3 to 18


# Costs without the code that a C compiler generates. Only a pass of a polling loop has its default cost.
BARE = CodeCosts(between_accesses=0, isr_prologue=0, isr_epilogue=0)
