"""Python's generator for many seeds at once: keys go in; of each the words that `random.Random(key)` makes come out.

    key --its 32-bit words--> init_by_array --> 624 words of state --twist, one word at a time--> temper --> 32 bits

Each step is one operation over an array of all keys, where Python takes one key after the other; only the words that
are asked for are made. Source: Matsumoto and Nishimura, Mersenne Twister (1998), mt19937ar.c; CPython's
Modules/_randommodule.c and Lib/random.py (a text's key is the text and its SHA-512, as one number).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from hashlib import sha512

import numpy as np
from numpy.typing import NDArray

Words = NDArray[np.uint32]

STATE, MIDDLE, WORD = 624, 397, 4
FIRST, BASIC = 19_650_218, 1_812_433_253
MIXED, MIXED_AGAIN = np.uint32(1_664_525), np.uint32(1_566_083_941)
TWIST, UPPER, LOWER = np.uint32(0x9908B0DF), np.uint32(0x80000000), np.uint32(0x7FFFFFFF)
TEMPERED = ((7, np.uint32(0x9D2C5680)), (15, np.uint32(0xEFC60000)))
ONE = np.uint32(1)


def same_length(keys: Sequence[int | str]) -> Iterator[tuple[NDArray[np.int64], Words]]:
    """Places of keys that have equally many words, and those, the lowest first: uint32[keys, words]."""
    if all(isinstance(key, str) for key in keys):
        texts = [str(key).encode() for key in keys]
        parts = [texts, [sha512(text).digest() for text in texts]]
    else:
        numbers = [int(key) for key in keys]
        if min(numbers) >= 0 and max(numbers) < 1 << 32:
            yield np.arange(len(keys)), np.array(numbers, np.uint32)[:, None]
            return
        parts = [[abs(key).to_bytes(((key.bit_length() + 31) // 32 or 1) * WORD, "big") for key in numbers]]
    lengths = np.fromiter(map(len, parts[0]), np.int64, len(keys))
    for length in np.unique(lengths).tolist():
        places = np.flatnonzero(lengths == length)
        chosen = parts if len(places) == len(keys) else [[part[place] for place in places.tolist()] for part in parts]
        columns = [np.frombuffer(b"".join(part), np.uint8).reshape(len(places), -1) for part in chosen]
        size = sum(column.shape[1] for column in columns)
        words = np.zeros((len(places), -(-size // WORD) * WORD), np.uint8)
        words[:, :size] = np.concatenate(columns, axis=1)[:, ::-1]
        yield places, words.view("<u4").astype(np.uint32, copy=False)


class Generators:
    """One generator of each key. keys: uint32[words, keys], fewer words than STATE."""

    def __init__(self, keys: Words) -> None:
        self._state = _seeded(keys)
        self._place = 0
        self._y, self._t = (np.empty(keys.shape[1], np.uint32) for _ in range(2))

    def word(self) -> Words:
        """The next 32 bits of each; to be read before the next call."""
        state, y, t = self._state, self._y, self._t
        place, self._place = self._place, (self._place + 1) % STATE
        np.bitwise_and(state[place], UPPER, out=y)
        np.bitwise_and(state[(place + 1) % STATE], LOWER, out=t)
        np.bitwise_or(y, t, out=y)
        np.bitwise_and(y, ONE, out=t)
        np.multiply(t, TWIST, out=t)
        np.right_shift(y, ONE, out=y)
        np.bitwise_xor(y, t, out=y)
        np.bitwise_xor(y, state[(place + MIDDLE) % STATE], out=y)
        state[place] = y
        y ^= np.right_shift(y, np.uint32(11), out=t)
        for by, mask in TEMPERED:
            np.left_shift(y, np.uint32(by), out=t)
            np.bitwise_and(t, mask, out=t)
            np.bitwise_xor(y, t, out=y)
        y ^= np.right_shift(y, np.uint32(18), out=t)
        return y


def _basic() -> Words:
    """init_genrand(FIRST)."""
    state = [FIRST]
    for place in range(1, STATE):
        before = state[-1]
        state.append((BASIC * (before ^ (before >> 30)) + place) & 0xFFFFFFFF)
    return np.array(state, np.uint32)


_BASIC = _basic()


def _seeded(keys: Words) -> Words:
    """init_by_array: uint32[STATE, keys]."""
    length, count = keys.shape
    added = keys + np.arange(length, dtype=np.uint32)[:, None]
    state = np.empty((STATE, count), np.uint32)
    t = np.empty(count, np.uint32)
    shift = np.uint32(30)

    def mix(before: int, by: np.uint32, into: Words | np.uint32) -> Words:
        np.right_shift(state[before], shift, out=t)
        np.bitwise_xor(t, state[before], out=t)
        np.multiply(t, by, out=t)
        return np.bitwise_xor(t, into, out=t)

    state[0] = _BASIC[0]
    for place in range(1, STATE):
        np.add(mix(place - 1, MIXED, _BASIC[place]), added[(place - 1) % length], out=state[place])
    np.add(mix(STATE - 1, MIXED, state[1]), added[(STATE - 1) % length], out=state[1])
    for place in range(2, STATE):
        np.subtract(mix(place - 1, MIXED_AGAIN, state[place]), np.uint32(place), out=state[place])
    np.subtract(mix(STATE - 1, MIXED_AGAIN, state[1]), ONE, out=state[1])
    state[0] = UPPER
    return state
