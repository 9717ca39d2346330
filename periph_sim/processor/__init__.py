"""One CPU, the program that it runs, and the modules of its chip.

    kernel --wake-up--> Processor --run(until)--> Program      reason of the stop <--
                            |                       |
                            |   reach, rest, take_interrupt, iret: True if complete, False if the program must stop
                            |                       |
         CpuTime <----------+-- Bus <---------------+-- reads, writes in a cycle that the bus named
           cycle, lease,        wait states, protection, EALLOW, posted writes, records, RAM
           wake-up                 ^
                               InterruptLines <-- requests of modules
                                   lines of the PIE and the CPU

Dependencies have one direction. `CpuTime` depends on the kernel, but not on accesses. `Bus` ends a lease at the cycle
at which a posted write lands; it serves no interrupt and advances no clock. A request wakes a sleeping CPU. The saved
context of an interrupt is only in memory. `Processor` joins these parts and lets time pass between the steps.
The only call upwards is `Program.place`, which returns the present statement of the program for records and messages.

A program that had to stop is run again later, and its step is complete then. It makes an access in these steps, here a
read of an address:

    at = bus.reads_at(time.cycle, address)    the cycle in which the read obtains its value
    if not processor.reach(at): stop          posted writes that land before this cycle take effect
    time.meet()                               the kernel's time becomes that cycle, so chips may be accessed
    value = bus.read(at, address)

At the boundary before the next instruction it makes these steps:

    number = processor.core.next_taken(time.cycle)
    if number and not processor.take_interrupt(number): stop       `enter(vector)` is called before the next run

`Dsp` builds the unit of a scene. `python` contains the program that runs Python functions, `image` that of images.
"""
