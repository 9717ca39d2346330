"""Coverage of a case's free phase: runs of a case at many phases, and the ranges of phases at which a budget breaks.

    case --phases--> runs in which each start has the next phase ---> worst values of the budgets
                     failures --windows--> first and last phase, each with a neighbour that held

    case --table of states and starts--> runs of all entries, until no new state appears --> proven budgets

Terms of this package:

start: the beginning of a frame of the host, of a round of the controller, or of a send of the table [serial].
moved starts: the starts whose times a coverage chooses, in place of the schedule of the case.
period: the repeating time span within which a phase places a moved start, such as a round of the controller.
phase: the number of cycles from the beginning of a period to the moved start in it; for a send, the number of cycles by
    which it is later than in the case. It is free, because nothing fixes it: the devices have independent clocks.
cycle: a SYSCLKOUT cycle of the fastest unit.
run with one phase alone: a run in which all moved starts have the same phase.
to fail: a run fails if a budget is broken, if firmware hangs, or if an error ends the run. A phase fails if a run with
    this phase alone fails; otherwise, it holds.
window: a range of phases that fail.
rest, orbit, entry, closed table: see `closed_table`.
group: a round, a frame, or a round and a frame that overlap, from one rest to the next; see `pair_groups`.

A coverage proves nothing about other phases or states: each round begins in the state that its run happens to have
reached, and the other free inputs of the case take the values that the case draws for them. A closed table is a proof
for all starts, as long as the other inputs are as stated in the case.
"""
