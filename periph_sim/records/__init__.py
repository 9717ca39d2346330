"""Analysis of a recorded run: causes of values, distances between reads and changes, and misuse of peripherals.

    .psr --Run--> why, races, lint --> text, JSON

Nothing is simulated again: the records of `run --record x.psr` are all that is needed.

Terms of this package:

row: the index of a record in the table of a run.
place: a statement of the firmware, such as "function:line".
poll: a read of a register in a loop that waits for a change of the register. The simulation skips most polls of a long
    wait, and a recording contains only the first and the last of them.
pass: one execution of the body of such a loop.
"""
