"""C sources of firmware, compiled by gcc for the host: the computer that runs the simulation. Registers are simulated.

Compiled sources serve to debug the logic of firmware with gdb and UBSan. Types have the host's sizes, and the time
between two accesses is estimated. For exact cycles, run an image (`processor.image`) instead.

Terms of this package:

register memory: memory of the host, in which C code finds the registers of the chip.
place: the position of a register, or of a word with bit fields, in register memory and on the chip (`Place`).
to announce: before each access, gcc's thread sanitizer calls runtime.c with the bytes that are accessed.
request: a call from runtime.c to Python, for example to read a register before C code reads its bytes.
"""
