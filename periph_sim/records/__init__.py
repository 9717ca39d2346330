"""Questions to a recorded run: causes of values, distances between reads and changes, faults of use.

    .psr --Run--> why, races, lint --> text, JSON

Nothing is simulated again: the records of `run --record x.psr` are all that is needed.
"""
