"""Firmware written as plain Python functions, which is a program of a processor.

    firmware --> Waits --> Cpu: accesses, instructions --> Processor: time, bus, interrupts
                            |                        <-- enter(vector)
                        PythonProgram: a greenlet, which yields its turn and continues later

Each call that the firmware makes performs its accesses and lets their cycles pass. If something else may act before
these cycles have passed, the program yields its turn: the kernel runs the due events, on the stack of the firmware,
until the program can continue. Service routines are called on that stack, too.
"""
