"""Firmware written as plain Python functions: a program of a processor.

    firmware --> Waits --> Cpu: accesses, instructions --> Processor: time, bus, interrupts
                            |                        <-- enter(vector)
                        PythonProgram: a greenlet; yields its turn, and continues

Each call of the firmware makes its accesses and lets their cycles pass. If something else may act first, the program
yields its turn: the kernel runs the due events on the firmware's own stack, up to the program's next turn. A service
routine is called on that stack, too.
"""
