"""Times of SCL that are unusual: long low phases, and a clock that no I2C bus has, as at a wrong sampling rate.

A target that is not ready stretches the low phase; a controller that pauses looks the same, since the lines do not show
who held SCL. Captures come without a rate, or with a wrong one (a file of 500 kHz that states 1 Hz).
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np

from ..capture.capture import Capture, Channel, Positions
from ..capture.sampling import rate_text, sample_step
from .i2c_table import i2c_bits

LONG = Fraction(3, 2)  # times the usual low phase
SLOWEST, FASTEST = 100, 5_000_000  # Hz; UM10204: Ultra Fast-mode to 5 MHz; SMBus allows no less than 10 kHz
FEWEST = 9  # clocks: a byte


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


def impossible_rate(capture: Capture, scl: str | int) -> str:
    """Return why the rate cannot be true; empty if it can, or if there are too few clocks to judge by.

    LookupError for a missing channel.
    """
    line = capture.channel(scl)
    rises = line.edges[line.levels == 1]
    if capture.rate is None or len(rises) < FEWEST:
        return ""
    clock = capture.rate / Fraction(float(np.median(np.diff(rises))))
    if SLOWEST <= clock <= FASTEST:
        return ""
    return (
        f"at {rate_text(capture.rate)}, as captured or stated, SCL would run at {float(clock):.3g} Hz; "
        f"expected {SLOWEST} Hz to {FASTEST // 10**6} MHz"
    )
