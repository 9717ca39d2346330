"""C sources of firmware, compiled by gcc for the host: the computer that runs the simulation. Registers are simulated.

Compiled sources serve to debug the logic of firmware with gdb and UBSan. Types have the host's sizes, and the time
between two accesses is estimated. In an image, each instruction takes the cycles of the CPU's manual.
"""
