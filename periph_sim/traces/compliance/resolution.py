"""Resolution of positions, and the thresholds at which a measured time is decisive.

    Capture --> Resolution --thresholds--> whole numbers of positions to compare with

A time of n samples is truly between n - 1 and n + 1 sample periods, both ends excluded: each edge is at the first
sample after it. Exact positions (ticks of a simulation) have no error. All arithmetic is in whole numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

from ..capture.capture import Capture
from ..capture.sampling import grid_of, is_exact

NS = 10**9


@dataclass(frozen=True)
class Resolution:
    """Resolution of the positions of a capture.

    rate: the number of positions per second.
    slack: the maximum error of a time in either direction, in positions; 0 if positions are exact.
    """

    rate: Fraction
    slack: int

    @property
    def period(self) -> Fraction:
        """Maximum error of a time, in nanoseconds."""
        return self.slack * NS / self.rate

    def ns(self, positions: int) -> Fraction:
        return positions * NS / self.rate

    def surely_at_least(self, ns: int) -> int:
        """Return the smallest number of positions that is certainly `ns` or more."""
        return ceil(ns * self.rate / NS) + self.slack

    def surely_at_most(self, ns: int) -> int:
        """Return the largest number of positions that is certainly `ns` or less."""
        return floor(ns * self.rate / NS) - self.slack

    def surely_below(self, ns: int) -> int:
        """Return the largest number of positions that is certainly less than `ns`."""
        return self.surely_at_most(ns) if self.slack else ceil(ns * self.rate / NS) - 1

    def surely_above(self, ns: int) -> int:
        """Return the smallest number of positions that is certainly more than `ns`."""
        return self.surely_at_least(ns) if self.slack else floor(ns * self.rate / NS) + 1


def resolution_of(capture: Capture, exact: bool | None = None) -> Resolution:
    """Return the resolution of the capture's positions.

    exact: how time stamps are interpreted. True: as exact instants. False: as samples on the coarsest grid that
        contains all edges. None: as exact if the capture is known to be exact, or if it is finer than any analyser.

    Raise ValueError if the capture has no rate.
    """
    if capture.rate is None:
        raise ValueError(f"{capture.path}: limits need a time base and the file states no rate; state the rate")
    if capture.sampled:
        return Resolution(capture.rate, 1)
    exact = is_exact(capture) if exact is None else exact
    return Resolution(capture.rate, 0 if exact else grid_of(capture.channels))
