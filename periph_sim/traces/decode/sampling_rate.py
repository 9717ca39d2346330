"""Whether a sampling rate can be true, from the clock it would give the bus: a capture goes in, a sentence comes out.

Captures come without a rate, or with a wrong one (a file of 500 kHz that states 1 Hz); all times are then wrong.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ..capture.capture import Capture
from ..capture.resample import rate_text

SLOWEST, FASTEST = 100, 5_000_000  # Hz; UM10204: Ultra Fast-mode to 5 MHz; SMBus allows no less than 10 kHz
FEWEST = 9  # clocks: a byte


def impossible_rate(capture: Capture, scl: str | int) -> str:
    """Why the rate cannot be true; empty where it can, and where there is too little to judge by.

    LookupError if the channel is not there.
    """
    line = capture.channel(scl)
    rises = line.edges[line.levels == 1]
    if capture.rate is None or len(rises) < FEWEST:
        return ""
    clock = capture.rate / Fraction(float(np.median(np.diff(rises))))
    if SLOWEST <= clock <= FASTEST:
        return ""
    return (
        f"at {rate_text(capture.rate)}, as it was captured or so it is stated, SCL would run at {float(clock):.3g} Hz; "
        f"expected {SLOWEST} Hz to {FASTEST // 10**6} MHz"
    )
