"""Conditions that must hold together: each measure is reduced to the occurrences that count for the first one.

    age            a   b       c    d            the first one says which occurrences count
    value error    a   b   x        d   y        of c it has no value: nothing is proven

Occurrences are the same if they begin at the same tick.
"""

from __future__ import annotations

import numpy as np

from .measure import Measure


def combine(measures: list[Measure]) -> list[int]:
    """Leave each measure only the values of occurrences that the first one has, too; all of them keep their values.

    Gives for each how many of these it has no value of. If any, all its values are dropped: it proves nothing.
    """
    _, wanted = measures[0].all_kept()
    lacking = [0]
    for measure in measures[1:]:
        _, at = measure.all_kept()
        lacking.append(int((~np.isin(wanted, at)).sum()))
        there = np.flatnonzero(np.isin(at, wanted))
        measure.only(there[:0] if lacking[-1] else there)
    return lacking
