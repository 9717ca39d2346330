"""One CPU, the program that it runs, and the modules of its chip.

    kernel --wake-up--> Processor --run(until)--> Program      reason of the stop <--
                            |                       |
                            |   reach, rest, take_interrupt, iret: True if complete; False: stop, and be run again
                            |                       |
         CpuTime <----------+-- Bus <---------------+-- reads, writes in a cycle that the bus named
           cycle, lease,        wait states, protection, EALLOW, posted writes, records, RAM
           wake-up                 ^
                               Interrupts <-- requests of modules
                                   due, context to and from the stack, vectors from the PIE's table

Data flow in one direction. `CpuTime` depends on the kernel, not on accesses. `Bus` ends a lease where a posted write
lands; it serves no interrupt and advances no clock. `Interrupts` wakes a sleeping CPU; the state of an interrupt is in
memory alone. `Processor` joins them and lets time pass between the steps. The only call upwards is `Program.place`, the
present statement of the program for records and messages.

A program makes an access in these steps, here a read of an address:

    at = bus.reads_at(time.cycle, address)    the cycle in which it has its value
    if not processor.reach(at): stop          earlier writes land on the way
    time.meet()                               the kernel's time is that cycle: chips may be accessed
    value = bus.read(at, address)

and these at the boundary before the next instruction:

    number = interrupts.due(time.cycle)
    if number and not processor.take_interrupt(number): stop       `enter(vector)` is called before it is run again

`Dsp` builds the unit of a scene. `python` contains the program that runs Python functions, `image` that of images.
"""
