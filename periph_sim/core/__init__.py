"""The base of every simulation: time, events, wires, records, registers, tables of case files, and snapshots.

Terms that all packages use:
scene: the units, parties and wires of one case, built and ready to run.
unit: one F28335 with its program.
party: a named participant that pulls wires low or samples them: a unit, a device, a controller, a fault.
agent: an object through which a party acts; the kernel runs its events (`agent.Agent`).
to settle: to take the level that results from all pulls. Wires do so at the end of each phase of a tick (`kernel`).
record: one noted event of a run (`records`). The present record is the one whose effects are simulated now.
shortcut: a sequence of events that is skipped, because its final state was set in one step (`agent.Shortcut`).
touched: a set with the names of the options on which the run has depended so far (`options`).
mask: an integer in which each bit represents one thing, such as a party or a line; bit i is thing i.
`# core:` begins a comment for the build of the compiled core (`periph_sim.form`). "compiled": the module is compiled to
    C. "compiled without checks for None": the C code does not check if an object is None before it uses its attributes.
    "python": this class or function stays in Python. "freelist 16": up to 16 deleted objects are kept for reuse.
    "C only": Python cannot call this function. "noexcept": this function never raises an exception.
"""
