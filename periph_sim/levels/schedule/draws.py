"""The numbers that edge runs draw: seeds and a range go in; for each seed the same draws in the same order come out.

    Random(seed).randrange(n):  words of k bits, k = n.bit_length(), until one is below n       (CPython's random)
    getrandbits(32 * words)     the same words, lowest first, of which the upper k bits count

So that a call of Python draws many numbers at once; the rejection is arithmetic over arrays. Each seed is drawn once.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random

import numpy as np

from .clock import Ints

WORD = 32
TOGETHER = 1024  # seeds whose words stay in the CPU's cache


class Drawn:
    """`count` numbers of `Random(key(seed)).randrange(below)` of each seed.

    numbers: int64[count, seeds]. column: int64[scenarios], which of them.
    """

    def __init__(self, seeds: Ints, below: int, count: int, key: Callable[[int], int | str]) -> None:
        unique, self.column = np.unique(seeds, return_inverse=True)
        keys = [key(seed) for seed in unique.tolist()]
        self.numbers = np.empty((count, len(keys)), np.int64)
        for first in range(0, len(keys), TOGETHER):
            some = slice(first, first + TOGETHER)
            self.numbers[:, some] = _of_keys(keys[some], below, count)

    def row(self, number: int) -> Ints:
        """int64[scenarios]: the number-th of each."""
        found: Ints = self.numbers[number].take(self.column, mode="clip")
        return found


def _of_keys(keys: list[int | str], below: int, count: int) -> Ints:
    bits = below.bit_length()
    if bits > WORD:
        return _one_by_one(keys, below, count)
    share = below / (1 << bits)
    words = int(count / share + 6 * (count * (1 - share)) ** 0.5 / share) + 8
    found = np.empty((count, len(keys)), np.int64)
    one = Random(0)  # seeded anew for each: making another would seed it twice
    drawn = []
    for key in keys:
        one.seed(key)
        drawn.append(one.getrandbits(WORD * words).to_bytes(WORD // 8 * words, "little"))
    raw = b"".join(drawn)
    numbers = np.frombuffer(raw, "<u4").reshape(len(keys), words) >> np.uint32(WORD - bits)
    fits = numbers < below
    rank = np.cumsum(fits, axis=1, dtype=np.int32)
    enough = rank[:, -1] >= count
    fits &= (rank <= count) & enough[:, None]
    found[:, enough] = numbers[fits].reshape(-1, count).T
    for column in np.flatnonzero(~enough):
        found[:, column] = _one_by_one([keys[column]], below, count)[:, 0]
    return found


def _one_by_one(keys: list[int | str], below: int, count: int) -> Ints:
    columns: list[list[int]] = []
    for key in keys:
        draw = Random(key).randrange
        columns.append([draw(below) for _ in range(count)])
    return np.array(columns, np.int64).T
