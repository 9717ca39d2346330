"""One CPU and what runs on it: a program and the modules of a chip go in; cycles, accesses and interrupts come out.

    kernel --wake-up--> Processor --run(until)--> Program      why it stopped <--
                            |                       |
                            |   reach, rest, take, iret: True, it is done; False, stop and be run again
                            |                       |
         CpuTime <----------+-- Bus <---------------+-- reads, writes in a cycle that the bus named
           cycle, lease,        wait states, protection, EALLOW, writes on their way, records, RAM
           wake-up                 ^
                               Interrupts <-- requests of modules
                                   due, context to and from the stack, vectors from the PIE's table

Data flow one way. `CpuTime` knows the kernel and nothing of accesses. `Bus` tells it where a lease must end, since a
write lands there; it serves no interrupt and moves no clock. `Interrupts` wakes a sleeping CPU, and keeps nothing of an
interrupt but what it stored in memory. `Processor` joins them and lets time pass between the steps. Upwards goes one
question only: at which statement the program stands (`Program.place`), for records and for messages.

A program makes an access so, here a read of an address:

    at = bus.reads_at(time.cycle, address)    the cycle in which it has its value
    if not processor.reach(at): stop          landings of earlier writes are done on the way
    time.meet()                               the kernel's time is that cycle: chips may be told
    value = bus.read(at, address)

and at the boundary before the next instruction:

    number = interrupts.due(time.cycle)
    if number and not processor.take(number): stop       `enter(vector)` was called when it is run again

`Dsp` builds all this as a scene names it. `python` holds the program that runs Python functions.
"""
