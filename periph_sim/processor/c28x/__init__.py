"""The C28x CPU with its FPU: decoding, assembling and executing instructions.

`encodings.toml` describes the instruction set for all these purposes. No module of this package depends on a chip or a
bus.

Terms of this package:

form: a row of `encodings.toml`, with a unique id. It describes one encoding of an instruction with one syntax of its
    operands.
field: the adjacent bits of an instruction that have the same letter in the form. Field l selects an operand in memory
    or in a register, loc16 or loc32; field c is a number or an address; field k is a condition of the CPU (COND), and
    field w is a condition of the FPU (CNDF).
pair: two consecutive words of code as one number of 32 bits. The first word is the upper half.
C2xLP, C27x: earlier CPUs. The C28x has some instructions and operand modes for code that was written for them.
AX: AL or AH, the lower or the upper half of the accumulator ACC.
PM: the field of ST0 that selects how the product register P is shifted before it is used.
D2, R2, E, W: phases of the pipeline. D2 is the second phase of decoding, R2 the second phase of reading, E execution,
    and W writing.
pass: one execution of the instruction that RPT repeats.
late result: a result of the FPU that is written only after the next instruction has been executed. The place of this
    next instruction is the delay slot.
"""
