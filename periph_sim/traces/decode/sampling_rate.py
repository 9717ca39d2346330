"""Plausibility check of a capture's sampling rate, by the bus clock that results from it.

Captures come without a rate, or with a wrong one (a file of 500 kHz that states 1 Hz); then all times are wrong.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ..capture.capture import Capture
from ..capture.resample import rate_text

SLOWEST, FASTEST = 100, 5_000_000  # Hz; UM10204: Ultra Fast-mode to 5 MHz; SMBus allows no less than 10 kHz
FEWEST = 9  # clocks: a byte


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
