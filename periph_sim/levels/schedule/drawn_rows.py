"""The draws of `draws`, a seed's in a row, as a compiled loop makes them: seeds and a range go in; rows come out."""

from __future__ import annotations

from array import array
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .clock import Ints
from .draws import WORD, one_by_one
from .mersenne import same_length
from .twister import MOST, Twister

TOGETHER = 4096  # keys: their words and draws stay in the CPU's cache


def drawn_rows(keys: Sequence[int | str], below: int, count: int) -> Ints:
    """`count` numbers of `Random(key).randrange(below)` of each key: int64[keys, count]."""
    found = np.empty((len(keys), count), np.int64)
    twister = Twister()
    for first in range(0, len(keys), TOGETHER):
        some, rows = keys[first : first + TOGETHER], found[first : first + TOGETHER]
        if below.bit_length() > WORD:
            rows[:] = one_by_one(some, below, count).T
            continue
        for places, words in same_length(some):
            if words.shape[1] > MOST:
                rows[places] = one_by_one([some[place] for place in places.tolist()], below, count).T
            elif len(places) == len(rows):
                _draw(twister, words, below, rows)
            else:
                of_these = np.empty((len(places), count), np.int64)
                _draw(twister, words, below, of_these)
                rows[places] = of_these
    return found


def _draw(twister: Twister, words: NDArray[np.uint32], below: int, rows: Ints) -> None:
    """rows: contiguous, to be filled."""
    flat = array("I")
    flat.frombytes(words.tobytes())
    twister.draw(flat, words.shape[1], below, rows.shape[1], rows.reshape(-1))
