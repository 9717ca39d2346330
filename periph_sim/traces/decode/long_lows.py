"""Table of the low phases of SCL that were longer than usual.

A target that is not ready stretches the low phase; a controller that pauses looks the same, since the lines do not show
who held SCL.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np

from ..capture.capture import Capture, Channel, Positions
from ..capture.sampling import sample_step
from .i2c_table import i2c_bits

LONG = Fraction(3, 2)  # times the usual low phase


class LongLows(NamedTuple):
    """rises: every rising SCL of the capture. which: indices of those after a long low. lengths: of these lows, in
    positions."""

    rises: Positions
    which: Positions
    lengths: Positions


def long_lows(capture: Capture, scl: Channel, sda: Channel, glitch: int = 0) -> LongLows:
    """Return SCL's lows of over 1.5 times the median, and at least two samples longer. glitch: as in `i2c_table`."""
    bits = i2c_bits(capture, scl.index, sda.index, glitch)
    seen = bits.low[bits.low >= 0]
    usual = Fraction(float(np.median(seen))) if len(seen) else Fraction(0)
    limit = float(max(usual * LONG, usual + 2 * sample_step(capture)))
    which = np.flatnonzero(bits.low > limit)
    return LongLows(bits.at, which, bits.low[which])
