"""IQmath's functions element by element on int64 arrays of raw Q numbers, like `iqmath` for ints."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .iqmath import A0, A1, A2, COSINE, SINE, arctangent, quarter_turn
from .tables import PARABOLAS

Ints = NDArray[np.int64]

SINES_AT, COSINES_AT, A0_AT, A1_AT, A2_AT = (np.array(table, dtype=np.int64) for table in (SINE, COSINE, A0, A1, A2))


def atan2_of_arrays(y: Ints, x: Ints, bits: int) -> Ints:
    """Return the angles of the points (x, y); 0 for the origin."""
    wide, high = np.abs(x), np.abs(y)
    steep = wide < high
    under = np.maximum(wide, high)
    ratio = (np.minimum(wide, high) << bits) // np.maximum(under, 1)
    index = np.minimum(ratio * PARABOLAS >> bits, PARABOLAS - 1)
    angle = arctangent(ratio, index, bits, A0_AT, A1_AT, A2_AT)
    quarter = quarter_turn(bits)
    up = quarter + np.where(x >= 0, -angle, angle)
    angle = np.where(steep, up, np.where(x < 0, 2 * quarter - angle, angle))
    signed: Ints = np.where(y >= 0, angle, -angle)
    return signed


def root_of_arrays(square: NDArray[np.uint64]) -> Ints:
    """Return roots of whole numbers up to 2**63, rounded to nearest; float64's root is corrected by one if needed."""
    near = np.rint(np.sqrt(square.astype(np.float64))).astype(np.uint64)
    near = near - ((near > 0) & (square <= near * near - near)).astype(np.uint64)
    near = near + (square > near * near + near).astype(np.uint64)
    return near.astype(np.int64)
