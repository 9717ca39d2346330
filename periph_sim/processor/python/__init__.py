"""Firmware written as plain Python functions: a program of a processor.

    firmware --> Cpu --> Waits, Accesses --> Instructions --> Processor: time, bus, interrupts
                                                  |     <-- enter(vector)
                                            FirmwareThread: a greenlet; gives way, and goes on there

The firmware calls; each call makes its accesses and lets their cycles pass. Where the processor says that something
else may act first, the greenlet gives way to the kernel. A service routine is called on the firmware's own stack.
"""
