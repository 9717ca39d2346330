"""Tables of TI's mathematics libraries, calculated from their description.

Both IQmath and fastRTS calculate sines from a table of 512 sines per turn and a cubic, and approximate the arctangent
of 0 to 1 by 64 parabolas. Comments in the sources of the libraries describe these methods, but not the coefficients of
the parabolas. So the parabolas are fitted here: each parabola passes through the arctangent at the three Chebyshev
points of its interval. The error is below 4e-8 rad.

Source: comments of IQNsin, IQNcos, IQNatan2 (IQmath V1.4, C28x) and of FastRTS_sin, FastRTS_atan2 (FPU fastRTS V2).
"""

from __future__ import annotations

from math import atan, cos, pi, sin

TURN = 512  # number of sines in a turn
PARABOLAS = 64  # number of parabolas for the arctangent of 0 to 1

SINES: tuple[float, ...] = tuple(sin(2 * pi * k / TURN) for k in range(TURN))
COSINES: tuple[float, ...] = tuple(cos(2 * pi * k / TURN) for k in range(TURN))


def _parabola(low: float, high: float) -> tuple[float, float, float]:
    """Return a0, a1, a2 with which a0 + r (a1 + a2 r) approximates atan(r) for r from `low` to `high`."""
    middle, half = (low + high) / 2, (high - low) / 2
    x = [middle + half * cos(pi * (2 * i + 1) / 6) for i in range(3)]
    y = [atan(at) for at in x]
    first = (y[1] - y[0]) / (x[1] - x[0])  # the divided differences of Newton's interpolation
    second = ((y[2] - y[1]) / (x[2] - x[1]) - first) / (x[2] - x[0])
    return y[0] - first * x[0] + second * x[0] * x[1], first - second * (x[0] + x[1]), second


ARCTANGENT: tuple[tuple[float, float, float], ...] = tuple(
    _parabola(k / PARABOLAS, (k + 1) / PARABOLAS) for k in range(PARABOLAS)
)
