"""Occurrences of two runs, paired by label: their differences in ticks, level less reference.

reference  a1    b1  a2       the n-th a with the n-th a. One that a level lacks or adds has no partner; labels
level      a1  a2  b1         that come in another order have an error without bound, too
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from .moments import Ints, Label


@dataclass(frozen=True, eq=False)
class Paired:
    """differences: int64[n], level less reference, of those that have a partner.

    unpaired: how many the level lacks or has besides. disordered: True if some are in another order.
    """

    differences: Ints
    unpaired: int = 0
    disordered: bool = False


def pair(reference: Ints, level: Ints) -> Paired:
    """Pair the n-th with the n-th."""
    both = min(len(reference), len(level))
    return Paired(level[:both] - reference[:both], abs(len(reference) - len(level)))


def pair_moments(reference: Mapping[Label, Ints], level: Mapping[Label, Ints]) -> dict[Label, Paired]:
    """Pair every label of either run; order counts within a stream.

    A label of which some are lacking or added says nothing of the others' order: it is left out of that question.
    """
    nothing = np.empty(0, np.int64)
    labels = sorted(reference.keys() | level.keys())
    paired = {each: pair(reference.get(each, nothing), level.get(each, nothing)) for each in labels}
    streams: dict[str, list[Label]] = {}
    for label in labels:
        if not paired[label].unpaired:
            streams.setdefault(label.stream, []).append(label)
    for together in streams.values():
        owners = np.repeat(np.arange(len(together)), [len(reference[each]) for each in together])
        before = np.concatenate([reference[each] for each in together])
        after = np.concatenate([level[each] for each in together])
        for place in np.unique(owners[disordered(before, after)]).tolist():
            paired[together[place]] = replace(paired[together[place]], disordered=True)
    return paired


def disordered(before: Ints, after: Ints) -> Ints:
    """Return the places of moments that come before or after a neighbour in one run, and not in the other.

    Moments that coincide in one of the two runs have no order there.
    """
    order = np.lexsort((after, before))
    later = after[order]
    falls = np.flatnonzero(later[1:] < later[:-1])
    found: Ints = np.unique(order[np.concatenate([falls, falls + 1])])
    return found
