"""Where SCL was low for longer than usual: two lines in, a table of low phases out.

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
    """rises: every rising SCL of the capture. which: of these, by number, those behind a long low. lengths: of it, in
    positions."""

    rises: Positions
    which: Positions
    lengths: Positions


def long_lows(capture: Capture, scl: Channel, sda: Channel, glitch: int = 0) -> LongLows:
    """Low phases of SCL over half as long again as the median, and two samples longer. glitch: as in `i2c_table`."""
    bits = i2c_bits(capture, scl.index, sda.index, glitch)
    seen = bits.low[bits.low >= 0]
    usual = Fraction(float(np.median(seen))) if len(seen) else Fraction(0)
    limit = float(max(usual * LONG, usual + 2 * sample_step(capture)))
    which = np.flatnonzero(bits.low > limit)
    return LongLows(bits.at, which, bits.low[which])
