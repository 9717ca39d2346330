"""The worst and the least of the values that one scenario takes, one by one: values go in, three numbers come out.

A value that is known as a fraction, ceil(part / den) less what is taken from it, is divided only where it is a new one:

    worst  <=>  part > above = (worst + takes at the least) * den
    least  <=>  part <= below = (least + takes at the most - 1) * den
"""

# core: compiled

from __future__ import annotations

from typing import final

FAR = (1 << 63) - 1
NO_VALUE = -FAR


@final
class ValueRange:
    """worst: NO_VALUE where there was no value; least: FAR then. count: of values."""

    def __init__(self) -> None:
        self.den = 1
        self.takes_least = self.takes_most = 0
        self.clear()

    def clear(self) -> None:
        self.worst = self.above = NO_VALUE
        self.least = self.below = FAR
        self.count = 0

    def take(self, value: int) -> None:
        self.take_all(value, value, 1)

    def take_worst(self, value: int) -> None:
        self.worst = value
        self.above = (value + self.takes_least) * self.den

    def take_least(self, value: int) -> None:
        self.least = value
        self.below = (value + self.takes_most - 1) * self.den

    def take_part(self, part: int) -> None:
        """The value ceil(part / den), where nothing is taken from it."""
        self.take_parts(part, part, 1)

    def take_parts(self, most: int, least: int, count: int) -> None:
        """Several values of which these are the largest and the smallest part."""
        if most > self.above:
            self.take_worst(-(-most // self.den))
        if least <= self.below:
            self.take_least(-(-least // self.den))
        self.count += count

    def take_all(self, most: int, least: int, count: int) -> None:
        """Several values of which these are the largest and the smallest."""
        if most > self.worst:
            self.take_worst(most)
        if least < self.least:
            self.take_least(least)
        self.count += count

    def moved_by(self, most: int, least: int) -> bool:
        """Whether values of these parts may be a new worst or a new least one."""
        return most > self.above or least <= self.below

    def take_unfinished(self, value: int) -> None:
        """What it has come to as the run ends: it counts where it is more than any before, and is no least value."""
        if value > self.worst:
            self.worst = value
            self.count += 1
            if self.least == FAR:
                self.least = value
