"""Recording of a run, and its analysis: causes of values, reads that nearly miss a change, and misuse of peripherals.

    .psr --Run--> why, races, lint --> text, JSON

The analysis simulates nothing again: the records of `run --record x.psr` are all that is needed.

Terms of this package:

record: one event of the run, such as an access to a register, a change of a register's field, or an edge of a wire.
number: the serial number of a record, from 1 on. In a reference to another record, 0 means that there is none.
row: the index of a record in the table of a run, from 0 on.
cause: the record that led to another record.
tick: the unit of time of a run.
unit: a simulated DSP with its peripherals (its modules).
place: a statement of the firmware, such as "function:line".
routine: the main program, or one run of an interrupt service routine. A routine is identified by the number of the
    record of its entry; 0 identifies the main program.
field, flag: a field of a register; a field of one bit.
read-modify-write: a statement that reads a register, changes some bits and writes the whole register back. A bit-field
    write, the assignment to one field as in `i2c.I2CSTR.SCD = 1`, is one.
plain write: a write that does not belong to a read-modify-write.
span: a part of the firmware to which the firmware gave a name.
party: a unit or an external device that can pull a wire low.
program image: firmware that is a linked program for the F28335, in contrast to Python functions and C sources.
poll: a read of a register in a loop that waits for a change of the register. The simulation skips most polls of a long
    wait, and a recording contains only the first and the last of them.
pass: one execution of the body of such a loop.
race: a read of a status register close to a change of this register. A small difference in time could let the read miss
    or see the change.
lint: a check for a certain misuse of a peripheral.
"""
