"""Unusual times of SCL: long low phases, and clock rates that no I2C bus has.

A long low phase may be stretching by a target that is not ready or a pause of the controller; the lines do not show who
held SCL. An impossible clock rate shows that the file states a wrong sample rate: for example, a capture at 500 kHz may
state 1 Hz.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np

from ..capture.capture import Capture, Channel, Positions
from ..capture.sampling import rate_text, sample_step
from .i2c_table import i2c_bits

LONG = Fraction(3, 2)  # a low phase is long above this multiple of the median
SLOWEST, FASTEST = 100, 5_000_000  # Hz; UM10204: Ultra Fast-mode to 5 MHz; SMBus allows no less than 10 kHz
FEWEST = 9  # minimum number of clocks for a judgement: one byte


class LongLows(NamedTuple):
    """The long low phases of SCL.

    rises: every rising SCL of the capture.
    which: the indices of the rises that follow a long low phase.
    lengths: the lengths of these low phases in positions.
    """

    rises: Positions
    which: Positions
    lengths: Positions


def long_lows(capture: Capture, scl: Channel, sda: Channel, glitch: int = 0) -> LongLows:
    """Return the low phases of SCL that exceed 1.5 times the median, and the median by at least two samples.

    glitch: as in `i2c_table`.
    """
    bits = i2c_bits(capture, scl.index, sda.index, glitch)
    seen = bits.low[bits.low >= 0]
    usual = Fraction(float(np.median(seen))) if len(seen) else Fraction(0)
    limit = float(max(usual * LONG, usual + 2 * sample_step(capture)))
    which = np.flatnonzero(bits.low > limit)
    return LongLows(bits.at, which, bits.low[which])


def impossible_rate(capture: Capture, scl: str | int) -> str:
    """Return the reason why the capture's rate is impossible; "" if it is possible or there are too few clocks.

    Raise LookupError if the channel is missing.
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
