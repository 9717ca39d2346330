"""Whole SCL pulses in the middle of a byte, followed in one go by everybody on the bus.

    controller: Pulses --> can each follower follow so many? --> what do they send? --> follow

In the middle of a byte the parties of a bus have nothing to decide: the controller clocks, the
sender of the byte puts bit after bit on SDA, the others count. As long as nothing else can happen
in the simulation and nobody wants to hear of each edge, these pulses come out the same whether
they are played edge by edge or worked out at once. The controller does the second where it can;
`tests/lines/test_i2c_pulses.py` holds the two against each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol


class Pulses(NamedTuple):
    """`number` pulses of SCL, which is low before and after. All times in ticks.

    first: when SCL rises first. high, low: the length of each phase; `low` also follows the last
    fall, and within `hold` of each fall the controller moves SDA, if it does.
    """

    first: int
    high: int
    low: int
    hold: int
    number: int

    def fall(self, pulse: int) -> int:
        """When pulse 0, 1, ... ends."""
        return self.first + pulse * (self.high + self.low) + self.high

    @property
    def end(self) -> int:
        """When SCL could rise once more."""
        return self.first + self.number * (self.high + self.low)


class Follower(Protocol):
    """A party that can follow pulses. The controller asks `can_follow`, then `sends`, then tells with `follow`."""

    def can_follow(self, pulses: Pulses) -> int:
        """How many of these pulses it can follow, if nothing but SCL and SDA moves; 0 if none."""

    def sends(self, pulses: Pulses) -> Sequence[int]:
        """The level that it gives SDA before the first pulse and after each of them; empty if it does not send."""

    def follow(self, pulses: Pulses, sda: Sequence[int]) -> None:
        """They have been. sda: the level of SDA before the first pulse and after each of them."""
