"""Firmware written as plain Python functions: a program of a processor.

    firmware --> Cpu --> Waits, Accesses --> Instructions --> Processor: time, bus, interrupts
                                                  |     <-- enter(vector)
                                            PythonProgram: a greenlet; gives way, and goes on there

The firmware calls; each call makes its accesses and lets their cycles pass. Where the processor says that something
else may act first, the program gives way: the kernel does on the firmware's own stack what is due, up to its next turn.
A service routine is called on that stack, too.
"""
