"""Python's generator for many seeds, in a compiled loop: keys go in; of each its draws below a bound come out.

    key --its 32-bit words--> init_by_array --> 624 words of state --twist, one word at a time--> temper --> 32 bits

A step waits for the one before it, so a CPU takes several keys' steps at once in the time of one. Sources as those of
`mersenne`, which does the same over arrays.
"""

# core: compiled

from __future__ import annotations

from typing import Annotated, final

from ...form.c_types import Buffer, Int32, UInt32
from .clock import Ints
from .mersenne import BASIC, FIRST, MIDDLE, STATE

LANES = 32  # keys at once
MOST = 64  # words of a key
WORD = 0xFFFFFFFF
MIXED, MIXED_AGAIN = 1_664_525, 1_566_083_941
TWIST, UPPER, LOWER = 0x9908B0DF, 0x80000000, 0x7FFFFFFF
FIRST_TEMPER, SECOND_TEMPER = 0x9D2C5680, 0xEFC60000


@final
class Twister:
    _state: Annotated[list[UInt32], STATE * LANES]
    _added: Annotated[list[UInt32], MOST * LANES]
    _last: Annotated[list[UInt32], LANES]
    _word: Annotated[list[UInt32], LANES]
    _drawn: Annotated[list[int], LANES]
    _basic: Annotated[list[UInt32], STATE]

    def __init__(self) -> None:
        self._state, self._last, self._added = [0] * (STATE * LANES), [0] * LANES, [0] * (MOST * LANES)
        self._word, self._drawn = [0] * LANES, [0] * LANES
        self._basic = [0] * STATE  # init_genrand(FIRST)
        self._basic[0] = before = FIRST
        for place in range(1, STATE):
            self._basic[place] = before = (BASIC * (before ^ (before >> 30)) + place) & WORD

    def draw(self, words: Buffer[UInt32], length: int, below: int, count: int, found: Ints) -> None:
        """words: of each key so many, a key's in a row. found: int64[keys, count], below `below`."""
        assert 0 < length <= MOST and 0 < below <= WORD + 1 and count >= 0  # loops over C arrays are not checked
        keys = len(words) // length
        assert len(found) >= keys * count
        bits: int = 0
        while below >> bits:
            bits += 1
        for first in range(0, keys, LANES):
            lanes = min(LANES, keys - first)
            lane: int
            for lane in range(LANES):
                key = first + min(lane, lanes - 1)
                for place in range(length):
                    self._added[place * LANES + lane] = (words[key * length + place] + place) & WORD
            self._seed(length)
            self._numbers(lanes, below, 32 - bits, count, found, first * count)

    def _seed(self, length: int) -> None:  # core: vectors
        """init_by_array."""
        lane: int
        for lane in range(LANES):
            self._last[lane] = self._basic[0]
        key: int = 0
        place: int
        for place in range(1, STATE):
            self._mix(place, key * LANES, self._basic[place])
            key = key + 1 if key + 1 < length else 0
        for lane in range(LANES):
            mixed: UInt32 = self._last[lane]
            mixed = (self._state[LANES + lane] ^ ((mixed ^ (mixed >> 30)) * MIXED)) + self._added[key * LANES + lane]
            self._state[LANES + lane] = self._last[lane] = mixed & WORD
        for place in range(2, STATE):
            self._mix_again(place * LANES, place)
        self._mix_again(LANES, 1)
        for lane in range(LANES):
            self._state[lane] = UPPER

    def _mix(self, place: int, key: int, basic: UInt32) -> None:
        lane: Int32
        for lane in range(LANES):
            mixed: UInt32 = self._last[lane]
            mixed = ((basic ^ ((mixed ^ (mixed >> 30)) * MIXED)) + self._added[key + lane]) & WORD
            self._state[place * LANES + lane] = mixed
            self._last[lane] = mixed

    def _mix_again(self, at: int, place: UInt32) -> None:
        lane: Int32
        for lane in range(LANES):
            mixed: UInt32 = self._last[lane]
            mixed = ((self._state[at + lane] ^ ((mixed ^ (mixed >> 30)) * MIXED_AGAIN)) - place) & WORD
            self._state[at + lane] = mixed
            self._last[lane] = mixed

    def _numbers(self, lanes: int, below: int, shift: int, count: int, found: Ints, first: int) -> None:
        """`count` numbers of each lane, in rows of `found` from place `first` on; a word beyond them is left out."""
        for lane in range(lanes):
            self._drawn[lane] = 0
        place: int
        place, drawing = 0, lanes
        while drawing:
            self._words(place, shift)
            place = place + 1 if place + 1 < STATE else 0
            drawing = 0
            for lane in range(lanes):
                number: int
                drawn, number = self._drawn[lane], self._word[lane]
                if drawn < count:
                    found[first + lane * count + drawn] = number
                    self._drawn[lane] = drawn + (number < below)  # else the next one takes its place
                    drawing += 1

    def _words(self, place: int, shift: UInt32) -> None:  # core: vectors
        """The upper bits of the next word of each lane. Two loops, of which neither reads what it writes."""
        at, after, middle = place * LANES, (place + 1) * LANES, (place + MIDDLE) * LANES
        if place + 1 == STATE:
            after = 0
        if place + MIDDLE >= STATE:
            middle -= STATE * LANES
        lane: Int32
        for lane in range(LANES):
            y: UInt32 = (self._state[at + lane] & UPPER) | (self._state[after + lane] & LOWER)
            self._last[lane] = self._state[middle + lane] ^ (y >> 1) ^ (-(y & 1) & TWIST)
        for lane in range(LANES):
            y = self._last[lane]
            self._state[at + lane] = y
            y ^= y >> 11
            y ^= (y << 7) & FIRST_TEMPER
            y ^= (y << 15) & SECOND_TEMPER
            self._word[lane] = (y ^ (y >> 18)) >> shift
