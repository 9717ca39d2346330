"""C sources of firmware compiled by gcc for the host, with register accesses simulated.

For debugging logic with gdb and UBSan. Numbers have the host's sizes, and the time between accesses is estimated; in an
image, each instruction takes the cycles of the CPU's manual.
"""
