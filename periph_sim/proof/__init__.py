"""Verdicts for free starts: a *coverage* runs a case at many phases, and a *closed table* proves all starts.

    case --phases--> runs in which each start has the next phase --> worst values of the budgets       coverage
                                  '--those that fail--> windows
    case --entries--> one run of each, until no new state of rest appears --> proven budgets           closed table

GLOSSARY of this package. Its files use these terms without another explanation.

Starts:

tick: the unit of simulated time.
cycle: a SYSCLKOUT cycle of the fastest unit. A closed table needs cycles of a whole number of ticks.
round: the requests of one period of the controller.
frame: the burst of characters that the host sends in one period.
send: one transmission of the table [serial].
start: the tick at which a round, a frame or a send begins.
free start: a start that can come at any time, because nothing fixes it: the devices have independent clocks.
run: one simulation of the case from power-up, with many starts. Its *outcome* is its verdicts and failures.
covered budget: a budget that these runs judge. The others are *left out*, each with a reason.

Coverage:

moved starts: the free starts whose times a coverage chooses, instead of the times in the case.
phase: the number of cycles from a reference time to a moved start. For a frame in a case with rounds, the reference is
    the start of a round; for other starts, it is their time in the case. A *period* has all phases that can occur.
run with one phase alone: a run whose moved starts, normally 41, all have the same phase.
to fail: a run fails if it breaks a budget, if firmware hangs, or if an error ends it. A phase fails if the run with
    this phase alone fails. A phase *holds* if it is in a run, with or without other phases, that does not fail.
drifting failure: a failure of a run with increasing phases that no run with one phase alone repeats.
window: a range of phases that fail in the same way. Its first and last phase are always run, the others in part.
part: up to 512 phases that are run by one call, possibly in another process.

Closed table:

    orbit 0, 4 ticks             a round starts at tick 1           orbit 1, 5 ticks
    0 1 2 3 0 1 2 3 0 1 2 3 0 1 ==========================> rest at 3 4 0 1 2 3 4 0 1 ...
                                       36 ticks long
    entry (orbit 0, tick 1): its round leads to (orbit 1, tick 3), 36 ticks after its start

rest: a time between two rounds or frames at which no event is due, while the firmware waits in a loop.
to settle: to advance until the scene is at rest.
normal state: the state of the scene without values that have no effect any more, such as instants that are *long past*.
    Scenes continue equally from equal normal states.
ignored attributes: attributes that are also left out of normal states, by name: here the numbers of rounds and frames.
orbit: the normal states of one rest. They repeat with a period, because clocks and passes of the loop repeat. An orbit
    has a number. Its *ticks* are those of one period, from 0.
place: an orbit and one of its ticks (in some tables: one of its cycles). It stands for a state of rest.
entry: a place at which the next round or frame starts. Each is run once, and is *open* before that.
closed: a table is closed if each entry was run and led to a place of an orbit of the table. Then each round of any run
    is like one of the entries, whatever the distances between the starts are.
to run again: to run a random entry a second time, after other rounds, and compare the effects as a test.
apart: the least distance of two starts for which a table holds, in ticks: the longest time from a start to the rest.
first start: the first start of the case. It comes before any rest, unless `rests_first` is True: then the scene rests
    first, and the first start is free, too.
way: a sequence of entries that leads from one orbit to another.

Closed table of a case with rounds and frames, which can overlap:

    rest ----- R == work == wait ~~~~~~~~~~~~~~~~~~~~~~~~ work == rest      R: start of a round, ~: passes of a loop
                 |cell|cell|cell|                                           X: start of a frame, whose end requests
                         X======== routine                                     the service routine of the SCI

group: a round, a frame, or both, from one rest to the next. Each entry of such a table runs a group. It consists of the
    tick R of the orbit, and the *distance* from R to the cell of frames with X. Pages and messages call it a *meeting*.
alone: a round alone is a group without a frame, and a frame alone is a group without a round.
cell of frames: the starts from one sample of the SCI to the next. Frames that start in one such cell are received
    at the same instant, so they count as one frame. The *offset* of a frame is its distance from the first tick of its
    cell of frames.
own period: the period of an orbit without the state of the SCI. Rounds are distinguished by R modulo this period.
wait: a time in which the firmware repeats equal passes of a loop, for instance until a flag is set. Code also calls
    it a sleep.
cell of groups: groups whose routine comes at the same tick of a pass, in different passes of one wait. Their effects
    are equal, so only the first and the last group are run.
alike: two runs of groups are alike if they lead to the same place and have the same digests of records.
task: a group to run, with its orbit, the offset of its frame and, for a check, a wait (`pair_run.Task`).
known: what earlier runs of the table have found: orbits, cells of frames and ways (`pair_run.Known`).

A coverage proves nothing about other phases or states: each round begins in the state that its run happens to have
reached, and the other inputs take the values that the case draws for them. A closed table is a proof for all starts, as
long as the other inputs are as in the case.
"""
