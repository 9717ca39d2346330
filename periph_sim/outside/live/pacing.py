"""Pacing of simulated time by a clock: how long to wait for a tick, and how late the simulation reaches it.

    due(tick) = the time of the clock at which a tick is due; lateness = the delay after this time

Lateness is a property of this computer, and nothing in the simulation depends on it.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from fractions import Fraction
from typing import Literal

from ...core.phrases import counted
from ..errors import OutsideError

WhenLate = Literal["slip", "catch-up", "stop"]
TOLERATED = 0.050  # lateness, in seconds, above which a step counts as late
STEPS = (0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.010, 0.020, 0.050, 0.100, 1.0)  # limits of the histogram, in s


class Pacer:
    """Timekeeper of a simulation, which computes the time to wait for each step and records how late the steps are.

    pace: the number of simulated seconds in a second of the clock; 0 for full speed.
    when_late: the reaction to a lateness above TOLERATED. "slip": all later ticks are due later by the lateness;
        "catch-up": the simulation runs without waiting until it is on time; "stop": OutsideError is raised.
    worst: the largest lateness, in seconds.
    late: the number of steps whose lateness was above TOLERATED.
    slips: the number of times that the due times of later ticks were moved.
    """

    def __init__(
        self,
        ticks_per_second: int,
        pace: Fraction = Fraction(1),
        when_late: WhenLate = "slip",
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        if pace < 0:
            raise OutsideError(f"pace {pace}: expected 0, as fast as it can, or more")
        self.when_late = when_late
        self.late = self.slips = 0
        self.worst = 0.0
        # A histogram: for each class of lateness, the number of steps of the simulation. STEPS has the upper limits of
        # the classes; the last class has no upper limit.
        self.counts = [0] * (len(STEPS) + 1)
        self._per_second = float(ticks_per_second * pace)
        self._clock = clock
        self._origin: float | None = None

    def wait(self, tick: int) -> float:
        """Return the seconds until this tick is due; 0 if it is due already, and always at full speed.

        The tick of the first call is due at the time of this call. The due times of all other ticks follow from this
        and from the slips.
        """
        if not self._per_second:
            return 0.0
        now = self._clock()
        if self._origin is None:
            self._origin = now - tick / self._per_second
        return max(0.0, self._origin + tick / self._per_second - now)

    def reached(self, tick: int) -> None:
        """Record the lateness of the simulation, which has reached this tick.

        Raise OutsideError if the lateness is above TOLERATED and `when_late` is "stop".
        """
        if not self._per_second or self._origin is None:
            return
        lateness = self._clock() - (self._origin + tick / self._per_second)
        self.worst = max(self.worst, lateness)
        self.counts[sum(lateness > step for step in STEPS)] += 1
        if lateness > TOLERATED:
            self.late += 1
            if self.when_late == "stop":
                raise OutsideError(f"simulated time is {lateness * 1000:.1f} ms late, and --when-late is stop")
            if self.when_late == "slip":
                self._origin += lateness
                self.slips += 1

    def percentile(self, share: float) -> float:
        """Return the lateness, in seconds, that this share of the simulation's steps does not exceed.

        The result is rounded up to a limit of the histogram. Above the last limit, it is `worst`.
        """
        wanted, passed = share * sum(self.counts), 0
        for step, count in zip(STEPS, self.counts, strict=False):
            passed += count
            if passed >= wanted:
                return step
        return self.worst

    def text(self) -> list[str]:
        """Return the statistics as lines of text; an empty list at full speed, or if no step was recorded."""
        total = sum(self.counts)
        if not total:
            return []
        lines = [f"lateness: 99 % of {total} steps within {in_ms(self.percentile(0.99))}, worst {in_ms(self.worst)}"]
        shares = zip(
            (*(f"up to {in_ms(step)}" for step in STEPS), f"beyond {in_ms(STEPS[-1])}"), self.counts, strict=True
        )
        lines += [f"  {count:>8}  {name}" for name, count in shares if count]
        if self.late:
            effect = {"slip": counted(self.slips, "slip"), "catch-up": "caught up", "stop": "stopped"}[self.when_late]
            lines.append(f"later than {in_ms(TOLERATED)}: {counted(self.late, 'time')}, {effect}")
        return lines


def in_ms(seconds: float) -> str:
    return f"{seconds * 1000:.3g} ms"
