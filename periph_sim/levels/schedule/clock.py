"""A unit's clock over arrays: cycles go in, ticks come out, and back, as `core.time.Clock` maps them.

    tick(cycle) = floor(cycle * num / den)          cycle_at(tick) = ceil(tick * den / num)

Ticks and cycles count from the begin of the run. num / den: ticks of a cycle, exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ...core.chip import NEVER
from ...core.time import days
from .errors import BadSchedule

Ints = NDArray[np.int64]
IntOrInts = int | Ints


@dataclass(frozen=True)
class CpuClock:
    """num, den: of all scenarios, or int64[scenarios]."""

    num: IntOrInts
    den: IntOrInts

    def tick(self, cycle: Ints) -> Ints:
        return cycle * self.num // self.den

    def cycle_at(self, tick: Ints) -> Ints:
        """The first cycle that begins at or after this tick."""
        return -(-tick * self.den // self.num)

    def of(self, scenarios: Ints) -> CpuClock:
        """That of these scenarios."""
        if isinstance(self.num, int):
            return self
        assert not isinstance(self.den, int)
        return CpuClock(self.num[scenarios], self.den[scenarios])

    def most(self, cycles: int) -> int:
        """No fewer ticks than so many cycles take on any of the clocks, as Python's integers."""
        return cycles * (int(np.max(self.num / np.asarray(self.den))) + 1)

    @property
    def longest(self) -> int:
        """Ticks of the longest run whose products fit 62 bits."""
        num, den = (int(np.max(part)) for part in (self.num, self.den))
        return (NEVER - 1) // max(num, den)


def check_length(ticks: int, longest: int, per_second: int) -> None:
    """BadSchedule, with the longest run, where a product of a run of so many ticks does not fit int64."""
    if ticks > longest:
        length, most = days(Fraction(ticks, per_second)), days(Fraction(longest, per_second))
        what = f"a run of {length} takes numbers beyond 2^62; with these clocks the longest is {most}"
        raise BadSchedule(f"{what}; ask for fewer rounds, or give ppm with fewer digits")
