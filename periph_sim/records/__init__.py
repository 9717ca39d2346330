"""Analysis of a recorded run: causes of values, distances between reads and changes, and misuse of peripherals.

    .psr --Run--> why, races, lint --> text, JSON

Nothing is simulated again: the records of `run --record x.psr` are all that is needed.
"""
