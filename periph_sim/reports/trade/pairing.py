"""Occurrences of two runs, paired: ticks by label of the reference and of a level go in; differences come out.

    reference  a1    b1  a2       the n-th a with the n-th a. One that a level lacks or adds has no partner;
    level      a1  a2  b1         one that comes in another order is no partner: each is an error without bound

Which of two that changed places is out of order, nobody can say: as few as possible are.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .moments import Ints, Label


@dataclass(frozen=True, eq=False)
class Paired:
    """differences: int64[n], level less reference, of those that have a partner in order.

    lacking, added, disordered: how many the level lacks, has besides, and has in another order.
    """

    differences: Ints
    lacking: int = 0
    added: int = 0
    disordered: int = 0

    @property
    def unbounded(self) -> int:
        return self.lacking + self.added + self.disordered


def pair(reference: Ints, level: Ints) -> Paired:
    """The n-th with the n-th."""
    both = min(len(reference), len(level))
    return Paired(level[:both] - reference[:both], len(reference) - both, len(level) - both)


def pair_moments(reference: Mapping[Label, Ints], level: Mapping[Label, Ints]) -> dict[Label, Paired]:
    """Every label of either run; order counts within a stream.

    A label of which some are lacking or added says nothing of the others' order: it is left out of that question.
    """
    nothing = np.empty(0, np.int64)
    labels = sorted(reference.keys() | level.keys())
    paired = {each: pair(reference.get(each, nothing), level.get(each, nothing)) for each in labels}
    streams: dict[str, list[Label]] = {}
    for label in labels:
        if not paired[label].unbounded:
            streams.setdefault(label.stream, []).append(label)
    for together in streams.values():
        before = np.concatenate([reference[each] for each in together])
        after = np.concatenate([level[each] for each in together])
        out = disordered(before, after)
        if out.any():
            begin = 0
            for each in together:
                end = begin + len(reference[each])
                part = out[begin:end]
                if part.any():
                    paired[each] = Paired(paired[each].differences[~part], disordered=int(part.sum()))
                begin = end
    return paired


def disordered(before: Ints, after: Ints) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Which of n moments changed their order, bool[n]: all but a longest run of them that did not.

    Moments that coincide in one of the two runs have no order there.
    """
    order = np.lexsort((after, before))
    later = after[order]
    out = np.zeros(len(before), np.bool_)
    if not np.any(later[1:] < later[:-1]):
        return out
    kept = _longest_rise(later.tolist())
    out[:] = True
    out[order[kept]] = False
    return out


def _longest_rise(values: list[int]) -> list[int]:
    """Places of a longest subsequence that never falls, by patience sorting."""
    tops: list[int] = []  # the least value that ends a rise of each length
    ends: list[int] = []  # where it is
    before: list[int] = []  # the place before each in its rise; -1 if it is the first
    for place, value in enumerate(values):
        length = bisect_right(tops, value)
        before.append(ends[length - 1] if length else -1)
        if length == len(tops):
            tops.append(value)
            ends.append(place)
        else:
            tops[length], ends[length] = value, place
    kept, place = [], ends[-1]
    while place >= 0:
        kept.append(place)
        place = before[place]
    return kept[::-1]
