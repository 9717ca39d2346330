"""Pairing of transfers of two runs that are similar, but not equal.

    A   read 6 of 68    read 6 of 53    read 6 of 1E
    B   53 NACK         read 1 of 53                     -->  the two reads of 53 are one, changed; the others are not

The similarity of two groups is their share of common words; half of them is enough, and so is the same sequence of
addresses, or of kinds of events. The pairing in order with the largest total similarity is chosen.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from .align import Run
from .event_names import Group

ENOUGH = 0.5
HEADS = {"START", "repeated START", "address"}
CLASSES = {"NACK": "ACK", "repeated START": "START", "cut byte": "byte", "cut frame": "frame"}


def similar_runs(a: Sequence[Group], b: Sequence[Group]) -> list[Run]:
    """Return the groups to pair, each as a run of one. The computing time grows with the product of both lengths."""
    score = [[is_similar(one, other) for other in b] for one in a]
    best = [[0.0] * (len(b) + 1) for _ in range(len(a) + 1)]
    for i in reversed(range(len(a))):
        for j in reversed(range(len(b))):
            paired = best[i + 1][j + 1] + score[i][j] if score[i][j] >= ENOUGH else 0.0
            best[i][j] = max(paired, best[i + 1][j], best[i][j + 1])
    found: list[Run] = []
    i = j = 0
    while i < len(a) and j < len(b):
        if score[i][j] >= ENOUGH and best[i][j] == best[i + 1][j + 1] + score[i][j]:
            found.append(Run(i, j, 1))
            i, j = i + 1, j + 1
        elif best[i][j] == best[i + 1][j]:
            i += 1
        else:
            j += 1
    return found


def is_similar(a: Group, b: Group) -> float:
    """Return the similarity: 0 for nothing in common, 1 for the same words in any order."""
    common = Counter(event.word for event in a) & Counter(event.word for event in b)
    share = 2 * common.total() / (len(a) + len(b))
    same = shape(a) == shape(b) or (head(a) == head(b) != ())
    return max(share, ENOUGH if same else 0.0)


def head(group: Group) -> tuple[str, ...]:
    """Return the group's addresses and START conditions."""
    return tuple(event.word for event in group if event.kind in HEADS)


def shape(group: Group) -> tuple[str, ...]:
    """Return the classes of the group's events."""
    return tuple(class_of(event.kind) for event in group)


def class_of(kind: str) -> str:
    """Return the class of a kind; kinds that may replace one another are of one class."""
    return CLASSES.get(kind, kind)
