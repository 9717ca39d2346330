"""What a recorded run can tell afterwards: why a field had its value, how near reads came to changes, faults of use.

    .psr --Run--> why, races, lint --> text, JSON

Nothing is simulated again: the records of `run --record x.psr` are all that is needed.
"""
