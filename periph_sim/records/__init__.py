"""Analysis of a recorded run: causes of values, reads that nearly miss a change, and misuse of peripherals.

    .psr --Run--> why, races, lint --> text, JSON

Nothing is simulated again: the records of `run --record x.psr` are all that is needed.

Terms of this package:

record: one event of the run, such as an access to a register, a change of a register's field, or an edge of a wire.
row: the index of a record in the table of a run.
tick: the unit of time of a run.
unit: a simulated DSP with its peripherals (its modules).
place: a statement of the firmware, such as "function:line".
routine: the main program, or one run of an interrupt service routine.
field, flag: a field of a register; a field of one bit.
party: a chip or an external device that can pull a wire low.
poll: a read of a register in a loop that waits for a change of the register. The simulation skips most polls of a long
    wait, and a recording contains only the first and the last of them.
pass: one execution of the body of such a loop.
race: a read of a status register close to a change of this register. A small difference in time could let the read miss
    or see the change.
lint: a check for a certain misuse of a peripheral.
"""
