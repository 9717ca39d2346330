"""Firmware's C sources on the host: gcc compiles them, volatile accesses are hooked, registers are those of the models.

For debugging logic with gdb and UBSan. Numbers have the host's sizes, and the time between accesses is estimated: what
is timed to the cycle is an image.
"""
