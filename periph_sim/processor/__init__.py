"""One CPU, the program that it runs, and the modules of its chip.

    kernel --wake-up--> Processor --run--> Program
                            |                       |
                            |   reach, rest, take_interrupt, iret: True if complete, False if the program must stop
                            |                       |
         CpuTime <----------+-- Bus <---------------+-- reads and writes, in a cycle that the bus has returned before
           cycle, lease,        wait states, protection, EALLOW, posted writes, records, RAM
           wake-up                 ^
                               InterruptLines <-- requests of modules
                                   lines of the PIE and the CPU

`CpuTime` advances the clock of the CPU and makes no accesses. `Bus` makes accesses; it takes no interrupt and advances
no clock, but limits the time that may pass before the next posted write takes effect. `InterruptLines` wakes a sleeping
CPU when a module requests an interrupt. `Processor` joins these parts and lets time pass between the steps of the
program. The bus calls the program for one purpose: `Program.place` returns the present statement for records and
messages.

A program that had to stop is run again later, and the step for which it stopped is then complete. A read of an address
consists of these steps:

    at = bus.reads_at(time.cycle, address)    the cycle in which the read obtains its value
    if not processor.reach(at): stop          posted writes that land before this cycle take effect
    time.meet()                               the kernel's time becomes that cycle, so modules may be accessed
    value = bus.read(at, address)

At the boundary before the next instruction, the program makes these steps:

    number = processor.core.next_taken(time.cycle)
    if number and not processor.take_interrupt(number): stop       `enter(vector)` is called before the next run

`Dsp` builds the unit of a scene. `python` has the program that runs Python functions, `image` the one that runs images.

Terms of this package:

module: a peripheral of the chip, such as I2C-A or the PIE. Its `Socket` connects it with the kernel and the bus.
cycle: one period of SYSCLKOUT. A cycle number counts the periods since power-up.
effect of a read: what the read changes in a module, for example a flag that it clears.
boundary: an instant between two instructions, at which an interrupt can be taken.
to land: to take effect; a posted write lands some cycles after it was issued.
lease: the time in which nothing except the program of this CPU can act. The class `Lease` of `polling` is
    the time for which all passes of a wait have the same result.
wait: a loop of the program that reads values until a condition is true.
pass: one execution of a loop, or of the instruction that RPT repeats.
replay: a second execution of the pass in which a sleeping CPU was woken. It begins at the start of the pass. Reads
    before the cycle of the wake-up return the values that the last executed pass has read.
modify: a write of a bit field by one instruction, which reads and writes the word with the field.
statement: the line of the firmware's source that is executed, as a `SourceLocation`.
place: a statement. A class `Place`, or the description of a parameter, may give the word another meaning.
topic: all records of one kind that are about one thing, for example the reads of one register (`core.records.Topic`).
spread: a range of durations; each computation draws its duration from the range (`core.table.Spread`).
port: in `python`, an object for accesses to a register; in `pin_router`, an input or output of a module.
note: a remark on the firmware, for example on an access that violates a rule of the manuals.
frame: a peripheral frame, which is a range of registers with the same wait states. In `image.observers`, a frame is an
    active function on the call stack.
open question: a behaviour that the manuals do not state. An option selects the answer; its method `assume` returns the
    answer and notes that the run depends on it.
"""
