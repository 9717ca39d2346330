"""The numbers that edge runs draw: seeds and a range go in; for each seed the same draws in the same order come out.

    Random(seed).randrange(n):  words of 32 bits, of which the upper k = n.bit_length() count, until one is below n

The words are those of `mersenne`, of many seeds at once, and the rejection is arithmetic over arrays. Few seeds are
left to Python's own generator, which takes less time for them. Each seed is drawn once.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from random import Random

import numpy as np

from .clock import Ints
from .mersenne import Generators, same_length

WORD = 32
TOGETHER = 8192  # seeds: with fewer the calls cost more than what they do, more do not fit the CPU's cache
FEW = 200  # seeds that are drawn one by one in the time that all calls of numpy take


class Drawn:
    """`count` numbers of `Random(key(seed)).randrange(below)` of each seed.

    numbers: int64[count, seeds]. column: int64[scenarios], which of them.
    """

    def __init__(self, seeds: Ints, below: int, count: int, key: Callable[[int], int | str]) -> None:
        unique, self.column = np.unique(seeds, return_inverse=True)
        self._in_order = np.array_equal(unique, seeds)
        keys = [key(seed) for seed in unique.tolist()]
        self.numbers = np.empty((count, len(keys)), np.int64)
        for first in range(0, len(keys), TOGETHER):
            some = slice(first, first + TOGETHER)
            self.numbers[:, some] = _of_keys(keys[some], below, count)

    def row(self, number: int) -> Ints:
        """int64[scenarios]: the number-th of each."""
        found: Ints = self.numbers[number]
        return found if self._in_order else found.take(self.column, mode="clip")


def _of_keys(keys: list[int | str], below: int, count: int) -> Ints:
    bits = below.bit_length()
    if bits > WORD or len(keys) < FEW:
        return one_by_one(keys, below, count)
    found = np.empty((count, len(keys)), np.int64)
    for places, words in same_length(keys):
        found[:, places] = _drawn(Generators(words.T.copy()), len(places), bits, below, count)
    return found


def _drawn(generators: Generators, keys: int, bits: int, below: int, count: int) -> Ints:
    """Each word goes where the next number of its key belongs, and stays there if it is below."""
    found = np.empty((count + 1, keys), np.uint32)
    flat, last = found.reshape(-1), count * keys + np.arange(keys)
    place = np.arange(keys)
    left = count
    while left > 0:  # as many words as are wanted at least
        for _ in range(left):
            numbers = generators.word() >> np.uint32(WORD - bits)
            flat[place] = numbers
            place += keys * (numbers < below)
            np.minimum(place, last, out=place)
        left = count - int(place.min()) // keys
    return found[:count].astype(np.int64)


def one_by_one(keys: Sequence[int | str], below: int, count: int) -> Ints:
    """By Python's own generator: int64[count, keys]."""
    columns: list[list[int]] = []
    for key in keys:
        draw = Random(key).randrange
        columns.append([draw(below) for _ in range(count)])
    return np.array(columns, np.int64).T
