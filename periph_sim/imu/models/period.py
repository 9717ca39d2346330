"""Check of the period of the models' derivative against that at which they run.

If the models run less or more often than `period` states, every rate is wrong by the ratio, without any sign of it.
"""

from __future__ import annotations

from fractions import Fraction

from ...core.time import Timebase
from .parameters import ImuParameters
from .quantity import BadParameter

TOLERANCE = Fraction(1, 1000)  # clocks of unit, controller and host may differ by 1000 ppm together


def check_period(imu: ImuParameters, runs: Fraction, what: str) -> None:
    """Raise BadParameter unless the models' period is `runs` seconds, within 0.1 %. what: such as "once a round"."""
    period = Fraction(imu.period)
    if abs(period - runs) > TOLERANCE * runs:
        raise BadParameter(
            "imu.period",
            f"the models' period is {_shown(period)}, but they run {what}, every {_shown(runs)}; "
            "make them the same, or every rate is off by their ratio",
        )


def _shown(seconds: Fraction) -> str:
    base = Timebase()
    return base.show(base.ticks(seconds, "nearest"))
